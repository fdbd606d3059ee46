"""Inputs larger than their memory limit: clouds sampled tile by tile, meshes read in blocks, and an estimate for many
machines from measured tiles.

The meshes are rippled tori in binary PLY, with their vertices and triangles in rows.
"""

import numpy as np

from .. import library, mesh
from ..process import Failed
from ..tables import bullets, less, markdown
from . import dense

TITLE = 'Larger than memory'
CLOUDS, QUICK_CLOUDS = [1_400_000, 14_000_000, 140_000_000], [200_000]
SAMPLES, QUICK_SAMPLES = 300_000, 2000
CLOUD_MEMORY = '400M'
# Number of vertices of the tori, around and across.
TORI, QUICK_TORI = [(2240, 1120), (7000, 3572)], [(300, 170)]
VERTICES, QUICK_VERTICES = [13_000, 300_000, 1_000_000], [1000]
MESH_MEMORY = '2G'
# Number of points of the cloud to be sampled as densely by many machines, and number of machines.
MANY, MACHINES = 1_000_000_000, 100
TILES = 16


def run(context):
    name = next(n for n in dense.MODELS if context.case(n))
    model = mesh.read(context.case(name).path)
    quick = context.quick
    clouds, meshes, tiles = [], [], None
    for points in QUICK_CLOUDS if quick else CLOUDS:
        source, samples = context.file('cloud.ply'), QUICK_SAMPLES if quick else SAMPLES
        dense.write(source, model, points, context.seed)
        clouds.append({'input': points, 'wanted': samples,
                       **_out_of_core(context, CLOUD_MEMORY, 'sample', source, context.file('out.ply'), samples)})
        if points == 14_000_000 or quick:
            tiles = {'points': points, 'samples': samples, **_tiles(context, source, samples)}
    for around, across in QUICK_TORI if quick else TORI:
        source = context.file('torus.ply')
        _write_torus(source, around, across)
        for vertices in QUICK_VERTICES if quick else VERTICES:
            meshes.append({'input': 2 * around * across, 'wanted': vertices,
                           **_out_of_core(context, MESH_MEMORY, source, context.file('out.ply'), vertices)})
    return {'model': name, 'clouds': clouds, 'meshes': meshes, 'tiles': tiles,
            'less': less(quick, 'one small cloud and one small mesh')}


def _out_of_core(context, memory, *words):
    return _took(context, *words[:-1], '--points', words[-1], '--out-of-core', '--memory', memory, '--temp', context.scratch)


def _took(context, *words):
    try:
        ran = library.call(context, *words)
    except Failed as failure:
        return {'failed': str(failure)}
    return {'seconds': ran.seconds, 'megabytes': ran.megabytes}


def _tiles(context, source, samples):
    """Measures the steps of sampling by tiles, each tile on one thread."""
    folder = context.file('tiles')
    steps = {'plan': _took(context, 'tiles', 'plan', source, folder, '--points', samples, '--tiles', TILES),
             'sample': _took(context, 'tiles', 'sample', folder, '--threads', 1),
             'merge': _took(context, 'tiles', 'merge', folder, context.file('out.ply'))}
    return steps


def _write_torus(path, around, across):
    """Writes a rippled torus with the radii 1 and 0.4."""
    header = ('ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n'
              'property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n')
    v = 2 * np.pi * np.arange(across) / across
    here, beside = np.arange(across), (np.arange(across) + 1) % across
    faces = np.zeros(2 * across, dtype=[('count', 'u1'), ('corners', '<i4', 3)])
    faces['count'] = 3
    with open(path, 'wb') as f:
        f.write((header % (around * across, 2 * around * across)).encode())
        for u in 2 * np.pi * np.arange(around) / around:
            small = 0.4 + 0.01 * np.sin(40 * u + 3 * np.cos(5 * v)) * np.sin(23 * v) + 0.03 * np.sin(7 * u) * np.cos(4 * v)
            large = 1 + small * np.cos(v)
            rows = np.stack([large * np.cos(u), large * np.sin(u), small * np.sin(v)], axis=1)
            f.write(rows.astype('<f4').tobytes())
        for row in range(around):
            a, b = row * across, (row + 1) % around * across
            faces['corners'][0::2] = np.stack([a + here, b + here, b + beside], axis=1)
            faces['corners'][1::2] = np.stack([a + here, b + beside, a + beside], axis=1)
            f.write(faces.tobytes())


def report(raw, figures):
    header = ['input', 'wanted', 's', 'MB']
    rows = {kind: [[f'{row["input"]:,} {kind}', f'{row["wanted"]:,}', *dense.cells(row)] for row in raw[part]]
            for kind, part in (('points', 'clouds'), ('triangles', 'meshes'))}
    failed = [f'{row["input"]:,} to {row["wanted"]:,}: {row["failed"]}' for row in raw['clouds'] + raw['meshes']
              if 'failed' in row]
    text = (f'`--out-of-core`, whole processes, reading and writing included. Points of the {raw["model"]}, {dense.NOISE} '
            f'spacings of noise, to samples with `--memory {CLOUD_MEMORY}`; tori with ripples to meshes with '
            f'`--memory {MESH_MEMORY}`; all in binary PLY.')
    parts = [text, markdown([header] + rows['points'] + rows['triangles']), bullets(failed), projection(raw['tiles']),
             raw['less']]
    return '\n\n'.join(part for part in parts if part)


def projection(tiles):
    """Returns, in words, what sampling as densely takes for many points on many machines."""
    if any('failed' in tiles[step] for step in ('plan', 'sample', 'merge')):
        return bullets(f'{step}: {tiles[step]["failed"]}' for step in ('plan', 'sample', 'merge') if 'failed' in tiles[step])
    plan, sample, merge = (tiles[step]['seconds'] for step in ('plan', 'sample', 'merge'))
    times = MANY / tiles['points']
    shared = times * sample / MACHINES
    total = times * (plan + merge) + shared
    return (f'**Many machines.** {tiles["points"]:,} points to {tiles["samples"]:,} samples in at least {TILES} tiles: the plan '
            f'{plan:.1f} s, all tiles on one core {sample:.1f} s, the merge {merge:.1f} s. All three are linear in the points. So '
            f'{MANY:,} points, as dense, on {MACHINES} machines of one core each would take {times * plan / 60:.0f} minutes for the '
            f'plan, {shared / 60:.1f} for the tiles and {times * merge / 60:.1f} for the merge: {total / 60:.0f} minutes, and '
            f'{(MACHINES * shared + times * (plan + merge)) / 3600:.1f} hours of a core in all. The plan and the merge are one '
            'process each, so from some machines on more do not help: the plan reads the file twice and writes it sorted, and what '
            'is global in it (the side of normals, the width of the kernel) is decided on a sample of constant size.')
