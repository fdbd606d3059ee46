"""Adds a remeshed surface as a Blender object next to the original."""

import bpy
import numpy as np

from .source import ATTRIBUTE, GROUP, KINDS, numbers


def add(obj, source, remeshed):
    """Adds a copy of `obj`, with its materials, modifiers and parents, whose mesh is the result, and returns it."""
    mesh = _mesh(f"{obj.data.name}.remeshed", remeshed.vertices / source.scale, remeshed.faces)
    for material in obj.data.materials:
        mesh.materials.append(material)
    _add_attributes(mesh, source, remeshed)
    _mark_sharp(mesh, remeshed.sharp_edges)
    if remeshed.texture is not None:
        _add_uv(mesh, source.uv_name, remeshed.texture)
    made = obj.copy()
    made.name = f"{obj.name}.remeshed"
    made.data = mesh
    _add_groups(made, source, remeshed)
    for collection in obj.users_collection:
        collection.objects.link(made)
    return made


def _mesh(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    return mesh


def _add_attributes(mesh, source, remeshed):
    for name, kind in source.kinds.items():
        _set(mesh, name, kind, "POINT", remeshed.attributes[ATTRIBUTE + name])
    polygons = source.polygon_of_triangle[remeshed.face_origin]
    for name, (kind, values) in source.of_polygons.items():
        _set(mesh, name, kind, "FACE", values[polygons])


def _set(mesh, name, kind, domain, values):
    member, _, type_of_numbers = KINDS[kind]
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, domain)
    attribute.data.foreach_set(member, np.ascontiguousarray(values, dtype=type_of_numbers).ravel())


def _mark_sharp(mesh, ends):
    if not len(ends):
        return
    count = len(mesh.vertices)

    def keys(pairs):
        return pairs.min(axis=1).astype(np.int64) * count + pairs.max(axis=1)

    sharp = np.isin(keys(numbers(mesh.edges, "vertices", 2, np.int32)), keys(ends))
    _set(mesh, "sharp_edge", "BOOLEAN", "EDGE", sharp)


def _add_uv(mesh, name, texture):
    layer = mesh.uv_layers.new(name=name, do_init=False)
    # In the library, corners of faces without texture coordinates have none (NaN). In Blender every corner has coordinates.
    layer.uv.foreach_set("vector", np.nan_to_num(texture).astype(np.float32).ravel())


def _add_groups(made, source, remeshed):
    for name in source.groups:
        group = made.vertex_groups.new(name=name)
        weights = remeshed.attributes[GROUP + name]
        for v in np.flatnonzero(weights > 0):
            group.add([int(v)], float(weights[v]), "REPLACE")
