"""The jobs. Each is one call into the compiled library."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from inspect import signature
from typing import Any, Literal

from numpy.typing import ArrayLike

from . import _native
from ._arrays import as_box, as_lengths, as_marks, as_sharp_edges
from ._errors import ArgumentError, NotVerifiedError
from ._foreign import as_mesh
from ._mesh import Reconstructed, Remeshed, Report, Sampled
from ._progress import Wanted, told


def remesh(
    vertices: Any,
    faces: ArrayLike | None = None,
    *,
    points: int | Literal["auto"] | None = None,
    edge_length: float | None = None,
    sigma_p: float | None = None,
    sizing: str | ArrayLike | None = None,
    features: float | Literal["auto", "none"] | ArrayLike | None = None,
    adapt: float | None = None,
    sigma_n: float | None = None,
    sigma: Mapping[str, float] | None = None,
    max_error: float | str | None = None,
    weld: float | None = None,
    smooth: bool | float | None = None,
    fill_holes: float = 0.0,
    terrain: bool | None = None,
    normal_fit: Literal["plane", "sphere"] | None = None,
    normal_neighbors: int | None = None,
    normal_radius: float | None = None,
    within: ArrayLike | None = None,
    select: str | ArrayLike | None = None,
    attributes: Mapping[str, ArrayLike] | bool = True,
    optimize: bool = True,
    seed: int = 0,
    threads: int | None = None,
    progress: Wanted = None,
    report: bool = True,
    strict: bool = False,
) -> Remeshed:
    """Remeshes a mesh or a cloud of points with the requested number of vertices, evenly spread or graded, into triangles
    close to equilateral, with the same shape and topology.

    The result does not depend on the number of threads, and equals that of the command. The global interpreter lock is
    released meanwhile. Ctrl-C ends the job.

    Args:
        vertices: Positions, of shape (n, 3), of any float or integer type; or a mesh or cloud from trimesh, PyVista, meshio,
            Open3D or this package, with its colours, normals and other vertex attributes; or a tuple of both arrays.
        faces: Vertex indices from 0, of shape (m, 3), counter-clockwise seen from outside; or polygons, of shape (m, k).
            Without faces, the vertices are a cloud, and the surface through them is remeshed.
        points: Number of vertices of the result; ``"auto"`` takes as many as ``max_error`` needs. With ``within`` or
            ``select``, the number of those strictly inside the part.
        edge_length: Mean edge length of the result, in the units of the input.
        sigma_p: Kernel width σp of the sampler, in the units of the input.
        sizing: Target edge length at each vertex of the input, of shape (n,), in its units, or the name of an attribute.
            It also sets the density if no other argument does.
        features: Edges to keep sharp: those with at least this dihedral angle, in degrees, or ``"none"``; or the two vertices
            of each edge, of shape (edges, 2). By default the input decides.
        adapt: How strongly edge lengths adapt to the shape: from 0, uniform, to 1, short where the surface bends or is thin.
        sigma_n: Kernel width σn along unit normals. With 0.5 to 1, vertices gather where the surface bends.
        sigma: Kernel widths along attributes of the input, by name. Vertices gather where the attributes change.
        max_error: Maximum distance between the result and the input, measured both ways: a length in the units of the input,
            or a share of the diagonal of its bounding box, such as ``"0.1%"``.
        weld: Boundary vertices within this distance, in the units of the input, are welded; 0 welds only those at the same
            position. By default, seams opened by rounding are closed.
        smooth: Support radius for smoothing noise away first, in mean spacings of the points; ``True`` is 2.7, ``False`` or 0
            smooths nothing. By default only clouds with noise are smoothed, as with ``True``.
        fill_holes: Close holes of a cloud whose bounding box has at most this diagonal, in the units of the input.
        terrain: Whether a cloud is terrain: the points seen from above become a sheet with one height at each place; z is up.
            By default a cloud is terrain if it looks like it and many points would be left out otherwise.
        normal_fit: Shape to which the normals of a cloud are fitted. By default planes, or spheres with ``smooth``.
        normal_neighbors: Number of neighbours in a fit. By default 8, or 16 with ``smooth``.
        normal_radius: Distance within which neighbours are taken instead, in the units of the input.
        within: Remesh only the part in a box, of shape (2, 3): its lowest and its highest x, y and z. The rest of a mesh is
            unchanged, that of a cloud is left out.
        select: Remesh only triangles with all vertices selected: by truth values of shape (n,), by the name of an attribute
            that is not zero there, or by ``"NAME=VALUE"``. The rest is unchanged.
        attributes: Additional arrays of shape (n,) or (n, components), by name. With ``False`` the result has no attributes.
            Floats and colours are interpolated; other integers are those of the nearest vertex.
        optimize: Whether to optimise triangles. Otherwise vertices stay where the paper's gradient ascent leaves them.
        seed: Seed of the random numbers.
        threads: Number of threads, by default one per core.
        progress: ``True`` shows a bar (with tqdm if that is installed). A function is called with the name of the stage and
            the completed share, from 0 to 1; an exception that it raises ends the job.
        report: Whether to measure the result. Without a report the job takes less time.
        strict: Whether to raise an error if the result is not verified.

    Returns:
        The mesh, its attributes, the origin of each vertex, and the report.

    Raises:
        ArgumentError: A ``ValueError`` for an invalid argument.
        MeshError: For an input that has no surface.
        NotVerifiedError: With ``strict``, for a result that fails a check. The error has the result.
    """
    mesh = as_mesh(vertices, faces, attributes)
    arguments: dict[str, Any] = {
        "points": points,
        "edge_length": edge_length,
        "sigma_p": sigma_p,
        "sizing": sizing,
        "features": features,
        "adapt": adapt,
        "sigma_n": sigma_n,
        "sigma": sigma,
        "max_error": max_error,
        "weld": weld,
        "smooth": smooth,
        "fill_holes": fill_holes,
        "terrain": terrain,
        "normal_fit": normal_fit,
        "normal_neighbors": normal_neighbors,
        "normal_radius": normal_radius,
        "within": within,
        "select": select,
        "attributes": attributes,
        "optimize": optimize,
        "seed": seed,
        "report": report,
    }
    with told(progress) as tell:
        made = _native.remesh(mesh._to_native(), _converted(arguments), _count(threads), tell)
    return _checked(Remeshed(made, mesh.notes), strict)


def levels(vertices: Any, faces: ArrayLike | None = None, *, points: Sequence[int], **options: Any) -> list[Remeshed]:
    """Makes levels of detail: remeshes the same input with each of several numbers of vertices.

    The input is repaired once, and a cloud is meshed once. Each level equals the result of :func:`remesh` for that number, and
    its origins are on the input.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`.
        points: Numbers of vertices, from fine to coarse.
        options: The other arguments of :func:`remesh`, except ``edge_length`` and ``sigma_p``.

    Returns:
        A mesh for each number, in the same order.

    Raises:
        ArgumentError: A ``ValueError`` for an invalid argument.
        MeshError: For an input that has no surface.
        NotVerifiedError: With ``strict``, for the first level that fails a check.
    """
    known = {name: one.default for name, one in signature(remesh).parameters.items() if one.kind is one.KEYWORD_ONLY}
    others = options.keys() - (known.keys() - {"edge_length", "sigma_p"})
    if others:
        raise ArgumentError(min(others), "levels() has no such argument")
    counts = [int(count) for count in points]
    arguments = {**known, **options, "points": counts[0] if counts else None}
    threads, progress, strict = (arguments.pop(name) for name in ("threads", "progress", "strict"))
    mesh = as_mesh(vertices, faces, arguments["attributes"])
    with told(progress) as tell:
        made = _native.levels(mesh._to_native(), _converted(arguments), counts, _count(threads), tell)
    return [_checked(Remeshed(level, mesh.notes), strict) for level in made]


def _converted(arguments: dict[str, Any]) -> dict[str, object]:
    """Converts the arguments of a remeshing for the compiled half."""
    return {
        **arguments,
        "sizing": as_lengths(arguments["sizing"]),
        "features": as_sharp_edges(arguments["features"]),
        "sigma": dict(arguments["sigma"] or {}),
        "within": as_box(arguments["within"]),
        "select": as_marks(arguments["select"]),
        "attributes": arguments["attributes"] is not False,
    }


def _checked(remeshed: Remeshed, strict: bool) -> Remeshed:
    if strict and not remeshed.verified:
        raise NotVerifiedError(remeshed)
    return remeshed


def sample(
    vertices: Any,
    faces: ArrayLike | None = None,
    *,
    points: int | None = None,
    edge_length: float | None = None,
    sigma_p: float | None = None,
    sigma_n: float = math.inf,
    sigma: Mapping[str, float] | None = None,
    within: ArrayLike | None = None,
    smooth: float | None = None,
    normal_fit: Literal["plane", "sphere"] | None = None,
    normal_neighbors: int | None = None,
    normal_radius: float | None = None,
    attributes: Mapping[str, ArrayLike] | bool = True,
    scan_only: bool = False,
    levels: int | None = None,
    seed: int = 0,
    sweeps: int = 10,
    threads: int | None = None,
    progress: Wanted = None,
) -> Sampled:
    """Samples a surface: points with normals, spread evenly as blue noise, without triangles.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`. A cloud is sampled on the implicit surface through its points.
        points: Number of samples.
        edge_length: Mean distance between neighbouring samples, in the units of the input.
        sigma_p: Kernel width σp of the sampler, in the units of the input.
        sigma_n: Kernel width σn along unit normals. With 0.5 to 1, samples gather where the surface bends.
        sigma: Kernel widths along attributes of the input, by name. Samples gather where the attributes change.
        within: Use only the points of a cloud in a box, of shape (2, 3): its lowest and its highest x, y and z.
        smooth: Support radius of the points of a cloud, in mean spacings; 0 takes 2.3, the least that leaves no holes. By
            default 2.7 if there is noise, otherwise as with 0.
        normal_fit: As for :func:`remesh`.
        normal_neighbors: As for :func:`remesh`.
        normal_radius: As for :func:`remesh`, in the units of the input.
        attributes: Additional arrays of shape (n,) or (n, components), by name, for ``sigma``. The samples have them, too.
        scan_only: Take a subset of the input's vertices instead.
        levels: Number of levels, each with a quarter of the samples of the next one. The samples are in progressive order: any
            first part of them is evenly spread, too. ``report["levels"]`` has the end of each level.
        seed: Seed of the random numbers.
        sweeps: Sweeps of gradient ascent.
        threads: As for :func:`remesh`.
        progress: As for :func:`remesh`.

    Returns:
        The points, their normals and attributes, and with ``scan_only`` their indices.

    Raises:
        ArgumentError: A ``ValueError`` for an invalid argument.
        MeshError: For an input that has no surface.
    """
    mesh = as_mesh(vertices, faces, attributes)
    arguments: dict[str, object] = {
        "points": points,
        "edge_length": edge_length,
        "sigma_p": sigma_p,
        "sigma_n": sigma_n,
        "sigma": dict(sigma or {}),
        "within": as_box(within),
        "smooth": smooth,
        "normal_fit": normal_fit,
        "normal_neighbors": normal_neighbors,
        "normal_radius": normal_radius,
        "scan_only": scan_only,
        "levels": levels,
        "seed": seed,
        "sweeps": sweeps,
    }
    with told(progress) as tell:
        made = _native.sample(mesh._to_native(), arguments, _count(threads), tell)
    return Sampled(made, mesh.notes)


def reconstruct(
    vertices: Any,
    faces: ArrayLike | None = None,
    *,
    resolution: float | None = None,
    smooth: float | None = None,
    normal_fit: Literal["plane", "sphere"] | None = None,
    normal_neighbors: int | None = None,
    normal_radius: float | None = None,
    attributes: Mapping[str, ArrayLike] | bool = True,
    threads: int | None = None,
    progress: Wanted = None,
) -> Reconstructed:
    """Extracts the whole smooth implicit surface of a cloud, or of the vertices of a mesh, as dense triangles.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`.
        resolution: Edge length of the cells, in the units of the input, by default half the mean spacing of the points.
        smooth: Support radius of the points, in mean spacings: the larger, the smoother; 0 takes 2.3, the least that leaves no
            holes. By default 2.7 if there is noise, otherwise as with 0.
        normal_fit: As for :func:`remesh`.
        normal_neighbors: As for :func:`remesh`.
        normal_radius: As for :func:`remesh`, in the units of the input.
        attributes: Additional arrays: ``{"normal": array}`` provides the normals of points, of shape (n, 3).
        threads: As for :func:`remesh`.
        progress: As for :func:`remesh`.

    Raises:
        ArgumentError: A ``ValueError`` for an invalid argument.
        MeshError: For points that no surface passes through.
    """
    mesh = as_mesh(vertices, faces, attributes)
    arguments: dict[str, object] = {
        "resolution": resolution,
        "smooth": smooth,
        "normal_fit": normal_fit,
        "normal_neighbors": normal_neighbors,
        "normal_radius": normal_radius,
    }
    with told(progress) as tell:
        made = _native.reconstruct(mesh._to_native(), arguments, _count(threads), tell)
    return Reconstructed(made, mesh.notes)


def quality(vertices: Any, faces: ArrayLike | None = None, *, against: Any = None, threads: int | None = None) -> Report:
    """Measures the triangles of any mesh as they are: angles, edge lengths, valences, topology.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`.
        against: Another mesh of any kind, or a tuple of vertices and faces. The distance to it is measured, in percent of the
            diagonal of its bounding box.
        threads: As for :func:`remesh`.

    Raises:
        ArgumentError: A ``ValueError`` for an invalid argument.
        MeshError: For points without triangles.
    """
    mesh = as_mesh(vertices, faces)
    other = None
    if against is not None:
        other = as_mesh(against)
    measured = _native.quality(mesh._to_native(), None if other is None else other._to_native(), _count(threads))
    report = Report(*measured)
    report["notes"] = [*(other.notes if other else []), *mesh.notes]
    return report


def _count(threads: int | None) -> int | None:
    if threads is not None and not 1 <= threads <= 1024:
        raise ArgumentError("threads", f"{threads} threads are not possible; give a number from 1 to 1024")
    return threads
