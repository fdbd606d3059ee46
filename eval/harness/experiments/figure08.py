"""The paper's Figure 8: s of a point against the number of neighbours from which it is computed."""

import numpy as np

from .. import kernel, library, plots
from ..points import nearest
from ..tables import bullets, less

TITLE = 'Figure 8: the measure against the number of neighbours'

MODEL, POINTS = 'blob', 2000
QUERIES, QUICK_QUERIES = 100, 20
NEIGHBOURS = 50
# Kernel width in mean distances of the six nearest neighbours: that of the scan in hexagonal packing.
SIGMA = 0.866
# The radius of the paper's neighbourhoods, in σ (section 6.3), and the tolerance for the limit to which s converges.
RADIUS, CLOSE = 2.5, 1e-3


def run(context):
    case = context.case(MODEL)
    points, normals = library.samples(context, case.path, '--points', str(POINTS))
    sigma = SIGMA * nearest(points, 6).mean()
    rng = np.random.default_rng(context.seed)
    chosen = np.sort(rng.permutation(len(points))[:QUICK_QUERIES if context.quick else QUERIES])
    curves, within, differences = [], [], []
    for i in chosen:
        # The midpoint between the sample and its nearest neighbour: a place without a sample.
        order = np.argsort(np.sum((points - points[i]) ** 2, axis=1), kind='stable')
        x = 0.5 * (points[i] + points[order[1]]) / sigma
        facing = order[normals[order] @ normals[i] >= 0]
        near = points[facing][:2 * NEIGHBOURS] / sigma
        near = near[np.argsort(np.sum((near - x) ** 2, axis=1), kind='stable')][:NEIGHBOURS]
        own = kernel.measure_by_neighbours(kernel.gaussian, near, x)
        theirs = library.measure(context, near, x[None])[0]
        curves.append(own)
        within.append(int((np.linalg.norm(near - x, axis=1) < RADIUS).sum()))
        differences.append(float(np.abs(own[:len(theirs)] - theirs).max()))
    curves = np.array(curves)
    return {
        'model': MODEL, 'samples': POINTS, 'queries': len(chosen), 'neighbours': NEIGHBOURS,
        's': {name: curves_at.tolist() for name, curves_at in zip(
            ('low', 'middle', 'high'), np.percentile(curves, [10, 50, 90], axis=0))},
        'off': np.abs(curves - curves[:, -1:]).max(axis=0).tolist(),
        'within': float(np.median(within)), 'counted': len(theirs),
        'library': {'largest_difference': max(differences)}, 'seed': context.seed,
        'less': less(context.quick, '%d places instead of %d' % (QUICK_QUERIES, QUERIES)),
    }


def report(raw, figures):
    figure, axes = plots.panels(1, 2)
    left, right = axes[0]
    number = np.arange(1, raw['neighbours'] + 1)
    left.fill_between(number, raw['s']['low'], raw['s']['high'], color=plots.OURS, alpha=0.2, linewidth=0,
                      label='10 % to 90 %')
    left.plot(number, raw['s']['middle'], color=plots.OURS, label='median')
    left.set(xlabel='nearest neighbours', ylabel='s', ylim=(0, None))
    right.semilogy(number[:-1], np.maximum(raw['off'][:-1], 1e-16), color=plots.OURS)
    right.set(xlabel='nearest neighbours', ylabel='largest error of s')
    for axis in (left, right):
        axis.axvline(raw['counted'], color=plots.INK, linewidth=1, linestyle='--', label='counted by the library')
        axis.axvline(raw['within'], color=plots.THEIRS, linewidth=1, linestyle=':', label='within 2.5 σ')
    left.legend()
    text = ('s between neighbouring ones of %d samples of %s, computed by numpy from the nearest neighbour alone, the '
            'two nearest, and so on, at %d places; errors are against s of the nearest %d. The dashed line is the most '
            'neighbours that the library counts, the dotted one how many there are within the paper\'s 2.5 σ (median).'
            % (raw['samples'], raw['model'], raw['queries'], raw['neighbours'])) + raw['less']
    return '\n\n'.join([text, plots.save(figure, figures, 'figure08'), bullets(_sentences(raw))]) + '\n'


def _sentences(raw):
    off = np.array(raw['off'])
    enough = int(np.argmax(off < CLOSE)) + 1
    left = off[raw['counted'] - 1]
    difference = raw['library']['largest_difference']
    return [
        's converges, as in the paper: the nearest %d neighbours give it within %g everywhere.' % (enough, CLOSE),
        'With its %d neighbours the library is off by %.1e at most, %s.' % (
            raw['counted'], left,
            'little beside its threshold of 0.5' if left < 0.005 else 'more than 1 % of its threshold'),
        'With the same neighbours the library and numpy differ by %.1e at most: %s.' % (
            difference, 'the same to rounding' if difference < 1e-8 else 'more than rounding explains'),
    ]
