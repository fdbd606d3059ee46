"""The paper's Figure 10: samples gather where the surface bends, depending on the kernel width σn along normals."""

import numpy as np
from scipy.spatial import cKDTree
from scipy.stats import spearmanr

from .. import library, mesh, pictures, plots
from ..measures.distance import distances
from ..points import nearest
from ..tables import bullets, less, markdown
from ..verdicts import word

TITLE = 'Figure 10: samples that follow the shape, σn'

WIDTHS, QUICK_WIDTHS = [None, 1.0, 0.75, 0.5], [None, 0.5]
# The model and its number of samples; the project's own model is used if the other is not available.
MODELS = {'rocker-arm': 4000, 'blob': 3000}
QUICK_POINTS = 1000
# Number of samples at which curvature is measured, and of neighbours from which it is measured.
DENSE, QUICK_DENSE, AROUND = 60_000, 15_000, 12
# Number of points from which distances are measured.
MEASURED = 100_000
BINS = 12


def run(context):
    name = 'blob' if context.quick else next(n for n in MODELS if context.case(n))
    case, points = context.case(name), QUICK_POINTS if context.quick else MODELS[name]
    count = QUICK_DENSE if context.quick else DENSE
    dense = library.samples(context, case.path, '--points', str(count), '--sweeps', '2')
    bend = _curvature(*dense)
    original = mesh.read(case.path)
    rows, sets, paths = [], [], []
    for width in QUICK_WIDTHS if context.quick else WIDTHS:
        option = [] if width is None else ['--sigma-n', width]
        found = library.samples(context, case.path, '--points', str(points), *option)
        path = context.file('%s.ply' % width)
        made = library.remesh(context, case.path, path, points, *option)
        rows.append({'sigma_n': width, 'samples': len(found[0]), 'density': _density(found[0], *dense, bend),
                     'lost': distances(made, original, MEASURED, context.seed)})
        sets.append(found)
        paths.append(path)
    captions = ['σn = ' + _named(row['sigma_n']) for row in rows]
    shown = [pictures.samples(context, 'figure10-samples', captions, sets, dense),
             pictures.meshes(context, 'figure10-meshes', captions, paths, line=0.7)]
    left_out = less(context.quick, "the project's own model, fewer samples, and two widths instead of %d" % len(WIDTHS))
    return {'model': name, 'points': points, 'rows': rows, 'pictures': shown,
            'seed': context.seed, 'less': left_out}


def _curvature(points, normals):
    """Returns the curvature at each point, in radians per unit of length: the root mean square over the neighbours,
    which for principal curvatures a and b is √((a² + b²) / 2)."""
    distance, other = cKDTree(points).query(points, k=AROUND + 1)
    cosine = np.einsum('ijk,ik->ij', normals[other[:, 1:]], normals)
    # Neighbours that face away belong to another side.
    counts = cosine > 0
    turned = np.where(counts, np.arccos(np.clip(cosine, -1, 1)) / distance[:, 1:], 0)
    return np.sqrt(np.sum(turned ** 2, axis=1) / np.maximum(counts.sum(axis=1), 1))


def _density(points, dense, normals, bend):
    """Returns the sample density by curvature. The surface is divided into classes of equal area; the result is their
    mean curvature times the spacing, and their density relative to the mean."""
    of_sample = bend[cKDTree(dense).query(points)[1]]
    limits = np.quantile(bend, np.linspace(0, 1, BINS + 1))
    limits[[0, -1]] = -np.inf, np.inf
    spacing = nearest(points, 6).mean()
    middle = [bend[(bend >= a) & (bend < b)].mean() * spacing for a, b in zip(limits, limits[1:])]
    # Every class has the same area, so its share of the samples gives its density.
    shares = np.histogram(of_sample, limits)[0] / len(points) * BINS
    return {'curvature': middle, 'relative': shares.tolist()}


def _named(width):
    return '∞' if width is None else '%g' % width


def report(raw, figures):
    figure, axes = plots.panels(1, 1, width=4.6, height=3)
    axes = axes[0, 0]
    for row, colour in zip(raw['rows'], [plots.INK, plots.THIRD, plots.THEIRS, plots.OURS]):
        axes.semilogx(row['density']['curvature'], row['density']['relative'], 'o-', color=colour,
                    label='σn = ' + _named(row['sigma_n']))
    axes.set(xlabel='curvature × mean spacing', ylabel='density / mean density', ylim=(0, None))
    axes.legend()
    text = ('%d samples of %s at each σn, and meshes of as many vertices; the paper\'s figure has σn = ∞ and 0.5 at '
            'one σp. Density is that of samples by classes of the area, from flat to bent. The distance to the model '
            'is that of the meshes, in percent of the diagonal.' % (raw['points'], raw['model'])) + raw['less']
    rows = [['σn = ' + _named(row['sigma_n']), '%.2f' % row['density']['relative'][0],
             '%.2f' % row['density']['relative'][-1], '%.4f' % (row['lost']['rms']),
             '%.3f' % (row['lost']['hausdorff'])] for row in raw['rows']]
    header = ['', 'density where flattest', 'density where most bent', 'RMS %', 'Hausdorff %']
    return '\n\n'.join([text, *raw['pictures'], plots.save(figure, figures, 'figure10'), markdown([header] + rows),
                        bullets(_sentences(raw))]) + '\n'


def _sentences(raw):
    even, *others = raw['rows']
    flat = np.array(even['density']['relative'])
    sentences = ['Without σn density is even: from %.2f to %.2f of its mean over all classes%s.' % (
        flat.min(), flat.max(), '' if np.ptp(flat) < 0.2 else ', which is not quite even')]
    for row in others:
        relative = np.array(row['density']['relative'])
        rank = spearmanr(row['density']['curvature'], relative).statistic
        words = ['%s by %.0f %%' % (word(row['lost'][key], even['lost'][key], -1),
                                    100 * abs(row['lost'][key] / even['lost'][key] - 1))
                 for key in ('rms', 'hausdorff')]
        sentences.append(
            'σn = %g: %.1f times as dense where the surface bends most as where it is flattest, rank correlation of '
            'density and curvature %.2f. Against even samples RMS is %s, Hausdorff %s.' % (
                row['sigma_n'], relative[-1] / relative[0], rank, *words))
    return sentences
