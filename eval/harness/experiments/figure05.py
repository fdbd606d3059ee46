"""The paper's Figure 5: s over the plane for six points, and the eigenvalues with a new point at high or low s."""

import numpy as np

from .. import kernel, library, plots
from ..tables import bullets, less

TITLE = 'Figure 5: the measure over the plane'

# The six points, in units of σ = 2 √t of the heat kernel; s does not depend on t in these units.
POINTS = [[-1.1, -0.5], [-0.5, 0.9], [0.0, -0.2], [0.7, 0.8], [1.2, -0.4], [0.3, -1.1]]
SIDE = 2.4
CELLS, QUICK_CELLS = 97, 41


def run(context):
    cells = QUICK_CELLS if context.quick else CELLS
    points = np.array(POINTS)
    axis = np.linspace(-SIDE, SIDE, cells)
    grid = np.stack(np.meshgrid(axis, axis), axis=2).reshape(-1, 2)
    own = kernel.measure(kernel.gaussian, points, grid)
    theirs = library.measure(context, points, grid)[:, -1]
    high, low = _two_places(grid, own)
    spectra = {'before': kernel.eigenvalues(kernel.gaussian, points)}
    for name, place in (('high', high), ('low', low)):
        spectra[name] = kernel.eigenvalues(kernel.gaussian, np.concatenate([points, grid[place][None]]))
    return {
        'points': POINTS, 'side': SIDE, 's': np.round(own, 4).reshape(cells, cells).tolist(),
        'new': {name: {'at': grid[i].tolist(), 's': float(own[i])} for name, i in (('high', high), ('low', low))},
        'eigenvalues': {name: values.tolist() for name, values in spectra.items()},
        'library': {'places': len(grid), 'largest_difference': float(np.abs(own - theirs).max())},
        'less': less(context.quick, 'a coarser picture'),
    }


def _two_places(grid, measure):
    """Returns where s is highest and lowest in the middle of the plane, away from the points."""
    points = np.array(POINTS)
    nearest = np.linalg.norm(grid[:, None] - points[None], axis=2).min(axis=1)
    inside = (np.abs(grid).max(axis=1) < 0.62 * SIDE) & (nearest > 0.35)
    return int(np.argmax(np.where(inside, measure, -1))), int(np.argmin(np.where(inside, measure, 2)))


def report(raw, figures):
    figure, axes = plots.panels(1, 2, width=3.8, height=3.3)
    left, right = axes[0]
    number = np.arange(1, len(raw['eigenvalues']['high']) + 1)
    left.plot(number[:-1], raw['eigenvalues']['before'], 'o-', color=plots.INK, label='six points')
    for name, colour, mark in (('high', plots.OURS, '^'), ('low', plots.THEIRS, 's')):
        label = 'one more, s = %.2f' % raw['new'][name]['s']
        left.plot(number, raw['eigenvalues'][name], mark + '--', color=colour, label=label)
    left.set(xlabel='number of the eigenvalue', ylabel='eigenvalue', ylim=(0, None))
    left.legend()
    side = raw['side']
    image = right.imshow(raw['s'], origin='lower', extent=(-side, side, -side, side), cmap='viridis', vmin=0, vmax=1)
    right.plot(*np.array(raw['points']).T, 'o', color='black', markersize=5)
    for name, colour, mark in (('high', plots.OURS, '^'), ('low', plots.THEIRS, 's')):
        right.plot(*raw['new'][name]['at'], mark, color=colour, markeredgecolor='white', markersize=8)
    right.grid(False)
    right.set(xlabel='x / σ', ylabel='y / σ')
    figure.colorbar(image, ax=right, label='s', shrink=0.85)
    text = ('Left the eigenvalues of the kernel matrix, right s, for six points (black) and one more where s is high '
            '(triangle) or low (square). Computed from equation 8 by numpy, and by the library at the same %d places.'
            % raw['library']['places']) + raw['less']
    return '\n\n'.join([text, plots.save(figure, figures, 'figure05'), bullets(_sentences(raw))]) + '\n'


def _sentences(raw):
    new, least = raw['new'], {name: raw['eigenvalues'][name][-1] for name in ('high', 'low')}
    rise = {name: raw['eigenvalues'][name][0] - raw['eigenvalues']['before'][0] for name in ('high', 'low')}
    difference = raw['library']['largest_difference']
    return [
        'Any new point adds 1 to the sum of the eigenvalues. Where s = %.3f they get a new one of %.3f, and the '
        'largest grows by %.3f; where s = %.3f the new one is %.3f, and the largest grows by %.3f. %s.' % (
            new['high']['s'], least['high'], rise['high'], new['low']['s'], least['low'], rise['low'],
            'High s means a new eigenvalue far from zero, as in the paper' if least['high'] > least['low']
            else 'Unlike in the paper, high s has the smaller new eigenvalue'),
        'The library and numpy differ by %.1e at most: %s.' % (
            difference, 'the same to rounding' if difference < 1e-8 else 'more than rounding explains'),
    ]
