"""CAD parts: this program and the others that can keep sharp edges, at one vertex count."""

import dataclasses

from .. import mesh
from ..measures.crossings import crossing_faces
from ..measures.topology import is_manifold, topology
from ..peers import NAMES, OURS, peer
from ..tables import listed, markdown, spread
from ..verdicts import MEASURES, counts, faults_of, mostly, watched_measures
from .remeshers import programs_at_hand, race_on, rule, shape_of, tables

TITLE = 'CAD parts'
POINTS = 5000
PROGRAMS = ['remesh', 'meshlab', 'cgal', 'gpytoolbox', 'mmgs', 'meshlib', 'instant_meshes']


def run(context):
    programs, listing = programs_at_hand(PROGRAMS, context.quick)
    return {'programs': listing, 'points': POINTS,
            'models': {case.name: _one(case, programs, context) for case in context.cases if case.sharp}}


def _one(case, programs, context):
    # Coincident vertices of a file are merged for all programs, as ours does when reading.
    given = mesh.read(case.path).welded()
    kind = {'vertices': len(given.vertices), 'manifold': is_manifold(topology(given)),
            'crossing_faces': crossing_faces(given)}
    return race_on(dataclasses.replace(case, points=POINTS), given, programs, 1, context) | {'input': kind}


TABLES = [
    ('θmin / mean θmin (degrees) / % < 30°', lambda r: '%.1f / %.1f / %.2f' % (
        shape_of(r)['theta_min'], shape_of(r)['theta_min_mean'], shape_of(r)['percent_below_30'])),
    ('Qmin / Qave', lambda r: '%.2f / %.3f' % (shape_of(r)['q_min'], shape_of(r)['q_mean'])),
    ('RMS / Hausdorff distance (% of the diagonal)', lambda r: '%.3f / %.2f' % (
        r['measures']['distance']['rms'], r['measures']['distance']['hausdorff'])),
    ('RMS / largest distance of sharp edges (% of the diagonal)', lambda r: _edges(r['measures']['sharp_edges'])),
    ('vertices / crossing faces', lambda r: '{:,} / {}'.format(r['vertices'], r['measures']['crossing_faces'])),
    ('seconds of the whole process', lambda r: spread(r['process_seconds'])),
    ('faults', lambda r: ', '.join(faults_of(r)) or 'none'),
]


def _edges(found):
    return '%.3f / %.2f' % (found['rms'], found['largest']) if found else '-'


def report(raw, _figures):
    return '\n\n'.join([_introduction(raw), *tables(TABLES, raw), '### Better and worse on CAD parts', rule(raw),
                        _counts(raw), _verdicts(raw)])


def _introduction(raw):
    models = raw['models']
    without = [peer(name).LABEL for name in NAMES if name not in PROGRAMS and name not in OURS]
    text = ('Parts whose sharp edges are to stay, each at %s vertices. Programs have their settings for sharp edges; '
            'ours needs none. Left out are those without such a setting: %s. All read the same PLY file, in which '
            'vertices at one place are one. Seconds are of one run, and are not compared.'
            % ('{:,}'.format(raw['points']), listed(without)))
    broken = [name for name, m in models.items() if not m['input']['manifold']]
    crossing = ['%s (%d)' % (name, m['input']['crossing_faces']) for name, m in models.items()
                if m['input']['crossing_faces']]
    if broken:
        text += (' No oriented manifold in the input, so that another topology is no fault of a program: %s.'
                 % listed(broken))
    if crossing:
        text += ' Faces that cross in the input: %s.' % listed(crossing)
    return text


def _others(raw):
    """Returns the other available programs with their labels, and all results by model."""
    results = {name: model['results'] for name, model in raw['models'].items()}
    return {n: p['label'] for n, p in raw['programs'].items() if n not in OURS and 'version' in p}, results


def _counts(raw):
    others, results = _others(raw)
    rows = [['parts on which ours is better : worse'] + [measure.label for measure in MEASURES]]
    for name, label in others.items():
        found, number = counts(results, name)
        rows.append(['%s, of %d' % (label, number)] + ['%d : %d' % pair for pair in found.values()])
    return markdown(rows)


def _verdicts(raw):
    others, results = _others(raw)
    return '\n'.join('- ' + mostly(label, results, name) for name, label in others.items())


def watched(raw):
    found = {}
    for name, model in raw['models'].items():
        ours = model['results']['remesh']
        found['%s remeshed' % name] = (int('measures' in ours), 1, 0)
        if 'measures' in ours:
            found |= watched_measures(name, ours['measures'])
    return found
