"""The meshes of this package, and the results of its jobs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import Array, as_attributes, as_faces, as_vertices

if TYPE_CHECKING:
    import pyvista
    import trimesh


class Report(dict[str, Any]):
    """The report on a job and the quality of its result: the members of the command's JSON report, as a dictionary.

    Angles are in degrees, lengths in the units of the input, distances in percent of the diagonal of its bounding box.
    ``print`` shows it as a table.
    """

    def __init__(self, members: str, table: str) -> None:
        super().__init__(json.loads(members))
        self.table = table

    def __str__(self) -> str:
        return self.table

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.table)}</pre>"


class Origin(NamedTuple):
    """The position on the input of each vertex of a result.

    Values at the vertices of the input are interpolated there by
    ``(origin.weights[:, :, None] * values[origin.vertices]).sum(axis=1)``.
    """

    #: The face of the input, of shape (n,); -1 for points without faces.
    faces: Array
    #: The three input vertices around it, of shape (n, 3).
    vertices: Array
    #: Their barycentric coordinates, of shape (n, 3), none negative. Each row sums to 1.
    weights: Array


class Mesh:
    """A triangle mesh, or a cloud of points if it has no faces. Iterating over it yields vertices and faces.

    Args:
        vertices: Positions, of shape (n, 3), of any float or integer type.
        faces: Vertex indices from 0, of shape (m, 3), counter-clockwise seen from outside. Polygons, of shape (m, k), are split
            into triangles.
        attributes: Arrays of shape (n,) or (n, components), by name. ``normal`` with three components is a normal, ``color``
            with three or four, as bytes or from 0 to 1, a colour.
        texture: Texture coordinates of the corners of faces, of shape (m, 3, 2), with the origin at the lower left.

    Raises:
        ArgumentError: For a wrong shape or type.
    """

    vertices: Array
    faces: Array
    attributes: dict[str, Array]
    texture: Array | None
    #: Notes for the user, a sentence each.
    notes: list[str]

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike | None = None,
        *,
        attributes: Mapping[str, ArrayLike] | None = None,
        texture: ArrayLike | None = None,
    ) -> None:
        self.vertices = as_vertices(vertices)
        triangles = as_faces(faces, self.vertices)
        self.faces = np.empty((0, 3), dtype=np.int64) if triangles is None else triangles
        self.attributes = {name: np.asarray(values) for name, values in (attributes or {}).items()}
        self.texture = None if texture is None else np.asarray(texture)
        self.notes = []
        # Materials and names of parts, which are not arrays, and attributes with all their digits.
        self._others: _native.Attributes | None = None

    def __iter__(self) -> Iterator[Array]:
        return iter((self.vertices, self.faces))

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.vertices):,} vertices, {len(self.faces):,} faces>"

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_others": None}

    def _with(self, others: _native.Attributes, notes: list[str]) -> None:
        """Adds the attributes and notes that the compiled half returns for this mesh."""
        self.attributes = others.arrays()
        self.texture = others.texture()
        self.notes = notes
        self._others = others

    def _to_native(self) -> _native.Mesh:
        """Returns a copy for the compiled half."""
        vertices = as_vertices(self.vertices)
        arrays = as_attributes(self.attributes, len(vertices))
        texture = None if self.texture is None else np.asarray(self.texture, dtype=np.float64)
        return _native.Mesh(vertices, as_faces(self.faces, vertices), arrays, texture, self._others)

    def _repr_html_(self) -> str:
        from ._html import of_mesh

        return of_mesh(self)

    def to_trimesh(self) -> trimesh.Trimesh:
        """Converts to a ``trimesh.Trimesh`` with colours, normals and ``vertex_attributes``. Vertices keep their order.

        Points without faces become a ``trimesh.PointCloud``.
        """
        from ._foreign import to_trimesh

        return to_trimesh(self)

    def to_pyvista(self) -> pyvista.PolyData:
        """Converts to a ``pyvista.PolyData`` with the attributes as ``point_data``."""
        from ._foreign import to_pyvista

        return to_pyvista(self)


class Remeshed(Mesh):
    """A remeshed surface, with its origin on the input and its report."""

    #: The position of each vertex on the input.
    origin: Origin
    #: For each face, the face of the input below its centre, of shape (m,); empty for points without faces.
    face_origin: Array
    #: The two vertices of each edge that lies on a sharp edge of the input, of shape (k, 2).
    sharp_edges: Array
    #: The report on the job and the quality of the result; ``None`` with ``report=False``.
    report: Report | None
    #: The reasons why the result is not verified, a phrase each.
    shortcomings: list[str]

    def __init__(self, made: _native.Remeshed, notes: list[str]) -> None:
        super().__init__(made.vertices, made.faces)
        self._with(made.attributes, notes + made.notes)
        self.origin = Origin(*made.origin)
        self.face_origin = made.face_origin
        self.sharp_edges = made.sharp_edges
        self.report = None if made.report is None else Report(*made.report)
        self.shortcomings = made.shortcomings
        if self.report is not None:
            self.report["notes"] = notes + self.report["notes"]

    @property
    def verified(self) -> bool:
        """Whether the result passes all checks against the repaired input: it is an oriented manifold with the same
        topology, has no self-intersections where the input has none, no slivers that the input does not force and no
        triangles where it has no surface, and is as close to it as requested."""
        return not self.shortcomings


class Sampled(Mesh):
    """Points on a surface, with normals and without faces."""

    report: Report

    def __init__(self, made: _native.Sampled, notes: list[str]) -> None:
        super().__init__(made.vertices)
        self._with(made.attributes, notes + made.notes)
        self.report = Report(*made.report)
        self.report["notes"] = notes + self.report["notes"]

    @property
    def normals(self) -> Array | None:
        """Unit normals, of shape (n, 3), if the input has normals."""
        return self.attributes.get("normal")

    @property
    def indices(self) -> Array | None:
        """With ``scan_only=True``, the index of each sample among the vertices of the input, of shape (n,)."""
        return self.attributes.get("index")


class Reconstructed(Mesh):
    """The surface of a cloud as dense triangles."""

    report: Report

    def __init__(self, made: _native.Reconstructed, notes: list[str]) -> None:
        super().__init__(made.vertices, made.faces)
        self.report = Report(*made.report)
        self.notes = self.report["notes"] = notes + self.report["notes"]
