"""Writes the figures of a run into README.md and docs/figures.md, between two markers in each."""

import os
import sys

from . import results
from .context import ROOT
from .experiments import cases, clouds
from .race import median_of
from .tables import columns, markdown, number
from .verdicts import faults_of, measure_called

README = os.path.join(ROOT, 'README.md')
FIGURES = os.path.join(ROOT, 'docs', 'figures.md')
BEGIN, END = '<!-- figures:begin -->', '<!-- figures:end -->'
FAULTY = '†'
WRITTEN = 'Written by `eval/run readme`; do not edit.'

# Heading, and printf format of the measure with this name in verdicts.MEASURES.
BEST = {'θmin': '%.1f', 'mean θmin': '%.1f', 'θmax': '%.1f', 'Qmin': '%.2f', 'Qave': '%.3f', '% of valence 6': '%.1f',
        'variation of edges': '%.3f', 'RMS distance': '%.3f', 'Hausdorff distance': '%.2f'}
# Measures of the short table.
SHORT = ['θmin', 'mean θmin', 'Hausdorff distance']


def rewrite(found):
    """Replaces the sections between the markers of README.md and of docs/figures.md."""
    for path, text in [(README, short_section(found)), (FIGURES, section(found))]:
        with open(path, encoding='utf-8') as f:
            page = between_markers(f.read(), text, os.path.relpath(path, ROOT))
        with open(path + '.new', 'w', encoding='utf-8') as f:
            f.write(page)
        os.replace(path + '.new', path)


def between_markers(page, text, name):
    """Returns the page with `text` between its markers."""
    if page.count(BEGIN) != 1 or page.count(END) != 1 or page.index(BEGIN) > page.index(END):
        sys.exit('eval/run: %s needs one %s and, after it, one %s' % (name, BEGIN, END))
    before, rest = page.split(BEGIN)
    return '%s%s\n%s\n%s%s' % (before, BEGIN, text, END, rest.split(END)[1])


def short_section(found):
    """Returns a table with a row per model of the experiment `remeshers`: ours and the best other, by a few
    measures."""
    made = _made_with(found, 'remeshers')
    parts = ['Measured on %s on %s. %s' % (made['date'], results.machine_words(made), WRITTEN)]
    raw = _experiment(found, 'remeshers')
    if raw:
        parts.append(_short(raw))
    return '\n\n'.join(parts)


def section(found):
    """Returns all figures of the page, from those of its experiments that the run contains."""
    made = _made_with(found, 'cases')
    parts = ['Version %s, measured on %s (%s) by `%s`. %s '
             '[eval/RESULTS.md](../eval/RESULTS.md) has all figures, the settings of the other programs, and what is '
             'better and what is worse than each of them.' % (
                 made['versions']['remesh'], made['date'], results.machine_words(made), made['command'], WRITTEN)]
    writers = {'cases': _cases, 'remeshers': _best, 'clouds': _points}
    for name, write in writers.items():
        raw = _experiment(found, name)
        if raw:
            date = _made_with(found, name)['date']
            # Experiments from a different run have their own date.
            first, *rest = write(raw)
            parts += [first if date == made['date'] else '%s Measured on %s.' % (first, date), *rest]
    return '\n\n'.join(parts)


def _made_with(found, name):
    """Returns the date, machine and command of an experiment, which may come from a different run than the rest."""
    return found.get('apart', {}).get(name, found)


def _experiment(found, name):
    """Returns the figures of an experiment, or `None` if it is missing or failed."""
    raw = found['experiments'].get(name)
    return raw if raw and 'failed' not in raw else None


def _short(raw):
    models = {name: model['results'] for name, model in raw['models'].items()}
    rows = [(label, _two_rows(label, BEST[label], models, raw, measure_called(label).sense, _value(label)))
            for label in SHORT]
    rows.append(('seconds', _two_rows('seconds', '%.2f', models, raw, -1, _seconds)))
    heading = ['model', 'vertices'] + [title for label, _ in rows for title in (label, 'best other')]
    return markdown([heading] + [
        [name, '{:,}'.format(raw['models'][name]['points'])] +
        [row.get(name, '-') for _, pair in rows for _, row in pair] for name in models])


def _cases(raw):
    return [cases.table(raw, lambda result: '%.2f' % median_of(result['process_seconds']))]


def _best(raw):
    """Returns a table with two rows per measure: ours, and the best of the others."""
    models = {name: model['results'] for name, model in raw['models'].items()}
    rows = []
    for label, form in BEST.items():
        rows += _two_rows(label, form, models, raw, measure_called(label).sense, _value(label))
    rows += _two_rows('seconds', '%.2f', models, raw, -1, _seconds)
    others = [p['label'] for n, p in raw['programs'].items() if 'version' in p and n not in ('remesh', 'ascent')]
    about = ('Beside the best of %s at the same counts, by one measure at a time; seconds are of remeshing alone. %s '
             'marks results with a fault: non-manifold, another topology than the input, faces that cross, or a count '
             'missed by more than 3 %%.' % (', '.join(others), FAULTY))
    return [about, columns('', list(models), rows)]


def _value(label):
    """Returns the function that reads a measure in a result."""
    measure = measure_called(label)
    return lambda result: measure.of(result['measures'])


def _seconds(result):
    return median_of(result['seconds'])


def _two_rows(label, form, models, raw, sense, value):
    ours, best = {}, {}
    for model, found in models.items():
        known = {n: value(r) for n, r in found.items() if 'measures' in r and value(r) is not None}
        ours[model] = '**%s**' % number(form, known.get('remesh'))
        others = {n: v for n, v in known.items() if n not in ('remesh', 'ascent')}
        if others:
            name = max(others, key=lambda n: sense * others[n])
            mark = FAULTY if faults_of(found[name]) else ''
            best[model] = '%s%s %s' % (form % others[name], mark, raw['programs'][name]['label'])
    return [('**%s, remesh**' % label, ours), ('best of the others', best)]


def _points(raw):
    names = list(next(iter(raw['kinds'].values())))
    angles = clouds.rows(raw, lambda r: '%.1f / %.1f' % (
        r['measures']['shape']['theta_min'], r['measures']['shape']['theta_min_mean']))
    fits = clouds.rows(raw, lambda r: '%.3f / %.3f / %s' % (
        r['measures']['shape']['q_mean'], r['measures']['distance']['rms'],
        'yes' if r['measures']['same_topology'] else 'no'))
    about = ('The vertices of some models alone, as point clouds, at the same counts; with noise of a quarter of the '
             'mean spacing ours takes `--smooth`. MeshLab: Poisson-disk subset of the points and ball pivoting.')
    return [about, columns('From points: θmin / mean θmin', names, angles),
            columns('From points: Qave / RMS distance to the mesh / its topology', names, fits)]
