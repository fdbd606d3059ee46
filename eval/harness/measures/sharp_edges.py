"""Distance of a surface from the sharp edges of another.

Points are sampled uniformly by length on the edges of the reference whose dihedral angle is at least `LEAST` degrees.
Each has its exact distance to the measured surface, in percent of the diagonal of the reference's bounding box: it
shows how far triangles cut an edge off or round it.
"""

import numpy as np

from .distance import to_surface

# Dihedral angle in degrees that is sharp with the settings of all programs that keep sharp edges.
LEAST = 60


def distances(mesh, reference, samples, seed=0):
    """Returns the RMS and largest distance of `samples` points; None if there are no sharp edges, or no triangles."""
    ends = reference.vertices[sharp_edges(reference)]
    if not len(ends) or not len(mesh.triangles):
        return None
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    rng = np.random.default_rng(seed)
    chosen = ends[rng.choice(len(ends), samples, p=lengths / lengths.sum())]
    along = rng.random((samples, 1))
    found = to_surface((1 - along) * chosen[:, 0] + along * chosen[:, 1], mesh.used())
    unit = 0.01 * reference.diagonal()
    return {'rms': float(np.sqrt(np.mean(found ** 2)) / unit), 'largest': float(found.max() / unit)}


def sharp_edges(mesh, least=LEAST):
    """Returns the sharp edges with exactly two faces, as pairs of vertices: (E, 2). Faces without area have no normal,
    and their edges are not sharp."""
    a, b, c = mesh.corners().transpose(1, 0, 2)
    normals, doubled = np.cross(b - a, c - a), 2 * mesh.areas()
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    order = np.argsort(edge.ravel(), kind='stable')
    uses = np.bincount(edge.ravel(), minlength=len(edges))
    first = (np.cumsum(uses) - uses)[uses == 2]
    one, other = order[first] // 3, order[first + 1] // 3
    cosines = np.sum(normals[one] * normals[other], axis=1)
    sizes = doubled[one] * doubled[other]
    return edges[uses == 2][(sizes > 0) & (cosines <= np.cos(np.radians(least)) * sizes)]
