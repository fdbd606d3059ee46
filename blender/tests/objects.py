"""Objects to remesh, and their properties."""

import bmesh
import bpy
import numpy as np


def numbers(collection, member, components=1, kind=np.float32):
    values = np.empty(len(collection) * components, dtype=kind)
    collection.foreach_get(member, values)
    return values if components == 1 else values.reshape(-1, components)


def places(mesh):
    return numbers(mesh.vertices, "co", 3)


def corners(mesh):
    """Returns the corners of the triangles of a mesh without other faces."""
    return numbers(mesh.loops, "vertex_index", 1, np.int32).reshape(-1, 3)


def weights(obj, name):
    number = obj.vertex_groups[name].index
    found = np.zeros(len(obj.data.vertices))
    for v, vertex in enumerate(obj.data.vertices):
        for entry in vertex.groups:
            if entry.group == number:
                found[v] = entry.weight
    return found


def set_weights(obj, name, values):
    group = obj.vertex_groups.new(name=name)
    for v, value in enumerate(values):
        if value > 0:
            group.add([v], float(value), "REPLACE")


def suzanne():
    """Adds Suzanne, smooth, with her UV map, colours that encode the position, a group that encodes the height, and
    a material on each side."""
    bpy.ops.mesh.primitive_monkey_add(calc_uvs=True)
    obj = bpy.context.object
    mesh = obj.data
    shape = bmesh.new()
    shape.from_mesh(mesh)
    bmesh.ops.subdivide_edges(shape, edges=shape.edges[:], cuts=3, use_grid_fill=True, smooth=0.6)
    shape.to_mesh(mesh)
    shape.free()
    at = places(mesh)
    attribute = mesh.color_attributes.new("Places", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", np.hstack([at / 4 + 0.5, np.ones((len(at), 1))]).astype(np.float32).ravel())
    attribute = mesh.attributes.new("Depth", "FLOAT", "POINT")
    attribute.data.foreach_set("value", at[:, 1].copy())
    attribute = mesh.attributes.new("Number", "INT", "POINT")
    attribute.data.foreach_set("value", np.where(at[:, 2] > 0, 7, 3).astype(np.int32))
    paint = mesh.color_attributes.new("Paint", "BYTE_COLOR", "CORNER")
    of_corners = at[numbers(mesh.loops, "vertex_index", 1, np.int32)] / 4 + 0.5
    paint.data.foreach_set("color", np.hstack([of_corners, np.ones((len(of_corners), 1))]).astype(np.float32).ravel())
    set_weights(obj, "high", np.clip((at[:, 2] + 1) / 2, 0, 1))
    for name in ("left", "right"):
        mesh.materials.append(bpy.data.materials.new(name))
    middles = numbers(mesh.polygons, "center", 3)
    mesh.polygons.foreach_set("material_index", (middles[:, 0] > 0).astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    mesh.update()
    return obj


def imported(path):
    """Imports an object from a file, and makes it active."""
    kind = path.suffix[1:]
    getattr(bpy.ops.wm, f"{kind}_import")(filepath=str(path), **({"forward_axis": "Y", "up_axis": "Z"} if kind != "obj" else {}))
    return bpy.context.object


def state(obj):
    """Returns everything about an object that must not change."""
    mesh = obj.data
    return (
        obj.name,
        mesh.name,
        places(mesh).tobytes(),
        numbers(mesh.loops, "vertex_index", 1, np.int32).tobytes(),
        [numbers(layer.uv, "vector", 2).tobytes() for layer in mesh.uv_layers],
        [(a.name, a.data_type, a.domain, len(a.data)) for a in mesh.attributes],
        [weights(obj, group.name).tobytes() for group in obj.vertex_groups],
        [material.name for material in mesh.materials],
    )


def lengths(obj):
    """Returns the edge lengths in the units of the scene."""
    at = places(obj.data) * np.abs(obj.matrix_world.to_scale())
    ends = at[numbers(obj.data.edges, "vertices", 2, np.int32)]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
