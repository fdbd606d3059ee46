"""The paper's Table 2: the loss of a surface reconstructed from a subset of its points."""

import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np

from .. import library, mesh, subsampling
from ..measures.distance import apart, blended, scattered
from ..points import scaled, surface_of_meshlab
from ..process import Failed
from ..tables import bullets, less, listed, markdown

TITLE = 'Table 2: surfaces of a part of the points'

SIGMA_N = 0.75
WIDTHS = [0.5, 0.75, 1.0]
MODELS, OTHERWISE = ['igea', 'horse'], 'blob'
# Support radius of points in the reconstruction, in σp: about that of the paper's kernel (section 6.3). With the
# paper's 2.5, MeshLab's surfaces have holes.
REACH = 3.0
# Edge lengths of the cells with which surfaces are extracted, in a box of 100. For the same edge length,
# ours has four times as many corners.
CELLS = {'remesh': 0.8, 'meshlab': 0.5}
QUICK_CELLS = {'remesh': 2.0, 'meshlab': 1.5}
# Number of points from which distances are measured.
MEASURED = 30_000
# Number of points of a cloud made from a mesh that has too few vertices.
CLOUD, QUICK_CLOUD, QUICK_WIDTH = 50_000, 5_000, 2.3
NAMES = {'ours': 'ours', 'as': 'AS', 'ks': 'KS', 'random': 'random', 'voxels': 'voxels'}
SURFACES = {'remesh': 'our surface', 'meshlab': "MeshLab's RIMLS"}
MEASURES = {'rms': 'RMS', 'hausdorff': 'Hausdorff'}

# RMS and Hausdorff distances in the paper's rows for σp = 0.5, 0.75, 1: ours, AS, KS.
PAPER = {
    'igea': {'rms': [[0.0071, 0.0064, 0.0091], [0.0114, 0.0310, 0.0818], [0.0407, 0.0824, 0.1251]],
             'hausdorff': [[0.1075, 0.1415, 0.1120], [0.1500, 0.4384, 0.4640], [0.1907, 1.3302, 2.0278]]},
    'hand': {'rms': [[0.0186, 0.1628, 0.1464], [0.0286, 0.5405, 0.5873], [0.0439, 1.0162, 1.0382]],
             'hausdorff': [[0.2116, 1.2040, 1.1011], [0.2472, 2.0007, 2.1906], [0.5616, 2.9348, 2.7861]]},
    'statue': {'rms': [[0.0488, 0.2357, 0.2796], [0.0949, 0.5980, 0.6975], [0.1501, 1.0184, 0.7677]],
               'hausdorff': [[1.2853, 1.3792, 1.4335], [1.9832, 2.0409, 2.4409], [2.5519, 3.7673, 2.5541]]},
    'dragon': {'rms': [[0.0526, 0.1011, 0.3299], [0.0973, 0.2514, 0.6862], [0.1495, 0.5747, 1.4733]],
               'hausdorff': [[1.4130, 1.3971, 1.7840], [2.0595, 2.0062, 2.6382], [2.6049, 2.8164, 4.3328]]},
    'filigree': {'rms': [[0.0209, 0.3206, 0.1623], [0.0457, 0.8481, 0.4929], [0.0832, 1.3032, 1.0696]],
                 'hausdorff': [[0.2591, 1.3294, 1.1363], [0.4363, 2.2062, 1.7476], [0.8408, 2.6989, 2.5756]]},
}


def run(context):
    at_hand = [] if context.quick else [name for name in MODELS if context.case(name)]
    clouds_at_hand = {name: _cloud(context, context.case(name)) for name in at_hand or [OTHERWISE]}
    widths = [QUICK_WIDTH] if context.quick else WIDTHS
    tasks = [(context, name, *cloud, width) for name, cloud in clouds_at_hand.items() for width in widths]
    if len(tasks) > 1:
        with ProcessPoolExecutor(2, mp_context=get_context('spawn')) as pool:
            rows = list(pool.map(_row, *zip(*tasks)))
    else:
        rows = [_row(*task) for task in tasks]
    left_out = [name for name in MODELS if name not in clouds_at_hand]
    return {'rows': rows, 'left_out': left_out, 'sigma_n': SIGMA_N, 'seed': context.seed,
            'less': less(context.quick, "one small cloud, coarse surfaces and one σp, larger than the paper's")}


def _cloud(context, case):
    """Returns points with normals in a box of 100: the vertices, or random points if there are too few vertices."""
    wanted = QUICK_CLOUD if context.quick else CLOUD
    model = mesh.read(case.path).outward()
    points, normals = model.vertices, model.normals()
    if len(points) < 0.8 * wanted:
        places = scattered(model, wanted, np.random.default_rng(context.seed))
        points, normals = blended(model, points, places), blended(model, normals, places)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return scaled(points), normals


def _row(context, model, points, normals, width):
    """Returns the loss of each method with as many points as the scan keeps at one σp."""
    context = replace(context, scratch=context.file('%s-%g' % (model, width)))
    os.makedirs(context.scratch)
    subsets, seconds = {}, {}

    def take(name, how):
        start = time.perf_counter()
        subsets[name] = how()
        seconds[name] = time.perf_counter() - start

    subsets['ours'], seconds['ours'] = library.scan(context, points, normals, width, SIGMA_N)
    wanted = len(subsets['ours'])
    take('as', lambda: subsampling.remove_nearest_to_surface(points, normals, wanted, width))
    take('ks', lambda: subsampling.remove_least_of_kernels(points, normals, wanted, width))
    take('random', lambda: subsampling.random_subset(len(points), wanted, context.seed))
    take('voxels', lambda: subsampling.voxel_subset(points, wanted))
    lost = {surface: _lost(context, surface, points, normals, subsets, width) for surface in SURFACES}
    counts = {name: len(subset) for name, subset in subsets.items()}
    return {'model': model, 'sigma_p': width, 'of': len(points), 'points': counts, 'seconds': seconds, 'lost': lost}


def _lost(context, surface, points, normals, subsets, width):
    """Returns, for each subset, the distances of its surface to that of all points, or why it has no surface."""
    cell = (QUICK_CELLS if context.quick else CELLS)[surface]

    def surface_of(name, part):
        if surface == 'remesh':
            return library.surface(context, name, points[part], normals[part], REACH * width, cell)
        return surface_of_meshlab(points[part], normals[part], REACH * width, cell)

    whole = surface_of('all', slice(None))
    lost = {}
    for name, subset in subsets.items():
        try:
            lost[name] = apart(surface_of(name, subset), whole, MEASURED, context.seed)
        except Failed as failure:
            lost[name] = {'failed': str(failure)}
    return lost


def report(raw, figures):
    parts = ['Each model fills a box of 100. The linear scan at σn = %g keeps a number of its points; the other ways '
             'keep as many. AS removes the point nearest to the surface that the others define, KS the one whose '
             'kernel changes the surface least; both are ours after their descriptions '
             "(`eval/harness/subsampling.py`), and KS's paper may weigh otherwise. When surfaces are made of them, "
             'points reach %g σp, as far for all points as for a part, but never less than by default: by '
             "`remesh reconstruct` and, independently, by MeshLab's RIMLS with marching cubes. Seconds: ours are of "
             'the scan in the binary, the others of Python code, and only say that this is affordable.'
             % (raw['sigma_n'], REACH)]
    parts[0] += raw['less']
    if raw['left_out']:
        parts.append('Left out: %s.' % listed(raw['left_out']))
    parts += [_table_of(raw, surface) for surface in SURFACES]
    parts.append(_seconds(raw))
    parts.append(_paper(raw))
    parts.append(bullets(_sentences(raw)))
    return '\n\n'.join(parts) + '\n'


def _table_of(raw, surface):
    rows = []
    for row in raw['rows']:
        for key, label in MEASURES.items():
            figures = {name: lost.get(key) for name, lost in row['lost'][surface].items()}
            best = min((f for f in figures.values() if f is not None), default=None)
            cells = ['failed' if f is None else ('**%.4f**' if f == best else '%.4f') % f
                     for f in (figures[name] for name in NAMES)]
            of = '%d of %d' % (row['points']['ours'], row['of'])
            rows.append(['%s, σp = %g' % (row['model'], row['sigma_p']), of, label] + cells)
    return 'With %s:\n\n%s' % (SURFACES[surface], markdown([['model', 'points', 'lost'] + list(NAMES.values())] + rows))


def _seconds(raw):
    rows = [['%s, σp = %g' % (row['model'], row['sigma_p'])] + ['%.2f' % row['seconds'][name] for name in NAMES]
            for row in raw['rows']]
    return 'Seconds to choose:\n\n' + markdown([['model'] + list(NAMES.values())] + rows)


def _paper(raw):
    """Returns the paper's rows, with ours next to them if the model is the same."""
    ours = {(row['model'], row['sigma_p']): row['lost']['remesh']['ours'] for row in raw['rows']}
    rows = []
    for model, measures in PAPER.items():
        for key, label in MEASURES.items():
            cells = []
            for width, three in zip(WIDTHS, measures[key]):
                here = ours.get((model, width), {}).get(key)
                cells += ['%.4f' % f for f in three] + ['' if here is None else '**%.4f**' % here]
            rows.append([model, label] + cells)
    header = ['paper', 'lost'] + ['%s %g' % (who, w) for w in WIDTHS for who in ('ours', 'AS', 'KS', '**here**')]
    return "The paper's own rows (ours, AS and KS at each σp), and ours here where the model is the same:\n\n" \
        + markdown([header] + rows)


def _sentences(raw):
    """Returns what is better and what is worse."""
    sentences = [_against_others(raw, surface, name, key, label) for surface, name in SURFACES.items()
                 for key, label in MEASURES.items()]
    models = {row['model'] for row in raw['rows'] if row['sigma_p'] in WIDTHS}
    return sentences + [_against_paper(raw, model, key, label) for model in PAPER if model in models
                        for key, label in MEASURES.items()]


def _against_others(raw, surface, name, key, label):
    parts = []
    for other in list(NAMES)[1:]:
        both = [(row['lost'][surface]['ours'].get(key), row['lost'][surface][other].get(key)) for row in raw['rows']]
        both = [(a, b) for a, b in both if a is not None and b is not None]
        if both:
            factor = float(np.exp(np.mean([np.log(b / a) for a, b in both])))
            better = sum(a < b for a, b in both)
            parts.append('than %s in %d of %d rows (theirs is %.2f times ours)' % (
                NAMES[other], better, len(both), factor))
    return 'With %s our %s is better %s; factors are geometric means.' % (name, label, listed(parts))


def _against_paper(raw, model, key, label):
    """Compares our figures with those that the paper prints for its own method."""
    parts = {'better': [], 'worse': []}
    for row in raw['rows']:
        here = row['lost']['remesh']['ours'].get(key)
        if row['model'] == model and row['sigma_p'] in WIDTHS and here is not None:
            printed = PAPER[model][key][WIDTHS.index(row['sigma_p'])][0]
            text = '%.4f, the paper %.4f at σp = %g' % (here, printed, row['sigma_p'])
            parts['better' if here < printed else 'worse'].append(text)
    return "Against the paper's own figures of its method, %s, %s: better %s; worse %s." % (
        model, label, '; '.join(parts['better']) or 'nowhere', '; '.join(parts['worse']) or 'nowhere')
