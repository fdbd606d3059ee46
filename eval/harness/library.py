"""What the library says, through its binary and its examples."""

import numpy as np
from scipy.spatial import cKDTree

from .process import run


def measure(context, points, queries):
    """s of the library at `queries` for the neighbours `points`, in units of σ: (queries, neighbours counted)."""
    files = context.file('neighbours.txt'), context.file('queries.txt')
    for path, rows in zip(files, (points, queries)):
        np.savetxt(path, rows, fmt='%.17g')
    lines = run([context.example('measure'), *files]).output.splitlines()
    return np.array([[float(word) for word in line.split()] for line in lines])


def samples(context, path, *options):
    """Positions and normals of samples of a surface, by `remesh sample`."""
    target = context.file('samples.xyz')
    run([context.binary, 'sample', path, target, '--seed', str(context.seed), '-q', *options])
    rows = np.loadtxt(target)
    return rows[:, :3], rows[:, 3:6]


def nearest(points, count=1):
    """Distances of each point to the `count` nearest others: (n, count)."""
    return cKDTree(points).query(points, k=count + 1)[0][:, 1:]
