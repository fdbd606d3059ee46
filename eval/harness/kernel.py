"""The paper's kernels and its measure s, implemented from its equations and independent of the library.

Heat kernel of the plane: h(x, y) = exp(-|x - y|² / 4t) / 4πt (section 4.1). Heat kernel of the unit sphere:
h(x, y) = Σ (2l + 1)/4π exp(-l(l + 1)t) Pₗ(x·y), the expansion (6) with its spherical harmonics summed for each l.
Kernel of the algorithms: k(x, y) = exp(-|x - y|²), with x in units of σ (section 3).
Measure: s(x) = 1 - kᵀ K⁻¹ k / k(x, x) (equations 8 and 9), by least squares, since K may be close to singular.
"""

import numpy as np
from scipy.special import eval_legendre


def gaussian(x, y):
    """Returns k(x, y) as (n, m), for points (n, d) and (m, d) in units of σ."""
    return np.exp(-np.sum((x[:, None] - y[None]) ** 2, axis=2))


def heat_kernel_of_plane(x, y, t):
    return gaussian(x / (4 * t) ** 0.5, y / (4 * t) ** 0.5) / (4 * np.pi * t)


def heat_kernel_of_sphere(x, y, t):
    """Returns the heat kernel for unit vectors. Terms are summed until they are below rounding error."""
    cosines = np.clip(x @ y.T, -1, 1)
    last = int(np.ceil((40 / t) ** 0.5))
    terms = ((2 * l + 1) / (4 * np.pi) * np.exp(-l * (l + 1) * t) * eval_legendre(l, cosines) for l in range(last + 1))
    return sum(terms)


def eigenvalues(kernel, points):
    """Returns the eigenvalues of a kernel's matrix in decreasing order."""
    return np.linalg.eigvalsh(kernel(points, points))[::-1]


def measure(kernel, points, queries):
    """Returns s at each of `queries` for the set `points`."""
    among, across = kernel(points, points), kernel(points, queries)
    own = np.array([kernel(q[None], q[None])[0, 0] for q in queries])
    shares = np.linalg.lstsq(among, across, rcond=1e-12)[0]
    return 1 - np.einsum('ij,ij->j', across, shares) / own


def measure_by_neighbours(kernel, points, x):
    """Returns s(x) computed from the nearest point, from the two nearest, and so on up to all points."""
    order = np.argsort(np.sum((points - x) ** 2, axis=1), kind='stable')
    return np.array([measure(kernel, points[order[:n]], x[None])[0] for n in range(1, len(points) + 1)])
