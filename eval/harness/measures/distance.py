"""How far two surfaces are apart, both ways, in percent of the diagonal of the reference's bounding box.

Points are taken evenly by area on each surface, and each has its exact distance to the closest triangle of the other by
libigl's hierarchy (Jacobson and others, libigl, 2018), which gpytoolbox carries. (The closest points of trimesh are off
by up to 1.6e-4 on small models, which is as much as the distances here.) RMS is the root of the mean square of the
samples' distances, Hausdorff the largest distance of the samples and of all vertices: never more than the true one.
"""

import numpy as np


def distances(mesh, reference, samples, seed=0):
    """Distances of `samples` points of each to the other; None where one has no triangles."""
    mesh, reference = mesh.used(), reference.used()
    if not len(mesh.triangles) or not len(reference.triangles):
        return None
    rng = np.random.default_rng(seed)
    out = _one_way(mesh, reference, samples, rng)
    back = _one_way(reference, mesh, samples, rng)
    unit = 100 / reference.diagonal()
    return {
        'rms_out_to_in': unit * out[0],
        'rms_in_to_out': unit * back[0],
        'rms': unit * float(np.hypot(out[0], back[0]) / 2 ** 0.5),
        'hausdorff_out_to_in': unit * out[1],
        'hausdorff_in_to_out': unit * back[1],
        'hausdorff': unit * max(out[1], back[1]),
        'samples': samples,
    }


def to_surface(points, mesh):
    """Exact distance of each point to the closest triangle."""
    import gpytoolbox
    squares = gpytoolbox.squared_distance(points, mesh.vertices, mesh.triangles.astype(np.int32), use_cpp=True)[0]
    return np.sqrt(np.maximum(squares, 0))


def scattered(mesh, count, rng):
    """Random points, evenly by area."""
    areas = np.cumsum(mesh.areas())
    chosen = np.searchsorted(areas, areas[-1] * rng.random(count), side='right')
    a, b, c = mesh.corners()[np.minimum(chosen, len(areas) - 1)].transpose(1, 0, 2)
    u, v = rng.random((2, count, 1))
    # A half of the parallelogram is folded onto the other.
    beyond = u + v > 1
    u, v = np.where(beyond, 1 - u, u), np.where(beyond, 1 - v, v)
    return a + u * (b - a) + v * (c - a)


def _one_way(source, target, samples, rng):
    """Root mean square and maximum of the distances from `source`."""
    found = to_surface(scattered(source, samples, rng), target)
    largest = max(found.max(), to_surface(source.vertices, target).max())
    return float(np.sqrt(np.mean(found ** 2))), float(largest)
