"""Distances between two surfaces, in both directions.

Points are sampled uniformly by area on each surface. The exact distance of each to the closest triangle of the other
surface is computed with libigl's hierarchy (Jacobson and others, libigl, 2018), which gpytoolbox includes. RMS is the
root mean square of the samples' distances. Hausdorff is the largest distance of the samples and of all vertices, which
never exceeds the true one.
"""

import numpy as np


def distances(mesh, reference, samples, seed=0):
    """Returns the distances from `samples` points of each mesh to the other, in percent of the diagonal of the
    reference's bounding box; None if one has no triangles."""
    return apart(mesh, reference, samples, seed, unit=0.01 * reference.diagonal())


def apart(mesh, reference, samples, seed=0, unit=1.0):
    """Returns the same as `distances`, in multiples of `unit`."""
    mesh, reference = mesh.used(), reference.used()
    if not len(mesh.triangles) or not len(reference.triangles):
        return None
    rng = np.random.default_rng(seed)
    out = _one_way(mesh, reference, samples, rng)
    back = _one_way(reference, mesh, samples, rng)
    return {
        'rms_out_to_in': out[0] / unit,
        'rms_in_to_out': back[0] / unit,
        'rms': float(np.hypot(out[0], back[0]) / 2 ** 0.5 / unit),
        'hausdorff_out_to_in': out[1] / unit,
        'hausdorff_in_to_out': back[1] / unit,
        'hausdorff': max(out[1], back[1]) / unit,
        'samples': samples,
    }


def to_surface(points, mesh):
    """Returns the exact distance of each point to the closest triangle."""
    import gpytoolbox
    squares = gpytoolbox.squared_distance(points, mesh.vertices, mesh.triangles.astype(np.int32), use_cpp=True)[0]
    return np.sqrt(np.maximum(squares, 0))


def scattered(mesh, count, rng):
    """Returns random points, uniform by area: the indices of their triangles, and the corner weights (count, 3)."""
    areas = np.cumsum(mesh.areas())
    chosen = np.searchsorted(areas, areas[-1] * rng.random(count), side='right')
    u, v = rng.random((2, count))
    # Points in one half of the parallelogram are folded onto the other half.
    beyond = u + v > 1
    u, v = np.where(beyond, 1 - u, u), np.where(beyond, 1 - v, v)
    return np.minimum(chosen, len(areas) - 1), np.stack([1 - u - v, u, v], axis=1)


def blended(mesh, values, scattered_points):
    """Returns vertex values (V, k) interpolated at such points: (count, k)."""
    triangles, weights = scattered_points
    return np.einsum('ij,ijk->ik', weights, values[mesh.triangles[triangles]])


def _one_way(source, target, samples, rng):
    """Returns the root mean square and the maximum of the distances from `source` to `target`."""
    places = blended(source, source.vertices, scattered(source, samples, rng))
    found = to_surface(places, target)
    largest = max(found.max(), to_surface(source.vertices, target).max())
    return float(np.sqrt(np.mean(found ** 2))), float(largest)
