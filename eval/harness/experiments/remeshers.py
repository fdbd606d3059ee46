"""This program and its peers on the same models, at the same vertex counts, in the same run."""

import math
import sys
import time

from .. import mesh
from ..peers import NAMES, OURS, peer
from ..race import LONG, TIMEOUT, race
from ..tables import columns, listed, markdown, number, spread
from ..verdicts import MEASURES, against, faults_of

TITLE = 'Against other remeshers'

MODELS = ['horse', 'bunny', 'armadillo', 'fandisk', 'rocker-arm', 'nefertiti', 'koala', 'homer', 'fertility']
OWN_MODELS = ['blob', 'bracket', 'noisy', 'shell', 'terrain']
QUICK_MODELS = ['blob', 'bracket']
ROUNDS = 3
# Seconds for all models. Since models differ, each may use twice its share of the remaining time; then it gets no more
# rounds.
BUDGET = 1300


def run(context):
    names = QUICK_MODELS if context.quick else [n for n in MODELS if context.case(n)] or OWN_MODELS
    cases = [case for case in map(context.case, names) if case]
    programs, listing = programs_at_hand(NAMES, context.quick)
    rounds = 1 if context.quick else ROUNDS
    models, until = {}, time.perf_counter() + BUDGET
    for number_left, case in zip(range(len(cases), 0, -1), cases):
        share = (until - time.perf_counter()) / max(1, number_left / 2)
        models[case.name] = race_on(case, mesh.read(case.path), programs, rounds, context, share)
    return {'programs': listing, 'models': models, 'not_at_hand': [] if context.quick else _absent(context),
            'rounds': rounds}


def race_on(case, reference, programs, rounds, context, budget=math.inf):
    """Returns the results of all programs on one model, and the facts about the model."""
    source = context.file(case.name + '.ply')
    mesh.write(source, reference)
    results = race(programs, source, reference, case.points, case.sharp, rounds, context.scratch, budget)
    sys.stderr.write('  %s: %s\n' % (case.name, ', '.join(_brief(n, r) for n, r in results.items())))
    return {'points': case.points, 'sharp': case.sharp, 'results': results}


def _absent(context):
    return [name for name in MODELS if not context.case(name)]


def programs_at_hand(names, quick):
    """Returns the available programs by name, and the description of each program, including missing ones."""
    found, listing = {}, {}
    for name in names:
        program = peer(name)
        why = program.missing()
        if quick and not program.BY_PIP and name not in OURS:
            why = 'left out of --quick, which takes what pip installs'
        listing[name] = {'label': program.LABEL, 'settings': program.SETTINGS}
        if why:
            listing[name]['missing'] = why
        else:
            found[name] = program
            listing[name]['version'] = program.version()
    return found, listing


def _brief(name, result):
    return '%s failed' % name if 'failed' in result else '%s %.1f s' % (name, result['process_seconds'][0])


# Heading, and the function that formats the cell of a result.
TABLES = [
    ('θmin / mean θmin (degrees)', lambda r: '%.1f / %.1f' % (
        shape_of(r)['theta_min'], shape_of(r)['theta_min_mean'])),
    ('θmax (degrees) / % < 30° / % > 90°', lambda r: '%.0f / %.2f / %.2f' % (
        shape_of(r)['theta_max'], shape_of(r)['percent_below_30'], shape_of(r)['percent_above_90'])),
    ('Qmin / Qave', lambda r: '%.2f / %.3f' % (shape_of(r)['q_min'], shape_of(r)['q_mean'])),
    ('% of valence 6 / variation of edge lengths', lambda r: '%s / %.3f' % (
        number('%.1f', r['measures']['topology']['percent_valence_6']), shape_of(r)['edge_cv'])),
    ('RMS / Hausdorff distance (% of the diagonal)', lambda r: '%.3f / %.2f' % (
        r['measures']['distance']['rms'], r['measures']['distance']['hausdorff'])),
    ('seconds of remeshing alone', lambda r: spread(r['seconds'])),
    ('seconds of the whole process', lambda r: spread(r['process_seconds'])),
    ('most memory of the process (MB)', lambda r: '%.0f' % r['megabytes']),
    ('vertices / crossing faces', lambda r: '{:,} / {}'.format(r['vertices'], r['measures']['crossing_faces'])),
    ('faults', lambda r: ', '.join(faults_of(r)) or 'none'),
]


def shape_of(result):
    return result['measures']['shape']


def report(raw, _figures):
    return '\n\n'.join([_introduction(raw), *tables(TABLES, raw), '### Better and worse', rule(raw), verdicts(raw)])


def tables(cells, raw):
    """Returns a table of the programs, and one table for each heading and cell."""
    return [_who(raw['programs'])] + [_table(heading, cell, raw) for heading, cell in cells]


def verdicts(raw, times=True):
    """Returns what is better and worse than each of the others, one line each."""
    results = {name: model['results'] for name, model in raw['models'].items()}
    others = {name: p for name, p in raw['programs'].items() if name != 'remesh' and 'version' in p}
    return '\n'.join('- ' + against(p['label'], results, name, times) for name, p in others.items())


def _introduction(raw):
    counts = listed('%s %s' % (name, '{:,}'.format(m['points'])) for name, m in raw['models'].items())
    times = 'of one run' if raw['rounds'] == 1 else 'the median of up to %d runs (least..greatest)' % raw['rounds']
    text = ('Models and wanted vertices: %s. All programs read the same PLY file. Times are %s, each right before or '
            'after a run of ours. Programs are timed in rounds: fewer for a model that has used its share of the %d s '
            'for all, and once where they take longer than %d s; what takes longer than %d s is ended. "Whole process" '
            'includes starting Python and its packages for programs that are Python packages, and for ours measuring '
            'the result.' % (counts, times, BUDGET, LONG, TIMEOUT))
    cad = [name for name, m in raw['models'].items() if m['sharp']]
    if cad:
        text += ' CAD parts, whose sharp edges are to stay: %s.' % listed(cad)
    if raw['not_at_hand']:
        text += ' Not at hand: %s.' % listed(raw['not_at_hand'])
    return text


def _who(programs):
    rows = [['program', 'version', 'settings']]
    rows += [[p['label'], p.get('version') or '**missing**: ' + p['missing'], p['settings']] for p in programs.values()]
    return markdown(rows).replace('--:', ':--')


def _table(heading, cell, raw):
    names = list(raw['models'])
    rows = []
    for name, program in raw['programs'].items():
        label = '**%s**' % program['label'] if name == 'remesh' else program['label']
        cells = {m: _cell(cell, model['results'].get(name)) for m, model in raw['models'].items()}
        rows.append((label, cells if 'version' in program else dict.fromkeys(names, 'missing')))
    return columns(heading, names, rows)


def _cell(cell, result):
    if result is None:
        return 'missing'
    return 'failed' if 'failed' in result else cell(result)


def rule(raw):
    """Returns which differences the verdicts count, and what failed."""
    noises = ', '.join('%s %g' % (m.label, m.noise) for m in MEASURES if m.noise)
    text = 'Computed from the figures above. Differences up to these do not count: %s.' % noises
    results = [(model, name, result) for model, found in raw['models'].items()
               for name, result in found['results'].items()]
    failed = ['%s on %s (%s)' % (raw['programs'][name]['label'], model, result['failed'])
              for model, name, result in results if 'failed' in result]
    return text + (' Failed: %s.' % '; '.join(failed) if failed else '')
