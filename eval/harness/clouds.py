"""Point clouds with normals: from the binary, to files, and to surfaces that are held against each other."""

import json

import numpy as np
import pymeshlab
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


def surface_of_remesh(context, name, points, normals, reach, cell):
    """(vertices, faces) of our implicit surface; points reach `reach` far, and cells have edges of `cell`."""
    source, target = context.file(name + '.xyz'), context.file(name + '.ply')
    write_cloud(source, points, normals)
    smooth = np.clip(reach / spacing(points), 1.5, 20.0)
    run([context.binary, 'reconstruct', source, target, '--smooth', str(smooth), '--resolution', str(cell), '-q'])
    found = pymeshlab.MeshSet()
    found.load_new_mesh(target)
    return found.current_mesh().vertex_matrix(), found.current_mesh().face_matrix()


def surface_of_meshlab(points, normals, reach, cell):
    """The same by MeshLab's RIMLS and marching cubes."""
    found = pymeshlab.MeshSet()
    found.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_normals_matrix=normals))
    resolution = int(np.ceil(np.ptp(points, axis=0).max() / cell))
    try:
        found.generate_marching_cubes_rimls(filterscale=reach / spacing(points), resolution=resolution)
    except pymeshlab.PyMeshLabException as error:
        raise Failed('MeshLab: %s' % str(error).strip()) from error
    return found.current_mesh().vertex_matrix(), found.current_mesh().face_matrix()


def distance(one, other, samples=50_000):
    """RMS and Hausdorff distance of two meshes (vertices, faces), both ways, by MeshLab's filter, which is what became of
    the Metro tool of the paper. RMS is the root of the mean of both squares, Hausdorff the larger."""
    both = pymeshlab.MeshSet()
    both.add_mesh(pymeshlab.Mesh(*one))
    both.add_mesh(pymeshlab.Mesh(*other))
    ways = [both.get_hausdorff_distance(sampledmesh=a, targetmesh=1 - a, samplevert=False, sampleface=True,
                                        samplenum=samples, maxdist=pymeshlab.PercentageValue(100)) for a in (0, 1)]
    rms = (sum(way['RMS'] ** 2 for way in ways) / 2) ** 0.5
    return {'rms': rms, 'hausdorff': max(way['max'] for way in ways)}
