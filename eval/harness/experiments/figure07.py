"""The paper's Figure 7: how far the points move in each sweep of the gradient ascent."""

import numpy as np
from scipy.spatial import cKDTree

from .. import library, plots
from ..tables import bullets, less

TITLE = 'Figure 7: movement in each sweep of the ascent'

MODELS = ['blob', 'horse']
POINTS, QUICK_POINTS = 5000, 500
SWEEPS, QUICK_SWEEPS = 15, 5
# Quantile of the nearest-neighbour distances that is drawn. The very closest pair may lie across a fold.
SHARE = 0.01
# Number of neighbours among which the nearest one that faces the same way is searched.
NEAREST = 16
# The paper's number of sweeps (section 6.3).
PAPER_SWEEPS = 10


def run(context):
    names = ['blob'] if context.quick else MODELS
    cases = [case for case in map(context.case, names) if case]
    points = QUICK_POINTS if context.quick else POINTS
    sweeps = QUICK_SWEEPS if context.quick else SWEEPS
    curves = {case.name: _movement(context, case.path, points, sweeps) for case in cases}
    left_out = less(context.quick, '%s alone, %d samples instead of %d and fewer sweeps' % (names[0], points, POINTS))
    return {'points': points, 'curves': curves, 'less': left_out, 'seed': context.seed}


def _movement(context, path, points, sweeps):
    """Returns the mean displacement of a point in each sweep, in mean nearest-neighbour distances after the last sweep.

    The same seed gives the same points in the same order, so that runs of 0, 1, 2 .. sweeps form one ascent."""
    options = ['--points', str(points), '--sweeps']
    stages = [library.samples(context, path, *options, str(sweep)) for sweep in range(sweeps + 1)]
    unit = _nearest_facing(*stages[-1]).mean()
    ways = [np.linalg.norm(after[0] - before[0], axis=1).mean() / unit for before, after in zip(stages, stages[1:])]
    near = [_nearest_facing(*stage) / unit for stage in stages]
    return {'movement': ways, 'nearest_pair': [some.min() for some in near],
            'nearest': [np.quantile(some, SHARE) for some in near]}


def _nearest_facing(points, normals):
    """Returns the distance of each point to the nearest one that faces the same way, not across a thin wall."""
    distance, other = cKDTree(points).query(points, k=NEAREST)
    counts = (np.einsum('ijk,ik->ij', normals[other], normals) > 0) & (other != np.arange(len(points))[:, None])
    return np.where(counts, distance, distance[:, -1:]).min(axis=1)


def report(raw, figures):
    figure, axes = plots.panels(1, 2)
    left, right = axes[0]
    colours = [plots.OURS, plots.THEIRS, plots.THIRD]
    for (name, curve), colour in zip(raw['curves'].items(), colours):
        sweeps = np.arange(1, len(curve['movement']) + 1)
        left.semilogy(sweeps, curve['movement'], 'o-', color=colour, label=name)
        right.plot(np.arange(len(curve['nearest'])), curve['nearest'], 'o-', color=colour, label=name)
    left.set(xlabel='sweep', ylabel='mean way of a point / spacing')
    right.set(xlabel='sweeps done', ylabel='nearest neighbour of 1 % / spacing', ylim=(0, 1))
    left.legend()
    for axis in (left, right):
        axis.xaxis.get_major_locator().set_params(integer=True)
    text = ('Left: the way that a point goes in a sweep of `remesh sample --points %d`, on the mean and in mean '
            'distances of nearest neighbours. Right: what 1 %% of the points have their nearest neighbour within. '
            'Lists of neighbours are made anew every third sweep.'
            % raw['points']) + raw['less']
    return '\n\n'.join([text, plots.save(figure, figures, 'figure07'), bullets(_sentences(raw))]) + '\n'


def _sentences(raw):
    sentences = []
    for name, curve in raw['curves'].items():
        ways = np.array(curve['movement'])
        last = min(PAPER_SWEEPS, len(ways))
        grows = int((np.diff(ways) > 0).sum())
        sentences.append(
            '%s: points go %.3f of a spacing in the first sweep and %.4f in sweep %d, %.0f times less%s; movement '
            'grows from one sweep to the next %d times of %d. 1 %% of the points have their nearest neighbour within '
            '%.2f of a spacing before and %.2f after %d sweeps; the nearest pair of all goes from %.2f to %.2f.' % (
                name.capitalize(), ways[0], ways[last - 1], last, ways[0] / ways[last - 1],
                ', as the paper says of its quick decrease' if ways[0] > 3 * ways[last - 1]
                else ', slower than the paper\'s "decrease quickly"',
                grows, len(ways) - 1, curve['nearest'][0], curve['nearest'][last], last,
                curve['nearest_pair'][0], curve['nearest_pair'][last]))
    return sentences
