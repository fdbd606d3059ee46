"""The jobs: each is one call of the compiled library."""

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
    """Remeshes a mesh or a cloud of points: as many vertices as wanted, evenly spread or graded, and triangles close to
    equilateral, of the same shape and topology.

    The result is the same with any number of threads, and the same as that of the command. The lock of the interpreter is
    free meanwhile; Ctrl-C ends it.

    Args:
        vertices: Positions, of shape (n, 3), of any float or integer type; or a mesh or cloud of trimesh, PyVista, meshio,
            Open3D or this package, with its colours, normals and other attributes of vertices; or a tuple of both arrays.
        faces: Numbers of the corners from 0, of shape (m, 3), counter-clockwise seen from outside; or polygons, of shape
            (m, k). Without faces, the vertices are a cloud, through which a surface is laid.
        points: Number of vertices of the result; ``"auto"`` takes as many as ``max_error`` needs. With ``within`` or
            ``select`` those strictly inside of the part.
        edge_length: Mean edge length of the result, in the units of the input.
        sigma_p: Kernel width σp of the sampler, in the units of the input.
        sizing: Edge length wanted at each vertex of the input, of shape (n,), in its units, or the name of an attribute.
            Also says how dense, if nothing else does.
        features: Which edges stay sharp: those across which the input turns by at least so many degrees, or ``"none"``; or the
            two vertices of each edge, of shape (edges, 2). By default the input decides.
        adapt: How much edge lengths follow the shape, from 0, even, to 1, short where it bends or is thin.
        sigma_n: Kernel width σn along unit normals: with 0.5 to 1 vertices gather where the surface bends.
        sigma: Kernel widths along attributes of the input, by their names: vertices gather where these change.
        max_error: How far any point of the result may be from the input, and back: a length in the units of the input, or a
            share of the diagonal of its bounding box, such as ``"0.1%"``.
        weld: Boundary vertices within this distance, in the units of the input, become one; 0 welds only those at exactly one
            place. By default seams that rounding opened are closed.
        smooth: Smooth noise away first: points reach as far as so many mean distances of neighbouring ones, 2.7 with ``True``;
            ``False``, or 0, smooths nothing. By default only clouds with noise are smoothed, as with ``True``.
        fill_holes: Close holes of a cloud whose bounding box has no longer a diagonal, in the units of the input.
        terrain: Whether a cloud is of terrain: what is seen from above becomes a sheet with one height at each place; z is up.
            By default, if it looks like that and many points would be left out otherwise.
        normal_fit: What normals of a cloud are fitted to. By default planes, or spheres with ``smooth``.
        normal_neighbors: How many neighbours they are fitted to. By default 8, or 16 with ``smooth``.
        normal_radius: How far away these neighbours may be instead, in the units of the input.
        within: Remesh only what is in a box, of shape (2, 3): its lowest and its highest x, y and z. The rest stays as it is.
        select: Remesh only triangles all of whose corners are selected: truth values of shape (n,), or the name of an attribute
            that is not zero there, or ``"NAME=VALUE"``. The rest stays as it is.
        attributes: More arrays of shape (n,) or (n, components), by their names; ``False``: the result gets no attributes.
            Floats are interpolated; of integers that are no colours the nearest is taken.
        optimize: Whether triangles are optimised; without, vertices stay where the gradient ascent of the paper leaves them.
        seed: Seed of the random numbers.
        threads: How many threads to use, by default one a core.
        progress: ``True`` shows a bar (of tqdm where that is installed); a function is called with the name of the stage
            and the share that is done, from 0 to 1. What it raises ends the job.
        report: Whether to measure the result: without, it takes less time.
        strict: Whether to raise an error if the result is not verified.

    Returns:
        The mesh, its attributes, where each vertex came from, and the report.

    Raises:
        ArgumentError: A ``ValueError`` for an argument that makes no sense.
        MeshError: For an input that no surface can be made of.
        NotVerifiedError: With ``strict``, for a result that fails a check; it has the result all the same.
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
    """Levels of detail: remeshes the same input for each of several numbers of vertices.

    The input is repaired once, and points become a mesh once. Each level is what :func:`remesh` gives for that number, and its
    origins are on the input.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`.
        points: Numbers of vertices, from fine to coarse.
        options: The other arguments of :func:`remesh`, but for those that say how dense the result should be.

    Returns:
        A mesh for each number, in this order.

    Raises:
        ArgumentError: A ``ValueError`` for an argument that makes no sense.
        MeshError: For an input that no surface can be made of.
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
    """The arguments of a remeshing as the compiled half takes them."""
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
    """Samples a surface: points with normals, evenly spread as blue noise, without triangles.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`. A cloud is sampled on the implicit surface through its points.
        points: Number of samples.
        edge_length: Mean distance between neighbouring samples, in the units of the input.
        sigma_p: Kernel width σp of the sampler, in the units of the input.
        sigma_n: Kernel width σn along unit normals: with 0.5 to 1 samples gather where the surface bends.
        sigma: Kernel widths along attributes of the input, by their names: samples gather where these change.
        smooth: How far the points of a cloud reach, in mean distances of neighbouring ones; 0 takes 2.3, as little as
            leaves no holes. By default 2.7 where there is noise, else as 0.
        normal_fit: As for :func:`remesh`.
        normal_neighbors: As for :func:`remesh`.
        normal_radius: As for :func:`remesh`, in the units of the input.
        attributes: More arrays of shape (n,) or (n, components), by their names, which samples have, too; for ``sigma``.
        scan_only: Take a subset of the input's vertices instead.
        levels: Give the samples in progressive order, in which any first part of them is evenly spread, too: so many levels,
            each with a quarter of the samples of the next one. ``report["levels"]`` says where each ends.
        seed: Seed of the random numbers.
        sweeps: Sweeps of gradient ascent.
        threads: As for :func:`remesh`.
        progress: As for :func:`remesh`.

    Returns:
        The points, their normals and attributes, and with ``scan_only`` their indices.

    Raises:
        ArgumentError: A ``ValueError`` for an argument that makes no sense.
        MeshError: For an input that has no surface.
    """
    mesh = as_mesh(vertices, faces, attributes)
    arguments: dict[str, object] = {
        "points": points,
        "edge_length": edge_length,
        "sigma_p": sigma_p,
        "sigma_n": sigma_n,
        "sigma": dict(sigma or {}),
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
    """Extracts all of the smooth implicit surface of a cloud, or of the vertices of a mesh, as dense triangles.

    Args:
        vertices: As for :func:`remesh`.
        faces: As for :func:`remesh`.
        resolution: Edge length of the cells, in the units of the input, by default half the mean spacing of the points.
        smooth: How far points reach, in mean distances of neighbouring ones: the larger, the smoother; 0 takes 2.3,
            as little as leaves no holes. By default 2.7 where there is noise, else as 0.
        normal_fit: As for :func:`remesh`.
        normal_neighbors: As for :func:`remesh`.
        normal_radius: As for :func:`remesh`, in the units of the input.
        attributes: More arrays: ``{"normal": array}`` gives the normals of points, of shape (n, 3).
        threads: As for :func:`remesh`.
        progress: As for :func:`remesh`.

    Raises:
        ArgumentError: A ``ValueError`` for an argument that makes no sense.
        MeshError: For points that no surface goes through.
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
        against: Another mesh of any kind, or a tuple of vertices and faces, to which the distance is measured, in percent of the
            diagonal of its bounding box.
        threads: As for :func:`remesh`.

    Raises:
        ArgumentError: A ``ValueError`` for an argument that makes no sense.
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
        raise ArgumentError("threads", f"{threads} are not possible; give a number from 1 to 1024")
    return threads
