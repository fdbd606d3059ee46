"""Remeshes the active object: exactly as many vertices as requested, evenly spread, in triangles close to equilateral, with UVs,
colours, vertex groups and materials. The result is a new object; the original is kept."""

import bpy

from . import operator, panel, settings

CLASSES = (settings.RemeshSettings, operator.OBJECT_OT_spectral_remesh, panel.VIEW3D_PT_spectral_remesh)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.spectral_remesh = bpy.props.PointerProperty(type=settings.RemeshSettings)


def unregister():
    del bpy.types.Scene.spectral_remesh
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
