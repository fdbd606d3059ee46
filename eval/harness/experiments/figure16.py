"""The paper's Figure 16: time against the number of input vertices, and against the number of output points."""

import statistics

import numpy as np

from .. import library, mesh, plots
from ..points import read_xyz
from ..tables import bullets, less, markdown

TITLE = 'Figure 16: time against the size of input and output'

MODEL = 'blob'
# How often each triangle of the model is split into four, and the number of output points for each of these inputs.
SPLITS, QUICK_SPLITS, POINTS = [0, 1, 2, 3, 4], [0, 2], 5000
# Numbers of output points, and how often the model is split for them.
OUTPUTS, QUICK_OUTPUTS, OUTPUT_SPLITS, QUICK_OUTPUT_SPLITS = [1000, 3000, 10_000, 30_000, 50_000], [500, 4000], 2, 1
REPEATS, QUICK_REPEATS = 3, 1
# Kernel width of the scan, in spacings of hexagonal packing.
SIGMA = 0.866
TASKS = {
    'scan': ('linear scan', 'a subset of the vertices by `remesh sample --scan-only --sigma-p`'),
    'ascent': ('scan and ascent', 'samples of the surface by `remesh sample --points`'),
    'remesh': ('all', 'a finished mesh by `remesh --points`'),
}


def run(context):
    model = mesh.read(context.case(MODEL).path)
    splits, outputs, fixed = SPLITS, OUTPUTS, OUTPUT_SPLITS
    if context.quick:
        splits, outputs, fixed = QUICK_SPLITS, QUICK_OUTPUTS, QUICK_OUTPUT_SPLITS
    files = _split(context, model, sorted({*splits, fixed}))
    area = float(model.areas().sum())
    repeats = QUICK_REPEATS if context.quick else REPEATS
    by_input = [dict(input=files[s][1], wanted=POINTS, **_times(context, files[s][0], area, POINTS, repeats))
                for s in splits]
    by_output = [dict(input=files[fixed][1], wanted=n, **_times(context, files[fixed][0], area, n, repeats))
                 for n in outputs]
    return {'model': MODEL, 'repeats': repeats, 'by_input': by_input, 'by_output': by_output, 'seed': context.seed,
            'less': less(context.quick, 'two sizes of each kind and one run instead of %d' % REPEATS)}


def _split(context, model, splits):
    """Writes the model with its triangles repeatedly split into four; returns the files and their vertex counts."""
    files = {}
    for n in range(splits[-1] + 1):
        if n:
            model = model.split()
        if n in splits:
            files[n] = context.file('split-%d.ply' % n), len(model.vertices)
            mesh.write(files[n][0], model)
    return files


def _times(context, path, area, points, repeats):
    """Returns the seconds of the whole process for each task; each round runs all tasks one after the other."""
    sigma = SIGMA * (2 * area / (3 ** 0.5 * points)) ** 0.5
    seed, to_points = ['--seed', context.seed], ['--points', points]
    samples, made = context.file('out.xyz'), context.file('out.ply')
    commands = {
        'scan': ['sample', path, samples, '--scan-only', '--sigma-p', sigma, *seed],
        'ascent': ['sample', path, samples, *to_points, *seed],
        'remesh': [path, made, *to_points, *seed],
    }
    seconds = {task: [] for task in commands}
    for _ in range(repeats):
        for task, command in commands.items():
            seconds[task].append(library.call(context, *command).seconds)
            if task == 'scan':
                kept = len(read_xyz(samples)[0])
    return {'seconds': seconds, 'kept': kept}


def report(raw, figures):
    figure, axes = plots.panels(1, 2, sharey=True)
    parts = (('by_input', 'input', 'vertices of the input'), ('by_output', 'wanted', 'points that come out'))
    for axis, (key, size, label) in zip(axes[0], parts):
        for (task, (name, _)), colour in zip(TASKS.items(), [plots.OURS, plots.THIRD, plots.THEIRS]):
            low, middle, high = _spread(raw[key], task)
            sizes = [row[size] for row in raw[key]]
            axis.loglog(sizes, middle, 'o-', color=colour, label=name)
            axis.fill_between(sizes, low, high, color=colour, alpha=0.2, linewidth=0)
        axis.set_xlabel(label)
    axes[0, 0].set_ylabel('seconds')
    axes[0, 0].legend()
    axes[0, 0].set_title('%d points out' % raw['by_input'][0]['wanted'])
    axes[0, 1].set_title('%d vertices in' % raw['by_output'][0]['input'])
    text = ('Seconds of the whole process, reading and writing included, median of %d with the range shaded: %s. '
            'Inputs are %s with each triangle split in four again and again.' % (
                raw['repeats'], '; '.join('%s, %s' % pair for pair in TASKS.values()), raw['model'])) + raw['less']
    rows = [[str(row['input']), str(row['wanted']), str(row['kept'])] + [
        '%.2f (%.2f to %.2f)' % (statistics.median(s), min(s), max(s)) for s in (row['seconds'][t] for t in TASKS)]
        for row in raw['by_input'] + raw['by_output']]
    header = ['vertices in', 'points wanted', 'kept by the scan'] + [name for name, _ in TASKS.values()]
    return '\n\n'.join([text, plots.save(figure, figures, 'figure16'), markdown([header] + rows),
                        bullets(_sentences(raw))]) + '\n'


def _spread(rows, task):
    return tuple([f(row['seconds'][task]) for row in rows] for f in (min, statistics.median, max))


def _exponent(rows, size, task):
    """Returns the slope of log seconds over log size."""
    return float(np.polyfit(np.log([row[size] for row in rows]), np.log(_spread(rows, task)[1]), 1)[0])


def _sentences(raw):
    sentences = []
    for task, (name, _) in TASKS.items():
        by_input, by_output = _exponent(raw['by_input'], 'input', task), _exponent(raw['by_output'], 'wanted', task)
        sentences.append('%s: time grows with the input\'s size to the power %.2f, and with the output\'s to the power '
                         '%.2f.' % (name.capitalize(), by_input, by_output))
    scan = _exponent(raw['by_input'], 'input', 'scan'), _exponent(raw['by_output'], 'wanted', 'scan')
    sentences.append('The paper has its subsampling linear in the input; ours is %s. It has it constant in the output; '
                     'ours is %s.' % ('no worse' if scan[0] < 1.1 else 'worse',
                                 'about constant, too' if abs(scan[1]) < 0.2 else 'not'))
    return sentences
