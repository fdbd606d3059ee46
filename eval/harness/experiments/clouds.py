"""Meshes made from the vertices of a model alone, as a point cloud, with and without noise.

The result is compared with the mesh from which the points come. Noise is Gaussian along the normals, with a standard
deviation of a quarter of the mean distance to the six nearest points and a fixed seed. Normals, if given, are those of
the mesh without noise.
"""

from .. import mesh
from ..peers import peer
from ..points import nearest, noisy
from ..race import race
from ..tables import columns, listed
from ..verdicts import against, faults_of, watched_measures

TITLE = 'From points'
MODELS = ['horse', 'koala', 'armadillo', 'bunny', 'igea']
QUICK_MODELS = ['blob']
OWN_MODELS = ['blob', 'noisy', 'shell']
NOISE = 0.25

# Kind: (with normals, with noise).
KINDS = {
    'with normals': (True, False),
    'without normals': (False, False),
    'with normals and noise': (True, True),
    'noise, without normals': (False, True),
}


def run(context):
    names = QUICK_MODELS if context.quick else [n for n in MODELS if context.case(n)] or OWN_MODELS
    kinds = {kind: {} for kind in KINDS}
    for case in map(context.case, names):
        # Without normals, the result is expected to face outwards.
        reference = mesh.read(case.path).outward()
        for kind, (normals, noise) in KINDS.items():
            source = context.file('points.ply')
            points = reference.vertices
            if noise:
                points = noisy(points, reference.normals(), NOISE * nearest(points, 6).mean(), context.seed)
            mesh.write_points(source, points, reference.normals() if normals else None)
            programs = {'remesh': _Smoothing() if noise else peer('remesh'), 'poisson_points': peer('poisson_points')}
            kinds[kind][case.name] = race(programs, source, reference, case.points, case.sharp, 1, context.scratch)
    return {'kinds': kinds, 'noise': NOISE}


class _Smoothing:
    """Our program with `--smooth`."""

    def __init__(self):
        own = peer('remesh')
        self.LABEL, self.COUNTS, self.seconds = own.LABEL, True, own.seconds
        self.command = lambda *given: own.command(*given, ['--smooth'])


TABLES = [
    ('θmin / mean θmin (degrees)', lambda m: '%.1f / %.1f' % (m['shape']['theta_min'], m['shape']['theta_min_mean'])),
    ('Qmin / Qave', lambda m: '%.2f / %.3f' % (m['shape']['q_min'], m['shape']['q_mean'])),
    ('RMS / Hausdorff distance to the mesh (% of the diagonal)', lambda m: '%.3f / %.2f' % (
        m['distance']['rms'], m['distance']['hausdorff'])),
]


def report(raw, _figures):
    names = list(next(iter(raw['kinds'].values())))
    about = ('The vertices of %s as point clouds, at the same counts as above; with noise (Gaussian along the normals, '
             'a quarter of the mean distance to the six nearest points) ours runs with `--smooth`. Beside it MeshLab: '
             'a Poisson-disk subset of the points, joined by ball pivoting. Times are not compared here.'
             % listed(names))
    tables = [columns(heading, names, rows(raw, lambda r: cell(r['measures']))) for heading, cell in TABLES]
    faults = columns('faults', names, rows(raw, lambda r: ', '.join(faults_of(r)) or 'none', failed=faults_of))
    label = peer('poisson_points').LABEL
    lines = ['- %s. %s' % (kind.capitalize(), against(label, found, 'poisson_points', times=False))
             for kind, found in raw['kinds'].items()]
    return '\n\n'.join([about, *tables, faults, '\n'.join(lines)])


def rows(raw, cell, failed=lambda _: ['failed'], programs=('remesh', 'poisson_points')):
    """Returns two rows per kind, for `tables.columns`."""
    found = []
    for kind, models in raw['kinds'].items():
        for name in programs:
            label = '**remesh, %s**' % kind if name == 'remesh' else 'MeshLab, %s' % kind
            cells = {m: failed(r[name])[0] if 'failed' in r[name] else cell(r[name]) for m, r in models.items()}
            found.append((label, cells))
    return found


def watched(raw):
    found = {}
    for kind, models in raw['kinds'].items():
        for name, results in models.items():
            if 'measures' in results['remesh']:
                found |= watched_measures('%s, %s' % (kind, name), results['remesh']['measures'])
    return found
