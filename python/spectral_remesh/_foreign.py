"""Converts meshes of other packages, and back.

A package is imported only to make one of its meshes. Meshes passed in are recognised by the package of their class.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Array, split
from ._errors import ArgumentError
from ._mesh import Mesh

if TYPE_CHECKING:
    import pyvista
    import trimesh


def as_mesh(vertices: Any, faces: ArrayLike | None = None, attributes: Mapping[str, ArrayLike] | bool = True) -> Mesh:
    """Converts a mesh of any package, arrays, or a pair of arrays to a mesh of this package, and adds attributes."""
    if isinstance(vertices, tuple) and len(vertices) == 2 and faces is None:
        vertices, faces = vertices
    reader = _reader(vertices)
    if reader is None:
        mesh = Mesh(vertices, faces)
    elif faces is not None:
        raise ArgumentError("faces", "the first argument is a mesh, which has faces of its own; leave one of them out")
    else:
        mesh = reader(vertices)
    if isinstance(attributes, bool):
        return mesh
    if not isinstance(attributes, Mapping):
        raise ArgumentError("attributes", "a mapping from names to arrays is expected, or False")
    return _with_attributes(mesh, {**mesh.attributes, **{name: np.asarray(a) for name, a in attributes.items()}})


def _with_attributes(mesh: Mesh, attributes: dict[str, Array]) -> Mesh:
    """Returns the mesh with other attributes, and leaves the original unchanged."""
    other = Mesh(mesh.vertices, mesh.faces, attributes=attributes, texture=mesh.texture)
    other.notes, other._others = mesh.notes, mesh._others
    return other


def _reader(value: Any) -> Callable[[Any], Mesh] | None:
    """Returns the reader for meshes of the class of ``value``, or ``None`` for arrays."""
    if isinstance(value, (str, bytes)) or hasattr(value, "__fspath__"):
        raise ArgumentError("vertices", f"an array or a mesh is expected, not a file name; give read({str(value)!r})")
    readers: dict[str, Callable[[Any], Mesh]] = {
        "spectral_remesh": lambda mesh: mesh,
        "trimesh": _of_trimesh,
        "pyvista": _of_pyvista,
        "meshio": _of_meshio,
        "open3d": _of_open3d,
    }
    # Subclasses of numpy arrays, such as those of these packages, are arrays.
    if isinstance(value, np.ndarray):
        return None
    packages = [kind.__module__.partition(".")[0] for kind in type(value).__mro__]
    return next((readers[package] for package in packages if package in readers), None)


def _refuse(value: Any, remedy: str) -> ArgumentError:
    kind = type(value)
    return ArgumentError("vertices", f"{kind.__module__}.{kind.__name__} is not a mesh of triangles or points; {remedy}")


def _of_trimesh(mesh: Any) -> Mesh:
    if not hasattr(mesh, "vertices"):
        raise _refuse(mesh, "give its meshes one by one, or the result of its to_mesh()")
    if not hasattr(mesh, "faces"):
        return Mesh(mesh.vertices, attributes=_colors(getattr(mesh, "colors", None)))
    colors = mesh.visual.vertex_colors if mesh.visual.kind == "vertex" else None
    attributes = {**_colors(colors), **mesh.vertex_attributes}
    coordinates = getattr(mesh.visual, "uv", None)
    texture = None if coordinates is None else np.asarray(coordinates)[mesh.faces]
    result = Mesh(mesh.vertices, mesh.faces, attributes=attributes, texture=texture)
    result.notes = ["colours of faces are left out"] if mesh.visual.kind == "face" else []
    return result


def _of_pyvista(mesh: Any) -> Mesh:
    if not hasattr(mesh, "faces"):
        raise _refuse(mesh, "give the result of its extract_surface()")
    attributes = {str(name): np.asarray(mesh.point_data[name]) for name in mesh.point_data}
    normals = mesh.point_data.active_normals_name
    attributes = {"normal" if name == normals else name: array for name, array in attributes.items()}
    numeric = {name: array for name, array in attributes.items() if array.dtype.kind in "fiub"}
    faces = _of_vtk(mesh.points, np.asarray(mesh.faces))
    result = Mesh(mesh.points, faces, attributes=numeric)
    result.notes = [f"{name} is not numeric and is left out" for name in attributes if name not in numeric]
    result.notes += [f"{name} of faces is left out" for name in mesh.cell_data]
    return result


def _of_vtk(points: ArrayLike, cells: Array) -> Array | None:
    """Returns the triangles of a list of polygons, each preceded by its number of corners."""
    if cells.size == 0:
        return None
    if cells.size % 4 == 0 and (cells[::4] == 3).all():
        return cells.reshape(-1, 4)[:, 1:]
    starts = [0]
    while starts[-1] < cells.size:
        starts.append(starts[-1] + int(cells[starts[-1]]) + 1)
    heads = np.array(starts[:-1])
    return split(np.asarray(points, dtype=np.float64), np.delete(cells, heads), cells[heads])


def _of_meshio(mesh: Any) -> Mesh:
    faces = [block for block in mesh.cells if block.type in ("triangle", "quad", "polygon")]
    others = sorted({block.type for block in mesh.cells if block not in faces and block.type != "vertex"})
    if others and not faces:
        raise _refuse(mesh, f"it has only {', '.join(others)} cells; give their surface")
    points = np.asarray(mesh.points)
    triangles = [_of_block(points, np.asarray(block.data)) for block in faces]
    result = Mesh(points, np.concatenate(triangles) if triangles else None, attributes=mesh.point_data)
    result.notes = [f"{kind} cells are left out" for kind in others]
    return result


def _of_block(points: Array, cells: Array) -> Array:
    if cells.shape[1] == 3:
        return cells
    return split(np.asarray(points, dtype=np.float64), cells, np.full(len(cells), cells.shape[1]))


def _of_open3d(mesh: Any) -> Mesh:
    if hasattr(mesh, "to_legacy"):
        mesh = mesh.to_legacy()
    if hasattr(mesh, "triangles"):
        arrays = {"normal": mesh.vertex_normals, "color": mesh.vertex_colors}
        return Mesh(mesh.vertices, mesh.triangles, attributes=_filled(arrays))
    if not hasattr(mesh, "points") or not hasattr(mesh, "normals"):
        raise _refuse(mesh, "give a TriangleMesh or a PointCloud")
    return Mesh(mesh.points, attributes=_filled({"normal": mesh.normals, "color": mesh.colors}))


def _filled(arrays: dict[str, Any]) -> dict[str, Array]:
    return {name: np.asarray(array) for name, array in arrays.items() if len(array)}


def _colors(colors: ArrayLike | None) -> dict[str, Array]:
    """Returns the colours of an object that has one for each vertex or none at all."""
    return {} if colors is None or np.size(colors) == 0 else {"color": np.asarray(colors)}


def to_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    """See :meth:`Mesh.to_trimesh`."""
    import trimesh

    color = mesh.attributes.get("color")
    colors = None if color is None else _as_bytes(color)
    if not len(mesh.faces):
        points: Any = trimesh.PointCloud
        cloud: trimesh.Trimesh = points(mesh.vertices, colors=colors)
        return cloud
    others: dict[str, Any] = {name: array for name, array in mesh.attributes.items() if name not in ("color", "normal")}
    return trimesh.Trimesh(
        mesh.vertices,
        mesh.faces,
        vertex_normals=mesh.attributes.get("normal"),
        vertex_colors=colors,
        vertex_attributes=others,
        face_attributes={} if mesh.texture is None else {"texture": mesh.texture},
        process=False,
    )


def _as_bytes(colors: Array) -> Array:
    full = np.iinfo(colors.dtype).max if colors.dtype.kind in "iu" else 1.0
    return np.round(255 * np.clip(colors / full, 0, 1)).astype(np.uint8)


def to_pyvista(mesh: Mesh) -> pyvista.PolyData:
    """See :meth:`Mesh.to_pyvista`."""
    import pyvista

    is_cloud = not len(mesh.faces)
    made = pyvista.PolyData(mesh.vertices) if is_cloud else pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
    for name, array in mesh.attributes.items():
        made.point_data[name] = array
    if "normal" in mesh.attributes:
        made.point_data.active_normals_name = "normal"
    return made
