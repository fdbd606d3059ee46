"""Time and memory against the number of points of a dense cloud, for samples and for a finished mesh.

The points are random points of a model, moved along its normals by Gaussian noise of a fifth of their spacing, in
binary PLY.
"""

import numpy as np

from .. import library, mesh
from ..process import Failed
from ..tables import bullets, less, markdown

TITLE = 'Dense clouds'
MODELS = ['armadillo', 'blob']
SIZES, QUICK_SIZES = [1_400_000, 14_000_000], [400_000]
POINTS, QUICK_POINTS = [13_000, 50_000, 300_000], [5000]
NOISE = 0.2
BLOCK = 1_000_000
TASKS = {'samples': ['sample'], 'mesh': []}


def run(context):
    name = next(n for n in MODELS if context.case(n))
    model = mesh.read(context.case(name).path)
    sizes, points = (QUICK_SIZES, QUICK_POINTS) if context.quick else (SIZES, POINTS)
    rows = []
    for size in sizes:
        source = context.file('dense.ply')
        write(source, model, size, context.seed)
        for wanted in points:
            rows.append({'input': size, 'wanted': wanted,
                         **{task: _took(context, words, source, wanted) for task, words in TASKS.items()}})
    return {'model': name, 'rows': rows, 'less': less(context.quick, 'one small cloud')}


def _took(context, words, source, wanted):
    try:
        ran = library.call(context, *words, source, context.file('out.ply'), '--points', wanted, '--seed', context.seed)
    except Failed as failure:
        return {'failed': str(failure)}
    return {'seconds': ran.seconds, 'megabytes': ran.megabytes}


def write(path, model, size, seed):
    """Writes `size` points of the model, in blocks."""
    rng = np.random.default_rng(seed)
    corners, normals = model.corners(), model.normals()[model.triangles]
    areas = model.areas()
    share, spacing = np.cumsum(areas) / areas.sum(), (areas.sum() / size) ** 0.5
    columns = ''.join('property float %s\n' % c for c in ['x', 'y', 'z', 'nx', 'ny', 'nz'])
    with open(path, 'wb') as f:
        f.write(('ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n' % (size, columns)).encode())
        for first in range(0, size, BLOCK):
            count = min(BLOCK, size - first)
            t = np.minimum(np.searchsorted(share, rng.random(count)), len(areas) - 1)
            root, other = rng.random(count) ** 0.5, rng.random(count)
            weights = np.stack([1 - root, root * (1 - other), root * other], axis=1)[:, :, None]
            n = (weights * normals[t]).sum(axis=1)
            n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-30)
            p = (weights * corners[t]).sum(axis=1) + NOISE * spacing * rng.standard_normal((count, 1)) * n
            f.write(np.hstack([p, n]).astype('<f4').tobytes())


def report(raw, figures):
    header = ['points of the cloud', 'wanted', *(f'{task}, {unit}' for task in TASKS for unit in ('s', 'MB'))]
    rows = [[f'{row["input"]:,}', f'{row["wanted"]:,}', *(cell for task in TASKS for cell in cells(row[task]))]
            for row in raw['rows']]
    failed = [f'{row["input"]:,} points to {row["wanted"]:,}, {task}: {row[task]["failed"]}'
              for row in raw['rows'] for task in TASKS if 'failed' in row[task]]
    text = (f'Points of the {raw["model"]}, {NOISE} spacings of noise, in binary PLY: `remesh sample --points` and '
            '`remesh --points`, whole processes, reading and writing included.')
    return '\n\n'.join(part for part in [text, markdown([header] + rows), bullets(failed), raw['less']] if part)


def cells(took):
    """Returns seconds and megabytes as text."""
    return ['-', '-'] if 'failed' in took else [f'{took["seconds"]:.1f}', f'{took["megabytes"]:.0f}']
