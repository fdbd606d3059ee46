"""Point clouds with normals: from the binary, to files, and to surfaces that are held against each other."""

import json

import gpytoolbox
import numpy as np
import pymeshlab
import trimesh
from scipy.spatial import cKDTree

from .process import Failed, run


def points_of(context, path):
    """The vertices of a model with unit normals, each (n, 3), in its own units and order."""
    target = context.file('all.xyz')
    # A kernel so narrow keeps every point.
    run([context.binary, 'sample', path, target, '--scan-only', '--sigma-p', '1e-9', '-q'])
    return read_cloud(target)


def scaled(points, size=100.0):
    """Moved and scaled so that the longest side of the bounding box is `size`, as the paper does (section 7)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (points - 0.5 * (low + high)) * (size / (high - low).max())


def load_mesh(path):
    """The triangles of a file, its vertices as they are."""
    return trimesh.load(path, force='mesh', process=False)


def write_cloud(path, points, normals):
    np.savetxt(path, np.concatenate([points, normals], axis=1), fmt='%.17g')


def read_cloud(path):
    """Points and normals of an .xyz file."""
    rows = np.loadtxt(path, ndmin=2)
    return rows[:, :3], rows[:, 3:6]


def scan(context, points, normals, sigma_p, sigma_n):
    """The numbers of the points that our linear scan keeps, and the seconds that it takes by its own report."""
    source, target, report = (context.file('scan' + end) for end in ('.xyz', '.kept.xyz', '.json'))
    write_cloud(source, points, normals)
    command = [context.binary, 'sample', source, target, '--scan-only', '--sigma-p', str(sigma_p)]
    run(command + ['--sigma-n', str(sigma_n), '--seed', str(context.seed), '--report', report, '-q'])
    return np.sort(np.loadtxt(target, usecols=6, dtype=int)), _seconds(report, 'sample')


def _seconds(report, stage):
    with open(report, encoding='utf-8') as f:
        return sum(s['seconds'] for s in json.load(f)['stages'] if s['name'] == stage)


def spacing(points):
    """The mean distance of the sixth neighbour."""
    return float(cKDTree(points).query(points, k=7)[0][:, 6].mean())


# How far points reach at the least, in spacings: the defaults of `remesh reconstruct` and of MeshLab. With less there
# are holes.
LEAST_REACH = {'remesh': 2.2, 'meshlab': 2.0}


def surface_of_remesh(context, name, points, normals, reach, cell):
    """Our implicit surface; points reach `reach` far, and cells have edges of `cell`. Raises `Failed`."""
    source, target = context.file(name + '.xyz'), context.file(name + '.ply')
    write_cloud(source, points, normals)
    smooth = np.clip(reach / spacing(points), LEAST_REACH['remesh'], 20.0)
    run([context.binary, 'reconstruct', source, target, '--smooth', str(smooth), '--resolution', str(cell), '-q'])
    return load_mesh(target)


def surface_of_meshlab(points, normals, reach, cell):
    """The same by MeshLab's RIMLS and marching cubes."""
    found = pymeshlab.MeshSet()
    found.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_normals_matrix=normals))
    resolution = int(np.ceil(np.ptp(points, axis=0).max() / cell))
    scale = max(reach / spacing(points), LEAST_REACH['meshlab'])
    try:
        found.generate_marching_cubes_rimls(filterscale=scale, resolution=resolution)
    except pymeshlab.PyMeshLabException as error:
        raise Failed('MeshLab: %s' % str(error).strip()) from error
    made = found.current_mesh()
    if not made.face_number() or not np.isfinite(made.vertex_matrix()).all():
        raise Failed('MeshLab: no surface')
    return trimesh.Trimesh(made.vertex_matrix(), made.face_matrix(), process=False)


def distance(one, other, seed, samples=30_000):
    """RMS and Hausdorff distance of two surfaces, both ways: from random points of each, evenly by area, to the closest
    triangle of the other; for the Hausdorff distance also from the vertices, as many at most. RMS is the root of the
    mean of both squares."""
    ways = [_one_way(one, other, seed, samples), _one_way(other, one, seed, samples)]
    rms = (sum(way[0] ** 2 for way in ways) / 2) ** 0.5
    return {'rms': float(rms), 'hausdorff': float(max(way[1] for way in ways))}


def _one_way(source, target, seed, samples):
    points = trimesh.sample.sample_surface(source, samples, seed=seed)[0]
    vertices = np.random.default_rng(seed).permutation(source.vertices)[:samples]
    places, faces = np.concatenate([points, vertices]), np.asarray(target.faces, np.int32)
    # It also gives barycentric coordinates, which triangles without area do not have.
    with np.errstate(invalid='ignore', divide='ignore'):
        squares = gpytoolbox.squared_distance(places, np.asarray(target.vertices), faces, use_cpp=True)[0]
    squares = np.maximum(squares, 0)
    return squares[:samples].mean() ** 0.5, squares.max() ** 0.5
