"""Points on a toroidal square: Lloyd's method, spectra, and the Poisson-disk radius.

Lloyd's method moves each point to the centroid of its Voronoi cell (S. Lloyd, Least squares quantization in PCM, 1982).
Periodogram, radial power and anisotropy: R. A. Ulichney, Digital halftoning, 1987, chapter 3. Poisson-disk radius:
A. Lagae, P. Dutré, A comparison of methods for generating Poisson disk distributions, 2008.
"""

import numpy as np
from scipy.spatial import Voronoi, cKDTree

# Width around the square in which its copies count. No empty disk among a few hundred random points is as large.
MARGIN = 0.2


def lloyd(points, iterations):
    """Returns `points` (n, 2) of the unit square after this number of iterations."""
    for _ in range(iterations):
        points = centroids(points)[0] % 1.0
    return points


def centroids(points):
    """Returns the centroids of the Voronoi cells on the torus, and the energy: the integral over the square of the
    squared distance to the nearest point."""
    count = len(points)
    copies = np.concatenate([points] + [points + [i, j] for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)])
    copies = copies[np.all((copies > -MARGIN) & (copies < 1 + MARGIN), axis=1)]
    cells = Voronoi(copies)
    ridges = np.array(cells.ridge_vertices)
    pairs = cells.ridge_points
    # Each side of a cell forms a triangle with the cell's point.
    pairs, ridges = np.concatenate([pairs, pairs[:, ::-1]]), np.concatenate([ridges, ridges])
    own = (pairs[:, 0] < count) & np.all(ridges >= 0, axis=1)
    at = pairs[own, 0]
    a, b = (cells.vertices[ridges[own, k]] - copies[at] for k in (0, 1))
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    total = np.bincount(at, area, count)
    shift = np.stack([np.bincount(at, area * (a + b)[:, k] / 3, count) for k in (0, 1)], axis=1)
    energy = np.sum(area * (np.sum(a * a, axis=1) + np.sum(b * b, axis=1) + np.sum(a * b, axis=1)) / 6)
    return points + shift / total[:, None], float(energy)


def radius(points):
    """Returns ρ: half the distance of the closest pair, relative to that of hexagonal packing."""
    nearest = cKDTree(points % 1.0, boxsize=1.0).query(points % 1.0, k=2)[0][:, 1].min()
    return float(0.5 * nearest * (2 * 3 ** 0.5 * len(points)) ** 0.5)


def periodogram(points, highest):
    """Returns |Σ exp(-2πi f·x)|² / n at integer frequencies f from -highest to highest: (2 highest + 1) squared."""
    frequencies = np.arange(-highest, highest + 1)
    along = np.exp(-2j * np.pi * np.outer(frequencies, points[:, 0]))
    up = np.exp(-2j * np.pi * np.outer(frequencies, points[:, 1]))
    return np.abs(up @ along.T) ** 2 / len(points)


def rings(power):
    """Returns the mean power over the rings |f| = 1, 2 .., and its variance relative to the squared mean, in decibels.
    Of each pair of opposite frequencies, which have the same power, only one counts."""
    highest = len(power) // 2
    v, u = np.mgrid[-highest:highest + 1, -highest:highest + 1]
    ring = np.rint(np.hypot(u, v)).astype(int)
    counts = ((v > 0) | ((v == 0) & (u > 0))) & (ring <= highest)
    members = [power[counts & (ring == r)] for r in range(1, highest + 1)]
    mean = np.array([m.mean() for m in members])
    variance = np.array([m.var(ddof=1) for m in members])
    return mean, 10 * np.log10(variance / mean ** 2)
