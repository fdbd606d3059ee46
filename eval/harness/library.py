"""Calls the library through its binary and its examples."""

import json

import numpy as np

from . import mesh
from .points import reach, read_xyz, write_xyz
from .process import run

# Seconds after which a program counts as hanging.
TIMEOUT = 300

# Smallest and largest support radius with which a surface is made, in distances of the sixth neighbour. The smallest is
# the default.
LEAST_REACH, MOST_REACH = 2.2, 20.0


def call(context, *words):
    """Runs the binary, and returns its time, memory and output. Exit status 3 means an unverified mesh."""
    return run([context.binary, *map(str, words), '--quiet'], TIMEOUT, (0, 3))


def example(context, name, *words):
    """Runs an example, and returns its time, memory and output."""
    return run([context.example(name), *map(str, words)], TIMEOUT)


def measure(context, points, queries):
    """Returns the library's s at `queries` for neighbours `points`, in units of σ: (queries, neighbours counted)."""
    files = context.file('neighbours.txt'), context.file('queries.txt')
    for path, rows in zip(files, (points, queries)):
        np.savetxt(path, rows, fmt='%.17g')
    lines = example(context, 'measure', *files).output.splitlines()
    return np.array([[float(word) for word in line.split()] for line in lines])


def samples(context, path, *options):
    """Returns positions and normals of samples of a surface, by `remesh sample`."""
    target = context.file('samples.xyz')
    call(context, 'sample', path, target, '--seed', context.seed, *options)
    return read_xyz(target)


def scan(context, points, normals, sigma_p, sigma_n):
    """Returns the indices of the points kept by our linear scan, and its seconds according to its own report."""
    source, target, report = (context.file('scan' + end) for end in ('.xyz', '.kept.xyz', '.json'))
    write_xyz(source, points, normals)
    call(context, 'sample', source, target, '--scan-only', '--sigma-p', sigma_p, '--sigma-n', sigma_n,
         '--seed', context.seed, '--report', report)
    with open(report, encoding='utf-8') as f:
        seconds = sum(stage['seconds'] for stage in json.load(f)['stages'] if stage['name'] == 'sample')
    return np.sort(np.loadtxt(target, usecols=6, dtype=int)), seconds


def remesh(context, source, target, points, *options):
    """Remeshes a file and returns the result."""
    call(context, source, target, '--points', points, '--seed', context.seed, *options)
    return mesh.read(target)


def surface(context, name, points, normals, far, cell):
    """Returns the surface of a cloud by `remesh reconstruct`, with support radius `far` and cell edges of `cell`."""
    source, target = context.file(name + '.xyz'), context.file(name + '.ply')
    write_xyz(source, points, normals)
    smooth = min(reach(points, far, LEAST_REACH), MOST_REACH)
    call(context, 'reconstruct', source, target, '--smooth', smooth, '--resolution', cell)
    return mesh.read(target)
