"""Point clouds with normals: their spacing, noise and files, and the surface that MeshLab makes of one."""

import numpy as np
import pymeshlab
from scipy.spatial import cKDTree

from .mesh import Mesh
from .process import Failed


def nearest(points, count=1):
    """Distances of each point to the `count` nearest others: (n, count)."""
    return cKDTree(points).query(points, k=count + 1)[0][:, 1:]


def scaled(points, size=100.0):
    """Moved and scaled so that the longest side of the bounding box is `size`, as the paper does (section 7)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (points - 0.5 * (low + high)) * (size / (high - low).max())


def noisy(points, normals, deviation, seed):
    """Points moved along their normals by Gaussian noise. The same seed gives the same noise but for the deviation."""
    return points + deviation * np.random.default_rng(seed).normal(size=(len(points), 1)) * normals


def write_xyz(path, *columns):
    """Text, a point a line: positions, and normals where they are given."""
    np.savetxt(path, np.concatenate(columns, axis=1), fmt='%.17g')


def read_xyz(path):
    """Points and normals of an .xyz file."""
    rows = np.loadtxt(path, ndmin=2)
    return rows[:, :3], rows[:, 3:6]


def reach(points, far, least):
    """How far points reach in distances of the sixth neighbour, the measure of both ways to make a surface: `far` in
    units, or `least` where that is more. With less than a program's default there are holes."""
    return max(far / nearest(points, 6)[:, -1].mean(), least)


# The default of MeshLab.
LEAST_REACH = 2.0


def surface_of_meshlab(points, normals, far, cell):
    """The surface of a cloud by MeshLab's RIMLS and marching cubes; points reach `far`, and cells have edges of `cell`.
    Raises `Failed`."""
    found = pymeshlab.MeshSet()
    found.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_normals_matrix=normals))
    resolution = int(np.ceil(np.ptp(points, axis=0).max() / cell))
    try:
        found.generate_marching_cubes_rimls(filterscale=reach(points, far, LEAST_REACH), resolution=resolution)
    except pymeshlab.PyMeshLabException as error:
        raise Failed('MeshLab: %s' % str(error).strip()) from error
    made = found.current_mesh()
    if not made.face_number() or not np.isfinite(made.vertex_matrix()).all():
        raise Failed('MeshLab: no surface')
    return Mesh(made.vertex_matrix(), made.face_matrix().astype(np.int64))
