"""The paper's Figure 4: the eigenvalues of the heat kernel matrix before and after a point is added."""

import numpy as np

from .. import kernel, plots
from ..tables import bullets, less

TITLE = 'Figure 4: eigenvalues before and after a point is added'

POINTS, QUICK_POINTS = 400, 150
# Time of the heat kernel, in squared spacings of hexagonal packing: the kernels of neighbours overlap.
TIME = 0.5
# Number of eigenvalues of the matrix that are drawn.
DRAWN = 60


def run(context):
    count = QUICK_POINTS if context.quick else POINTS
    rng = np.random.default_rng(context.seed)
    cases = {'plane': _plane(rng, count), 'sphere': _sphere(rng, count)}
    return {'points': count, 'seed': context.seed, 'cases': cases,
            'less': less(context.quick, '%d points instead of %d' % (QUICK_POINTS, POINTS))}


def _plane(rng, count):
    """Computes the case of random points in the unit square and one more at its centre."""
    time = TIME * _spacing(1.0, count) ** 2
    return _both(lambda x, y: kernel.heat_kernel_of_plane(x, y, time), rng.random((count, 2)), np.array([[0.5, 0.5]]))


def _sphere(rng, count):
    time = TIME * _spacing(4 * np.pi, count) ** 2
    points = rng.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return _both(lambda x, y: kernel.heat_kernel_of_sphere(x, y, time), points, np.array([[0.0, 0.0, 1.0]]))


def _spacing(area, count):
    return (2 * area / (3 ** 0.5 * count)) ** 0.5


def _both(heat, points, new):
    """Returns the eigenvalues without and with a new point, relative to the largest without it, and s of that point."""
    before = kernel.eigenvalues(heat, points)
    after = kernel.eigenvalues(heat, np.concatenate([points, new]))
    measure = kernel.measure(heat, points, new)[0]
    return {'before': (before / before[0]).tolist(), 'after': (after / before[0]).tolist(), 's': float(measure)}


def report(raw, figures):
    figure, axes = plots.panels(2, 2, height=2.3)
    for column, (name, case) in enumerate(raw['cases'].items()):
        before, after = np.array(case['before']), np.array(case['after'])
        number = np.arange(1, min(DRAWN, len(before)) + 1)
        top, bottom = axes[:, column]
        top.plot(number, before[:len(number)], color=plots.INK, label='before')
        top.plot(number, after[:len(number)], '--', color=plots.OURS, label='after')
        top.set_title({'plane': '(a) plane', 'sphere': '(b) sphere'}[name])
        top.legend()
        bottom.bar(number, (after[:len(number)] - before[:len(number)]), color=plots.OURS, width=0.8)
        bottom.set_xlabel('number of the eigenvalue')
    axes[0, 0].set_ylabel('eigenvalue / largest')
    axes[1, 0].set_ylabel('change')
    axes[1, 1].sharey(axes[1, 0])
    text = ('%d random points and one more. The paper says that the change diffuses to many eigenvalues and none of '
            'them changes much; its figure has no numbers.' % raw['points']) + raw['less']
    return '\n\n'.join([text, plots.save(figure, figures, 'figure04'), bullets(_sentences(raw))]) + '\n'


def _sentences(raw):
    sentences = []
    for name, case in raw['cases'].items():
        before, after = np.array(case['before']), np.array(case['after'])
        change = after[:-1] - before
        share = change.max() / (after.sum() - before.sum())
        carrying = int((np.sort(change)[::-1].cumsum() < 0.9 * change.sum()).sum()) + 1
        # Interlacing: an added point makes no eigenvalue smaller, and raises none above the previous one of before.
        holds = bool(np.all(change > -1e-12) and np.all(after[1:-1] <= before[:-1] + 1e-12))
        sentences.append(
            '%s: s of the new point is %.3f. Its change is spread: the largest of one eigenvalue is %.0f %% of all, '
            'and %d eigenvalues carry 90 %%; %s. The eigenvalues interlace as they must: %s.' % (
                name.capitalize(), case['s'], 100 * share, carrying,
                'as the paper says' if share < 0.5 else 'unlike what the paper says', 'yes' if holds else 'no'))
    return sentences
