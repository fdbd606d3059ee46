"""The paper's Figure 11: spectra of samples on a toroidal square, ours and those of Lloyd's method."""

import os

import numpy as np

from .. import library, plots, torus
from ..tables import bullets, less, markdown
from ..verdicts import word

TITLE = "Figure 11: blue noise on a toroidal square"

POINTS, QUICK_POINTS = 1024, 256
RUNS, QUICK_RUNS = 10, 3
ITERATIONS, QUICK_ITERATIONS = 100, 30
# Mean normalised Poisson-disk radius of the paper's method, as printed.
PAPER_RADIUS = 0.793
# Highest frequency of the spectra, in units of √n.
FREQUENCIES = 3.0
METHODS = {'ours': 'ours', 'lloyd': "Lloyd's"}


def run(context):
    quick = context.quick
    count, runs, iterations = (QUICK_POINTS, QUICK_RUNS, QUICK_ITERATIONS) if quick else (POINTS, RUNS, ITERATIONS)
    folder = context.file('spectrum')
    library.example(context, 'spectrum', count, folder)
    ours = [np.loadtxt(os.path.join(folder, 'points-%d.csv' % i), delimiter=',', skiprows=1) for i in range(runs)]
    starts = [np.random.default_rng([context.seed, i]).random((count, 2)) for i in range(runs)]
    lloyd = [torus.lloyd(start, iterations) for start in starts]
    return {
        'points': count, 'runs': runs, 'iterations': iterations, 'seed': context.seed,
        'less': less(quick, "fewer than the paper's %d points, %d sets, %d iterations" % (POINTS, RUNS, ITERATIONS)),
        'methods': {'ours': _figures(ours), 'lloyd': _figures(lloyd)},
    }


def _figures(sets):
    """Returns radii and energies of all sets, the first set, and the spectrum of the mean periodogram."""
    highest = int(np.ceil(FREQUENCIES * len(sets[0]) ** 0.5))
    power = np.mean([torus.periodogram(points, highest) for points in sets], axis=0)
    mean, anisotropy = torus.rings(power)
    power[highest, highest] = 0
    return {
        'radii': [torus.radius(points) for points in sets],
        'energy': [torus.centroids(points)[1] * len(points) for points in sets],
        # The half of the periodogram from zero upwards; the other half is its mirror image.
        'example': np.round(sets[0], 4).tolist(), 'periodogram': np.round(power[highest:], 2).tolist(),
        'power': mean.tolist(), 'anisotropy': anisotropy.tolist(),
    }


def report(raw, figures):
    figure, axes = plots.panels(2, 3, width=2.9, height=2.7)
    root = raw['points'] ** 0.5
    for row, (key, name) in enumerate(METHODS.items()):
        method = raw['methods'][key]
        points, picture, graph = axes[row]
        points.plot(*np.array(method['example']).T, '.', color=plots.INK, markersize=60 / root)
        points.set(xlim=(0, 1), ylim=(0, 1), title='%s, ρ = %.3f' % (name, np.mean(method['radii'])))
        plots.bare(points)
        picture.imshow(_whole(method['periodogram']), cmap='gray', vmin=0, vmax=3, interpolation='nearest')
        picture.set_title('mean periodogram')
        plots.bare(picture)
        _graph(graph, method, root, last=row == 1)
    notes = _text(raw)
    rows = [[name, '%.3f' % np.mean(m['radii']), '%.3f to %.3f' % (min(m['radii']), max(m['radii'])),
             '%.4f' % np.mean(m['energy']), '%.2f' % max(m['power']), '%.1f' % np.mean(_settled(m, root))]
            for name, m in ((n, raw['methods'][k]) for k, n in METHODS.items())]
    header = ['', 'mean ρ', 'ρ from, to', 'energy', 'highest radial power', 'anisotropy beyond the peak, dB']
    rows.append(['the paper, its method', '%.3f' % PAPER_RADIUS, '', '', '', ''])
    return '\n\n'.join([notes, plots.save(figure, figures, 'figure11'), markdown([header] + rows),
                        bullets(_sentences(raw))]) + '\n'


def _whole(half):
    """Returns the whole periodogram from the half from zero upwards: opposite frequencies have the same power."""
    half = np.array(half)
    return np.concatenate([half[:0:-1, ::-1], half])


def _graph(axes, method, root, last):
    """Draws radial power on the left scale and anisotropy on the right one."""
    frequency = np.arange(1, len(method['power']) + 1) / root
    axes.plot(frequency, method['power'], color=plots.OURS)
    axes.set(ylim=(0, 5.5), title='radial power, anisotropy')
    axes.set_ylabel('power', color=plots.OURS)
    other = axes.twinx()
    other.plot(frequency, method['anisotropy'], color=plots.THEIRS, linewidth=1)
    other.set_ylim(-20, 25)
    other.set_ylabel('dB', color=plots.THEIRS)
    other.grid(False)
    other.spines['right'].set_visible(True)
    if last:
        axes.set_xlabel('frequency / √n')


def _text(raw):
    text = ('%d random points of a square whose sides are joined: ours after 10 sweeps of ascent (example `spectrum`), '
            "Lloyd's method after %d iterations; %d sets each. Periodogram, power and anisotropy are computed by the "
            'same numpy code for both. Energy is the mean squared distance to the nearest point times n; a hexagonal '
            'packing has 0.1604. Anisotropy of the mean of %d sets without any is %.0f dB.' % (
                raw['points'], raw['iterations'], raw['runs'], raw['runs'], -10 * np.log10(raw['runs'])))
    return text + raw['less']


def _settled(method, root):
    """Returns the anisotropy from twice the mean frequency upwards, where power is flat."""
    return np.array(method['anisotropy'])[int(2 * root):]


def _sentences(raw):
    ours, lloyd = (raw['methods'][key] for key in METHODS)
    mean = {key: np.mean(raw['methods'][key]['radii']) for key in METHODS}
    root = raw['points'] ** 0.5
    below = {key: np.mean(np.array(raw['methods'][key]['power'])[:int(0.5 * root)]) for key in METHODS}
    expected = -10 * np.log10(raw['runs'])
    largest = max(abs(_settled(ours, root) - expected))
    return [
        "ρ is %.3f on the mean, %s than the paper's %.3f and %s than Lloyd's %.3f." % (
            mean['ours'], word(mean['ours'], PAPER_RADIUS), PAPER_RADIUS, word(mean['ours'], mean['lloyd']),
            mean['lloyd']),
        "Energy, which Lloyd's method minimizes, is %.4f, %s than its %.4f." % (
            np.mean(ours['energy']), word(np.mean(ours['energy']), np.mean(lloyd['energy']), -1),
            np.mean(lloyd['energy'])),
        "Mean power below half of √n, which blue noise has none of, is %.4f, %s than Lloyd's %.4f." % (
            below['ours'], word(below['ours'], below['lloyd'], -1), below['lloyd']),
        "Radial power peaks at %.2f, Lloyd's at %.2f: the lower peak is the less regular set." % (
            max(ours['power']), max(lloyd['power'])),
        'Beyond the peak our anisotropy stays within %.1f dB of the %.0f dB of a set without any: %s.' % (
            largest, expected, 'isotropic' if largest < 4 else 'not isotropic everywhere'),
    ]

