"""The panel in the sidebar of the 3D view."""

import bpy

from .operator import OBJECT_OT_spectral_remesh


class VIEW3D_PT_spectral_remesh(bpy.types.Panel):
    bl_label = "Spectral Remesh"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Remesh"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        running = OBJECT_OT_spectral_remesh.running
        if running:
            layout.progress(factor=running.share, text=f"{running.stage} (Esc cancels)")
        column = layout.column()
        column.enabled = not running
        self.draw_settings(column, context.scene.spectral_remesh, context.object)
        column.operator(OBJECT_OT_spectral_remesh.bl_idname, icon="MOD_REMESH")

    def draw_settings(self, layout, settings, obj):
        layout.prop(settings, "density", expand=True)
        layout.prop(settings, "points" if settings.density == "POINTS" else "edge_length")
        layout.separator()
        layout.prop(settings, "grading")
        if settings.grading == "SHAPE":
            layout.prop(settings, "adapt")
        elif settings.grading == "GROUP":
            self.draw_group(layout, settings, "sizing_group", obj)
            layout.prop(settings, "finer")
        layout.separator()
        layout.prop(settings, "features")
        if settings.features == "ANGLE":
            layout.prop(settings, "angle")
        layout.separator()
        self.draw_group(layout, settings, "mask_group", obj)
        layout.prop(settings, "seed")
        layout.prop(settings, "hide_original")

    def draw_group(self, layout, settings, name, obj):
        if obj is not None and obj.type == "MESH":
            layout.prop_search(settings, name, obj, "vertex_groups")
