"""Reads a Blender object as arrays."""

from dataclasses import dataclass, field

import numpy as np

import spectral_remesh

# For each type of attribute that is carried over: the member with the values, the number of components, and their type. Floats
# are interpolated, integers taken from the nearest vertex.
KINDS = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "QUATERNION": ("value", 4, np.float32),
}

# Prefixes of the names of arrays, since groups and attributes may have the same names, and some names have a meaning in the
# library.
GROUP, ATTRIBUTE = "group:", "attribute:"


@dataclass
class Source:
    """A copy of the mesh to remesh, since the original may change in Blender meanwhile."""

    #: Vertex positions in the units of the scene: along each axis, `scale` times those of the mesh.
    vertices: np.ndarray
    scale: np.ndarray
    triangles: np.ndarray
    polygon_of_triangle: np.ndarray
    #: The two vertices of each edge marked sharp.
    sharp_edges: np.ndarray
    #: Coordinates of the corners of triangles in the UV map used for rendering, and its name.
    uv: np.ndarray | None = None
    uv_name: str = ""
    #: Values at vertices, by names with the prefixes above.
    of_vertices: dict = field(default_factory=dict)
    #: Types and values of polygon attributes, by name: materials, flat shading.
    of_polygons: dict = field(default_factory=dict)
    #: Types of vertex attributes, by name.
    kinds: dict = field(default_factory=dict)
    #: Names of the vertex groups, in order.
    groups: list = field(default_factory=list)
    #: Data that is left out.
    left_out: list = field(default_factory=list)

    def weights(self, group, setting):
        """Returns the weights of the group selected in a setting."""
        if group not in self.groups:
            raise ValueError(f"{setting}: the object has no vertex group '{group}'; choose one")
        return self.of_vertices[GROUP + group].astype(np.float64)

    def as_mesh(self):
        """Returns a mesh of the library."""
        return spectral_remesh.Mesh(self.vertices, self.triangles, attributes=self.of_vertices, texture=self.uv)


def read(obj):
    """Reads the mesh of an object, without its modifiers. Raises `ValueError` if it cannot be remeshed."""
    mesh = obj.data
    if not mesh.polygons:
        raise ValueError(f"{obj.name} has no faces; a surface is needed")
    scale = np.abs(obj.matrix_world.to_scale())
    if not (np.isfinite(scale) & (scale > 0)).all():
        raise ValueError(f"{obj.name} has a scale of zero along an axis; change its scale")
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    loops = numbers(triangles, "loops", 3, np.int32)
    source = Source(
        vertices=numbers(mesh.vertices, "co", 3, np.float32).astype(np.float64) * scale,
        scale=scale,
        triangles=numbers(triangles, "vertices", 3, np.int32),
        polygon_of_triangle=numbers(triangles, "polygon_index", 1, np.int32),
        sharp_edges=numbers(mesh.edges, "vertices", 2, np.int32)[numbers(mesh.edges, "use_edge_sharp", 1, bool)],
    )
    _read_uv(source, mesh, loops)
    _read_groups(source, obj)
    _read_attributes(source, mesh)
    if mesh.shape_keys:
        source.left_out.append("shape keys")
    return source


def numbers(collection, member, components, kind):
    """Returns a member of all items of a collection, as rows if it has several components."""
    values = np.empty(len(collection) * components, dtype=kind)
    collection.foreach_get(member, values)
    return values if components == 1 else values.reshape(-1, components)


def _read_uv(source, mesh, loops):
    for layer in mesh.uv_layers:
        if layer.active_render:
            source.uv = numbers(layer.uv, "vector", 2, np.float32).astype(np.float64)[loops]
            source.uv_name = layer.name
        else:
            source.left_out.append(f"the UV map {layer.name}, which is not active for rendering")


def _read_groups(source, obj):
    source.groups = [group.name for group in obj.vertex_groups]
    weights = np.zeros((len(source.groups), len(source.vertices)), dtype=np.float32)
    for v, vertex in enumerate(obj.data.vertices):
        for entry in vertex.groups:
            weights[entry.group, v] = entry.weight
    source.of_vertices.update((GROUP + name, row) for name, row in zip(source.groups, weights, strict=True))


def _read_attributes(source, mesh):
    maps = {layer.name for layer in mesh.uv_layers}
    for attribute in mesh.attributes:
        name = attribute.name
        # Sharp edges are marked again on the result.
        if name.startswith(".") or name in maps or name in ("position", "sharp_edge"):
            continue
        if attribute.domain == "EDGE" or attribute.data_type not in KINDS:
            source.left_out.append(f"the attribute {name} ({attribute.domain.lower()}, {attribute.data_type.lower()})")
            continue
        values = numbers(attribute.data, *KINDS[attribute.data_type])
        if attribute.domain == "FACE":
            source.of_polygons[name] = (attribute.data_type, values)
            continue
        if attribute.domain == "CORNER":
            if values.dtype != np.float32:
                source.left_out.append(f"the corner attribute {name}, which cannot be averaged")
                continue
            values = _means_of_corners(mesh, values)
        if values.dtype == bool:
            values = values.astype(np.uint8)
        source.kinds[name] = attribute.data_type
        source.of_vertices[ATTRIBUTE + name] = values


def _means_of_corners(mesh, values):
    """Returns the mean of the corners at each vertex."""
    vertex = numbers(mesh.loops, "vertex_index", 1, np.int32)
    rows = values.reshape(len(vertex), -1)
    columns = [np.bincount(vertex, column, len(mesh.vertices)) for column in rows.T]
    counts = np.maximum(np.bincount(vertex, minlength=len(mesh.vertices)), 1)
    means = (np.stack(columns, axis=1) / counts[:, None]).astype(np.float32)
    return means if values.ndim == 2 else means[:, 0]
