"""The paper's Figures 12 and 14: one point far off a circle, and surfaces with noise."""

import json

import numpy as np
import trimesh

from .. import clouds, pictures, plots
from ..process import Failed, run as run_program
from ..text import bullets, less, table

TITLE = 'Figures 12 and 14: noise'

# A circle of radius 1 of so many points, one of which is off by so much.
CIRCLE, OFF = 200, 0.15
SIGMAS, QUICK_SIGMAS = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7], [0.1, 0.5]
ORDERS, QUICK_ORDERS = 25, 5
# Standard deviation of the noise along normals, in mean edge lengths of the model.
LEVELS, QUICK_LEVELS = [0.0, 0.15, 0.3, 0.5], [0.3]
MODELS = {'horse': 8600, 'blob': 3000}
QUICK_POINTS = 1500
DRAWN = 0.3
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
    """How often the scan keeps the point that is off, over so many orders of the points, and how many it keeps."""
    angles = 2 * np.pi * np.arange(CIRCLE) / CIRCLE
    points = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    points[0] *= 1 + OFF
    source, target = context.file('circle.xyz'), context.file('circle.kept.xyz')
    np.savetxt(source, points, fmt='%.17g')
    kept = []
    for seed in range(orders):
        command = [context.binary, 'sample', source, target, '--scan-only', '--sigma-p', str(sigma), '-q']
        run_program(command + ['--seed', str(seed)])
        kept.append(clouds.read_cloud(target)[0])
    off = [bool((np.linalg.norm(some, axis=1) > 1 + 0.5 * OFF).any()) for some in kept]
    return {'sigma_p': sigma, 'kept': float(np.mean(off)), 'points': float(np.mean([len(some) for some in kept]))}


def _noisy(context, name, points):
    """Rows of a model at all levels of noise, and a picture of one of them."""
    case = context.case(name)
    clean = trimesh.load(case.path, force='mesh')
    if clean.volume < 0:
        clean.invert()
    edge = float(clean.edges_unique_length.mean())
    rng = np.random.default_rng(context.seed)
    # The same directions at every level: they differ by a factor alone.
    noise = rng.normal(size=(len(clean.vertices), 1)) * clean.vertex_normals * edge
    rows, shown = [], []
    for level in QUICK_LEVELS if context.quick else LEVELS:
        noisy = trimesh.Trimesh(clean.vertices + level * noise, clean.faces, process=False)
        mesh, cloud = context.file('noisy.ply'), context.file('noisy.xyz')
        noisy.export(mesh)
        np.savetxt(cloud, noisy.vertices, fmt='%.17g')
        sources = {'plain': mesh, 'smooth': mesh}
        if not context.quick:
            sources.update({'cloud': cloud, 'cloud-smooth': cloud})
        input_off = clouds.distance(noisy, clean, context.seed)['rms'] / edge
        made = {way: _remeshed(context, way, source, points, clean, edge) for way, source in sources.items()}
        rows.append({'model': name, 'level': level, 'points': points, 'input': input_off, 'made': made})
        if level == DRAWN or context.quick:
            drawn = [way for way in made if 'failed' not in made[way]]
            paths = [mesh] + [context.file(way + '.ply') for way in drawn]
            captions = ['%s, noise %g' % (name, level)] + [WAYS[way] for way in drawn]
            shown.append(pictures.meshes(context, 'figure14-' + name, captions, paths, size=300, line=0.5))
    return rows, shown


def _remeshed(context, way, source, points, clean, edge):
    """Distance to the clean model in its edge lengths, and the figures of the mesh, or why there is none."""
    target, report = context.file(way + '.ply'), context.file('report.json')
    smooth = ['--smooth'] if way.endswith('smooth') else []
    command = [context.binary, source, target, '--points', str(points), '-q', '--report', report, *smooth]
    try:
        run_program(command, may_exit=(0, 3))
    except Failed as failure:
        return {'failed': str(failure)}
    with open(report, encoding='utf-8') as f:
        output = json.load(f)['output']
    found = clouds.distance(clouds.load_mesh(target), clean, context.seed)
    topology = output['topology']
    return {
        'rms': found['rms'] / edge, 'hausdorff': found['hausdorff'] / edge,
        'theta_min': output['shape']['theta_min'], 'theta_min_mean': output['shape']['theta_min_mean'],
        'q_mean': output['shape']['q_mean'], 'same_topology': bool(topology['euler'] == clean.euler_number
                                                                     and topology['boundary_loops'] == 0),
    }


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
    return '\n\n'.join([text, plots.save(figure, figures, 'figure12_14'), *raw['pictures'], table(header, rows),
                        bullets(_sentences(raw))]) + '\n'


def _cells(made):
    if 'failed' in made:
        return ['failed: ' + made['failed']] + [''] * 5
    return ['%.3f' % made['rms'], '%.2f' % made['hausdorff'],
            '%.1f' % made['theta_min'], '%.1f' % made['theta_min_mean'],
            '%.3f' % made['q_mean'], 'yes' if made['same_topology'] else 'no']


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
    kept = '' if made['same_topology'] else ', but the topology is another one'
    word = 'better' if made['rms'] < off else 'worse'
    return '%s is off by %.3f, %s than the input%s' % (way, made['rms'], word, kept)
