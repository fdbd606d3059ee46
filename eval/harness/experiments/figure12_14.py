"""The paper's Figures 12 and 14: one point far off a circle, and surfaces with noise."""

import numpy as np

from .. import library, mesh, pictures, plots
from ..measures import measure
from ..measures.distance import apart
from ..measures.shape import side_lengths
from ..points import noisy, read_xyz, write_xyz
from ..process import Failed
from ..tables import bullets, less, markdown
from ..verdicts import word

TITLE = 'Figures 12 and 14: noise'

# Number of points on a circle of radius 1, and the distance of one of them from the circle.
CIRCLE, OFF = 200, 0.15
SIGMAS, QUICK_SIGMAS = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7], [0.1, 0.5]
ORDERS, QUICK_ORDERS = 25, 5
# Standard deviation of the noise along normals, in mean edge lengths of the model.
LEVELS, QUICK_LEVELS = [0.0, 0.15, 0.3, 0.5], [0.3]
MODELS = {'horse': 8600, 'blob': 3000}
QUICK_POINTS = 1500
DRAWN = 0.3
# Number of points from which the distance of the input is measured.
MEASURED = 100_000
WAYS = {'plain': 'mesh', 'smooth': 'mesh, --smooth', 'cloud': 'cloud', 'cloud-smooth': 'cloud, --smooth'}


def run(context):
    quick = context.quick
    orders = QUICK_ORDERS if quick else ORDERS
    circle = [_kept(context, sigma, orders) for sigma in (QUICK_SIGMAS if quick else SIGMAS)]
    names = ['blob'] if quick else [name for name in MODELS if context.case(name)]
    rows, shown = [], []
    for name in names:
        found, picture = _noisy(context, name, QUICK_POINTS if quick else MODELS[name])
        rows += found
        shown += picture
    return {'circle': {'points': CIRCLE, 'off': OFF, 'orders': orders, 'rows': circle}, 'rows': rows, 'pictures': shown,
            'seed': context.seed,
            'less': less(quick, 'no clouds, one model, one level of noise, less of the circle')}


def _kept(context, sigma, orders):
    """Returns how often the scan keeps the point off the circle, over several orders, and how many points it keeps."""
    angles = 2 * np.pi * np.arange(CIRCLE) / CIRCLE
    points = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    points[0] *= 1 + OFF
    source, target = context.file('circle.xyz'), context.file('circle.kept.xyz')
    write_xyz(source, points)
    kept = []
    for seed in range(orders):
        library.call(context, 'sample', source, target, '--scan-only', '--sigma-p', sigma, '--seed', seed)
        kept.append(read_xyz(target)[0])
    off = [bool((np.linalg.norm(some, axis=1) > 1 + 0.5 * OFF).any()) for some in kept]
    return {'sigma_p': sigma, 'kept': float(np.mean(off)), 'points': float(np.mean([len(some) for some in kept]))}


def _noisy(context, name, points):
    """Returns the rows of a model at all noise levels, and a picture of one of them."""
    case = context.case(name)
    clean = mesh.read(case.path).welded().outward()
    edge = float(side_lengths(clean).mean())
    rows, shown = [], []
    for level in QUICK_LEVELS if context.quick else LEVELS:
        # The noise of all levels differs only by a factor.
        given = mesh.Mesh(noisy(clean.vertices, clean.normals(), level * edge, context.seed), clean.triangles)
        surface, cloud = context.file('noisy.ply'), context.file('cloud.ply')
        mesh.write(surface, given)
        mesh.write_points(cloud, given.vertices)
        sources = {'plain': surface, 'smooth': surface}
        if not context.quick:
            sources.update({'cloud': cloud, 'cloud-smooth': cloud})
        input_off = apart(given, clean, MEASURED, context.seed, unit=edge)['rms']
        made = {way: _remeshed(context, way, source, points, clean, edge) for way, source in sources.items()}
        rows.append({'model': name, 'level': level, 'points': points, 'input': input_off, 'made': made})
        if level == DRAWN or context.quick:
            drawn = [way for way in made if 'failed' not in made[way]]
            paths = [surface] + [context.file(way + '.ply') for way in drawn]
            captions = ['%s, noise %g' % (name, level)] + [WAYS[way] for way in drawn]
            shown.append(pictures.meshes(context, 'figure14-' + name, captions, paths, size=300, line=0.5))
    return rows, shown


def _remeshed(context, way, source, points, clean, edge):
    """Returns the distance to the clean model in its edge lengths and the measures, or why there is no mesh."""
    try:
        made = library.remesh(context, source, context.file(way + '.ply'), points,
                              *(['--smooth'] if way.endswith('smooth') else []))
    except Failed as failure:
        return {'failed': str(failure)}
    found = measure(made, clean, context.seed)
    edges = 0.01 * clean.diagonal() / edge
    return {'rms': edges * found['distance']['rms'], 'hausdorff': edges * found['distance']['hausdorff'],
            'measures': found}


def report(raw, figures):
    models = list(dict.fromkeys(row['model'] for row in raw['rows']))
    figure, axes = plots.panels(1, 1 + len(models), width=3.1)
    _draw_circle(axes[0, 0], raw['circle'])
    for axis, name in zip(axes[0, 1:], models):
        _draw_model(axis, [row for row in raw['rows'] if row['model'] == name], name)
    axes[0, 1].legend(loc='upper left')
    circle = raw['circle']
    text = ('Left: a circle of radius 1 of %d points, one of which is off by %g (as in figure 12, top): how often the '
            'linear scan keeps that one, over %d orders. Others: vertices moved along normals by Gaussian noise, and '
            'the RMS distance of the results to the clean model, all in its mean edge lengths. A cloud is the vertices '
            'alone. '
            % (circle['points'], circle['off'], circle['orders']))
    text += "The paper's Bimba and its noise are not at hand; its figure has no distances." + raw['less']
    rows = [['%s, noise %g' % (row['model'], row['level']), WAYS[way]] + _cells(made)
            for row in raw['rows'] for way, made in row['made'].items()]
    header = ['', 'way', 'RMS', 'Hausdorff', 'θmin', 'mean θmin', 'Qave', 'topology kept']
    return '\n\n'.join([text, plots.save(figure, figures, 'figure12_14'), *raw['pictures'], markdown([header] + rows),
                        bullets(_sentences(raw))]) + '\n'


def _cells(made):
    if 'failed' in made:
        return ['failed: ' + made['failed']] + [''] * 5
    shape = made['measures']['shape']
    return ['%.3f' % made['rms'], '%.2f' % made['hausdorff'], '%.1f' % shape['theta_min'],
            '%.1f' % shape['theta_min_mean'], '%.3f' % shape['q_mean'],
            'yes' if made['measures']['same_topology'] else 'no']


def _draw_circle(axes, circle):
    sigma = [row['sigma_p'] / circle['off'] for row in circle['rows']]
    axes.plot(sigma, [100 * row['kept'] for row in circle['rows']], 'o-', color=plots.OURS)
    axes.set(xlabel='σp / distance of the point', ylabel='kept, % of orders', ylim=(-3, 103))
    axes.set_title('point off a circle')


def _draw_model(axes, rows, name):
    levels = [row['level'] for row in rows]
    noisy = [row for row in rows if row['level']]
    axes.semilogy([row['level'] for row in noisy], [row['input'] for row in noisy], ':', color=plots.INK, label='input')
    for way, colour in zip(rows[0]['made'], [plots.THEIRS, plots.OURS, plots.FOURTH, plots.THIRD]):
        axes.plot(levels, [row['made'][way].get('rms', np.nan) for row in rows], 'o-', color=colour, label=WAYS[way])
    axes.set(xlabel='noise / edge length', ylabel='RMS / edge length', title=name)


def _sentences(raw):
    rows = raw['circle']['rows']
    falls = rows[0]['kept'] > rows[-1]['kept']
    verdict = ('a wider kernel drops it more often, as in the paper' if falls
               else 'a wider kernel does not drop it more often, unlike in the paper')
    sentences = ['The point off the circle is kept in %.0f %% of the orders at σp = %g, in %.0f %% at σp = %g: %s.' % (
        100 * rows[0]['kept'], rows[0]['sigma_p'], 100 * rows[-1]['kept'], rows[-1]['sigma_p'], verdict)]
    for row in raw['rows']:
        if row['level']:
            sentences.append('%s, noise %g: %s. The input itself is off by %.3f.' % (
                row['model'].capitalize(), row['level'],
                '; '.join(_sentence(WAYS[way], made, row['input']) for way, made in row['made'].items()), row['input']))
    return sentences


def _sentence(way, made, off):
    if 'failed' in made:
        return way + ' failed'
    kept = '' if made['measures']['same_topology'] else ', but the topology is another one'
    return '%s is off by %.3f, %s than the input%s' % (way, made['rms'], word(made['rms'], off, -1), kept)
