"""Point clouds with normals: spacing, noise, files, and MeshLab's surface of a cloud."""

import numpy as np
import pymeshlab
from scipy.spatial import cKDTree

from .mesh import Mesh
from .process import Failed


def nearest(points, count=1):
    """Returns the distances of each point to its `count` nearest neighbours: (n, count)."""
    return cKDTree(points).query(points, k=count + 1)[0][:, 1:]


def scaled(points, size=100.0):
    """Returns the points moved and scaled so that the longest side of the bounding box is `size` (paper, section 7)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (points - 0.5 * (low + high)) * (size / (high - low).max())


def noisy(points, normals, deviation, seed):
    """Returns the points moved along their normals by Gaussian noise, which `deviation` scales for a given seed."""
    return points + deviation * np.random.default_rng(seed).normal(size=(len(points), 1)) * normals


def write_xyz(path, *columns):
    """Writes text with one point per line: position, and normal if given."""
    np.savetxt(path, np.concatenate(columns, axis=1), fmt='%.17g')


def read_xyz(path):
    """Returns the points and normals of an .xyz file."""
    rows = np.loadtxt(path, ndmin=2)
    return rows[:, :3], rows[:, 3:6]


def reach(points, far, least):
    """Returns the support radius in mean distances of the sixth neighbour, the unit of both methods of making a
    surface: `far`, which is in length units, or `least` if that is more. Below a program's default there would be
    holes."""
    return max(far / nearest(points, 6)[:, -1].mean(), least)


# MeshLab's default.
LEAST_REACH = 2.0


def surface_of_meshlab(points, normals, far, cell):
    """Returns the surface of a cloud by MeshLab's RIMLS and marching cubes, with support radius `far` and cell edges
    of `cell`. Raises `Failed`."""
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
