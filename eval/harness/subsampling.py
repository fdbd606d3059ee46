"""Subsampling methods for point clouds by other authors, implemented from their descriptions.

`remove_nearest_to_surface` is AS: M. Alexa, J. Behr, D. Cohen-Or, S. Fleishman, D. Levin, C. Silva, Point set surfaces,
2001, section 4.1. The contribution of a point is its distance from its projection onto the surface defined by the
others. The point with the smallest contribution is removed, and the contributions of the points around it are updated.

`remove_least_of_kernels` is based on KS: M. Kitago, M. Gopi, Efficient and prioritized point subsampling for CSRBF
compression, 2006, as the paper describes it: an iterative simplification by a kernel-based measure. Here, the point is
removed whose removal changes the surface of the kernels least, measured by the squared change of its implicit function,
summed over all input points around it, whether they have been removed or not.

Both use a priority queue and update only what a removal affects. The kernel is exp(-|x - y|²/σ²), cut off at REACH σ.
Departures: the reference plane of AS is the tangent plane given by the point's normal, and the polynomial is quadratic.

Cost: about 0.3 ms per removal. Limits: a point with fewer neighbours than a polynomial needs is kept.
"""

import heapq

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

REACH = 2.0
TERMS = 6
RIDGE = 1e-9


def random_subset(count, wanted, seed):
    """Returns `wanted` random indices below `count`, in increasing order."""
    return np.sort(np.random.default_rng(seed).permutation(count)[:wanted])


def voxel_subset(points, wanted):
    """Returns the point nearest to the centre of each voxel, for the grid that gives about `wanted` points."""
    narrow, wide = 1e-4 * np.ptp(points, axis=0).max(), np.ptp(points, axis=0).max()
    for _ in range(30):
        size = (narrow * wide) ** 0.5
        narrow, wide = (size, wide) if len(_one_a_voxel(points, size)) > wanted else (narrow, size)
    return _one_a_voxel(points, wide)


def _one_a_voxel(points, size):
    voxels = np.floor(points / size)
    off = np.linalg.norm(points / size - voxels - 0.5, axis=1)
    order = np.lexsort((off, *voxels.T))
    is_first = np.ones(len(points), bool)
    is_first[1:] = np.any(voxels[order][1:] != voxels[order][:-1], axis=1)
    return np.sort(order[is_first])


class Neighbours:
    """The neighbours of each point within REACH σ, as rows of one array, and their weights."""

    def __init__(self, points, sigma):
        one, other = cKDTree(points).query_pairs(REACH * sigma, output_type='ndarray').astype(np.int32).T
        half = csr_matrix((np.ones(len(one), bool), (one, other)), (len(points), len(points)))
        both = half + half.T
        both.sort_indices()
        self.start, self.other = both.indptr, both.indices
        self.here = np.repeat(np.arange(len(points), dtype=np.int32), np.diff(self.start))
        self.weight = np.exp(-np.sum((points[self.here] - points[self.other]) ** 2, axis=1) / sigma ** 2)

    def row(self, i):
        return slice(self.start[i], self.start[i + 1])

    def rows(self, several):
        """Returns the array positions of all rows of `several`, one row after the other."""
        first, count = self.start[several], self.start[several + 1] - self.start[several]
        before = np.cumsum(count) - count
        return np.arange(count.sum()) + np.repeat(first - before, count)


def remove_nearest_to_surface(points, normals, wanted, sigma):
    """Returns the indices of the `wanted` points that AS keeps, in increasing order. `sigma` is the kernel width."""
    near = Neighbours(points, sigma)
    across, along = _frames(normals)

    def terms(here, other):
        """Returns the polynomial's terms at `other` over the plane of `here`, and the height there."""
        d = (points[other] - points[here]) / sigma
        u, v, height = (np.einsum('ij,ij->i', d, axis[here]) for axis in (across, along, normals))
        return np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1), height

    matrix, right = np.zeros((len(points), TERMS, TERMS)), np.zeros((len(points), TERMS))
    neighbours = np.diff(near.start)
    for part in np.array_split(np.arange(len(near.here)), len(near.here) // 1_000_000 + 1):
        here, weight = near.here[part], near.weight[part, None]
        t, height = terms(here, near.other[part])
        for k in range(TERMS):
            right[:, k] += np.bincount(here, (weight[:, 0] * height) * t[:, k], len(points))
            for l in range(TERMS):
                matrix[:, k, l] += np.bincount(here, weight[:, 0] * t[:, k] * t[:, l], len(points))

    def contributions(of):
        """Returns the distance of each point from the polynomial fitted to the others."""
        height = np.linalg.solve(matrix[of] + RIDGE * np.eye(TERMS), right[of][..., None])[:, 0, 0]
        return np.where(neighbours[of] > TERMS, np.abs(height), np.inf)

    def without(i, alive):
        row = near.row(i)
        stays = alive[near.other[row]]
        around, weight = near.other[row][stays], near.weight[row][stays, None]
        t, height = terms(around, i)
        matrix[around] -= (weight * t)[:, :, None] * t[:, None, :]
        right[around] -= weight * height[:, None] * t
        neighbours[around] -= 1
        return around, contributions(around)

    first = np.concatenate([contributions(part) for part in np.array_split(np.arange(len(points)), 64)])
    return _remove_one_by_one(first, without, wanted)


def _frames(normals):
    """Returns two unit vectors perpendicular to each normal."""
    least = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    across = np.cross(normals, least)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return across, np.cross(normals, across)


def remove_least_of_kernels(points, normals, wanted, sigma):
    """Returns the indices of the `wanted` points that KS keeps, in increasing order. `sigma` is the kernel width."""
    near = Neighbours(points, sigma)
    count = len(points)
    # f(x) = Σ wᵢ nᵢᵀ(x - pᵢ) / Σ wᵢ at each input point; the point itself has the weight 1 and the value 0.
    value = np.einsum('ij,ij->i', normals[near.other], points[near.here] - points[near.other])
    above = np.bincount(near.here, near.weight * value, count)
    below = 1.0 + np.bincount(near.here, near.weight, count)
    # The rows from the point of view of the removed point: the change at `other` if `here` is removed.
    seen = np.einsum('ij,ij->i', normals[near.here], points[near.other] - points[near.here])

    def changes(at, places):
        """Returns the squared change of f at the points `at` if those of `places` are removed."""
        left = below[at] - near.weight[places]
        change = (above[at] - near.weight[places] * seen[places]) / np.maximum(left, RIDGE) - above[at] / below[at]
        # Where no points are left, there is no surface any more.
        return np.where(left > 1e-6, np.minimum(change ** 2, sigma ** 2), sigma ** 2)

    def own(of):
        """Returns the same at the removed points themselves."""
        left = below[of] - 1.0
        change = np.where(left > 1e-6, above[of] / np.maximum(left, RIDGE) - above[of] / below[of], sigma)
        return np.minimum(change ** 2, sigma ** 2)

    def costs(of):
        places = near.rows(of)
        index = np.repeat(np.arange(len(of)), near.start[of + 1] - near.start[of])
        return own(of) + np.bincount(index, changes(near.other[places], places), len(of))

    def without(i, alive):
        row = near.row(i)
        around = near.other[row]
        above[around] -= near.weight[row] * seen[row]
        below[around] -= near.weight[row]
        below[i] -= 1.0
        below[i] = max(below[i], RIDGE)
        touched = around[alive[around]]
        return touched, costs(touched)

    return _remove_one_by_one(costs(np.arange(count)), without, wanted)


def _remove_one_by_one(cost, without, wanted):
    """Removes the point with the lowest cost until `wanted` are left. `without(i, alive)` returns the points whose
    costs change when `i` is removed, and their new costs."""
    cost = cost.copy()
    alive = np.ones(len(cost), bool)
    queue = [(c, i) for i, c in enumerate(cost.tolist())]
    heapq.heapify(queue)
    for _ in range(len(cost) - wanted):
        while True:
            least, i = heapq.heappop(queue)
            if alive[i] and cost[i] == least:
                break
        alive[i] = False
        touched, now = without(i, alive)
        cost[touched] = now
        for entry in zip(now.tolist(), touched.tolist()):
            heapq.heappush(queue, entry)
    return np.flatnonzero(alive)
