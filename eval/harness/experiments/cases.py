"""This program on all available models, read from their original files."""

import json
import os

from .. import mesh
from ..measures.topology import is_manifold
from ..peers import peer
from ..race import median_of, race
from ..tables import markdown, number, spread
from ..verdicts import MEASURES, watched_measures

TITLE = 'All models'
ROUNDS = 3

# Relative variation of seconds and megabytes between runs on one machine.
TIME_NOISE, MEMORY_NOISE = 0.25, 0.1


def run(context):
    rounds = 1 if context.quick else ROUNDS
    return {'rounds': rounds, 'models': {case.name: _one(case, rounds, context) for case in context.cases}}


def _one(case, rounds, context):
    # As the program reads it: seams whose vertices coincide are closed.
    reference = mesh.read(case.path).welded()
    found = race({'remesh': peer('remesh')}, case.path, reference, case.points, case.sharp, rounds, context.scratch)
    result = found['remesh']
    if 'failed' not in result:
        with open(os.path.join(context.scratch, 'remesh.ply.json'), encoding='utf-8') as f:
            result['verified'] = json.load(f)['verified']
    return {'points': case.points, 'vertices_in': len(reference.vertices), 'result': result}


def report(raw, _figures):
    times = 'one run' if raw['rounds'] == 1 else 'the median of %d runs (least..greatest)' % raw['rounds']
    about = ('Each model from its own file, `--points N` and nothing else. Seconds are of the whole process, reading, '
             'measuring and writing included: %s. "Sound" is by the code of this harness: an oriented manifold of the '
             'topology of the input, or only "manifold" where the input itself is none; "verified" is what the program '
             'says.' % times)
    return '%s\n\n%s' % (about, table(raw, lambda result: spread(result['process_seconds'])))


def table(raw, seconds):
    """Returns a table with one row per model; `seconds` formats the times of a result. docs/figures.md also uses it."""
    heading = ['model', 'vertices in', 'asked', 'out', 'Qave', 'Qmin', 'θmin', 'mean θmin', 'θmax', '% < 30°',
               '% valence 6', 'RMS %', 'Hausdorff %', 'seconds', 'MB', 'sound', 'verified']
    return markdown([heading] + [_row(name, model, seconds) for name, model in raw['models'].items()])


def _row(name, model, seconds):
    result = model['result']
    asked = [name, '{:,}'.format(model['vertices_in']), '{:,}'.format(model['points'])]
    if 'failed' in result:
        return asked + [''] * 12 + ['no', 'failed']
    found = result['measures']
    shape, distance = found['shape'], found['distance']
    return asked + [
        '{:,}'.format(result['vertices']), '%.3f' % shape['q_mean'], '%.2f' % shape['q_min'],
        '%.1f' % shape['theta_min'], '%.1f' % shape['theta_min_mean'], '%.1f' % shape['theta_max'],
        '%.2f' % shape['percent_below_30'], number('%.1f', found['topology']['percent_valence_6']),
        '%.3f' % distance['rms'], '%.2f' % distance['hausdorff'], seconds(result), '%.0f' % result['megabytes'],
        _soundness(found), 'yes' if result['verified'] else 'no']


def _soundness(found):
    if not is_manifold(found['topology']) or found['inside_out']:
        return 'no'
    if not found['reference']['manifold']:
        return 'manifold'
    return 'yes' if found['same_topology'] else 'no'


def watched(raw):
    found = {}
    for name, model in raw['models'].items():
        result = model['result']
        sound = 'failed' not in result and result['verified']
        found['%s verified' % name] = (1 if sound else 0, 1, 0)
        if 'failed' in result:
            continue
        found |= watched_measures(name, result['measures'])
        seconds = median_of(result['process_seconds'])
        found['%s seconds' % name] = (seconds, -1, TIME_NOISE * seconds)
        found['%s megabytes' % name] = (result['megabytes'], -1, MEMORY_NOISE * result['megabytes'])
    return {**found, **_averages(raw)}


def _averages(raw):
    """Returns averages over all models, which reveal small changes hidden by the noise of a single model."""
    known = [model['result']['measures'] for model in raw['models'].values() if 'failed' not in model['result']]
    found = {}
    for measure in MEASURES:
        values = [v for v in map(measure.of, known) if v is not None]
        if values:
            name = 'average %s of %d models' % (measure.label, len(values))
            found[name] = (sum(values) / len(values), measure.sense, measure.noise / len(values) ** 0.5)
    return found
