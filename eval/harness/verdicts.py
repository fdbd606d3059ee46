"""Determines which of two results is better, measure by measure."""

from dataclasses import dataclass

from .race import median_of, ratios
from .tables import listed


@dataclass(frozen=True)
class Measure:
    """A figure by which results are compared.

    `path` is its place in the return value of `measures.measure`, which may lack it. `sense` is +1 if more is better
    and -1 if less is better. `noise` is the difference that is not significant.
    """
    label: str
    path: tuple
    sense: int
    noise: float

    def of(self, measures):
        for key in self.path:
            measures = None if measures is None else measures.get(key)
        return measures


# The noise is the spread (maximum minus minimum) of this program's results with four seeds that three quarters of eight
# models stay below; for sharp edges, three quarters of twelve CAD parts. Crossings and angles below 30 degrees had
# none.
MEASURES = [
    Measure('θmin', ('shape', 'theta_min'), 1, 2),
    Measure('mean θmin', ('shape', 'theta_min_mean'), 1, 0.25),
    Measure('θmax', ('shape', 'theta_max'), -1, 4),
    Measure('Qmin', ('shape', 'q_min'), 1, 0.035),
    Measure('Qave', ('shape', 'q_mean'), 1, 0.004),
    Measure('% below 30°', ('shape', 'percent_below_30'), -1, 0.01),
    Measure('% above 90°', ('shape', 'percent_above_90'), -1, 0.05),
    Measure('% of valence 6', ('topology', 'percent_valence_6'), 1, 1),
    Measure('variation of edges', ('shape', 'edge_cv'), -1, 0.0065),
    Measure('RMS distance', ('distance', 'rms'), -1, 0.0012),
    Measure('Hausdorff distance', ('distance', 'hausdorff'), -1, 0.1),
    Measure('RMS distance of sharp edges', ('sharp_edges', 'rms'), -1, 0.0025),
    Measure('crossing faces', ('crossing_faces',), -1, 0),
]


def measure_called(label):
    return next(measure for measure in MEASURES if measure.label == label)


def watched_measures(name, measures):
    """Returns all figures of one result of ours, in the format of an experiment's `watched`."""
    known = ((measure, measure.of(measures)) for measure in MEASURES)
    return {'%s %s' % (name, m.label): (value, m.sense, m.noise) for m, value in known if value is not None}


def word(ours, theirs, sense=1):
    """Compares two figures in words. More is better, or less with the sense -1."""
    gain = sense * (ours - theirs)
    return 'better' if gain > 0 else 'worse' if gain < 0 else 'no better'


def sign(measure, ours, theirs):
    """Returns 1 if ours is better by more than noise, -1 if it is worse, and 0 otherwise."""
    a, b = measure.of(ours), measure.of(theirs)
    if a is None or b is None or abs(a - b) <= measure.noise:
        return 0
    return 1 if (a > b) == (measure.sense > 0) else -1


def against(label, models, name, times=True):
    """Returns sentences that compare ours with the program `name` on all models (name -> results by program)."""
    both = {m: (r['remesh'], r[name]) for m, r in models.items() if name in r and 'measures' in r['remesh']}
    whole = {m: pair for m, pair in both.items() if 'measures' in pair[1]}
    parts = ['**%s** (%d of %d models):' % (label, len(whole), len(both))]
    parts += _shape_words(whole) if whole else ['nothing to compare.']
    parts += [_time_words(whole)] if whole and times else []
    return ' '.join(parts + _fault_words(both))


def counts(models, name):
    """Returns, for each measure, on how many models ours is better and worse than `name`; and the number of models."""
    both = [(r['remesh']['measures'], r[name]['measures']) for r in models.values()
            if 'measures' in r['remesh'] and 'measures' in r.get(name, {})]
    signs = {measure: [sign(measure, *pair) for pair in both] for measure in MEASURES}
    return {measure: (found.count(1), found.count(-1)) for measure, found in signs.items()}, len(both)


def mostly(label, models, name):
    """Returns sentences that compare ours with the program `name` on too many models to name them for each measure."""
    found, number = counts(models, name)
    better = [measure.label for measure, (more, _) in found.items() if 2 * more > number]
    worse = [measure.label for measure, (_, less) in found.items() if 2 * less > number]
    text = '**%s** (%d of %d models): ' % (label, number, len(models))
    if not number:
        return text + 'nothing to compare.'
    text += 'on most ours is better in %s, and worse in %s.' % tuple(listed(m or ['nothing']) for m in (better, worse))
    mixed = [measure.label for measure in MEASURES if measure.label not in better + worse]
    return text + (' Neither on most in %s.' % listed(mixed) if mixed else '')


def _shape_words(pairs):
    """Returns sentences on where ours is better and worse; measures with the same models are grouped."""
    signs = {measure: {m: sign(measure, a['measures'], b['measures']) for m, (a, b) in pairs.items()}
             for measure in MEASURES}
    words = []
    for head, which in (('ours is better', 1), ('Ours is worse', -1)):
        places = {}
        for measure, found in signs.items():
            where = tuple(m for m, s in found.items() if s == which)
            if where:
                places.setdefault(where, []).append(measure.label)
        parts = ['%s on %s' % (listed(labels), _which(where, pairs)) for where, labels in places.items()]
        words.append('%s in %s.' % (head, '; '.join(parts) or 'nothing'))
    return words


def _which(names, of):
    return 'all' if len(names) == len(of) else listed(names)


def _time_words(pairs):
    """Returns the time of the other program relative to ours, and the models on which all pairs of runs agree."""
    times = {m: r for m, r in ((m, ratios(b)) for m, (_, b) in pairs.items()) if r}
    if not times:
        return 'Its time is not known.'
    slower = [m for m, r in times.items() if min(r) > 1]
    faster = [m for m, r in times.items() if max(r) < 1]
    middle = [median_of(r) for r in times.values()]
    ends = dict.fromkeys('%.2g' % end for end in (min(middle), max(middle)))
    words = 'It takes %s times as long as ours' % ' to '.join(ends)
    if slower:
        words += '; longer in every pair of runs on %s' % _which(slower, pairs)
    if faster:
        words += '; shorter in every pair of runs on %s' % _which(faster, pairs)
    return words + '.'


def _fault_words(pairs):
    faults = {}
    for model, (_, theirs) in pairs.items():
        for fault in faults_of(theirs):
            faults.setdefault(fault, []).append(model)
    return ['Its faults: %s.' % '; '.join('%s (%s)' % (f, listed(m)) for f, m in faults.items())] if faults else []


def faults_of(result):
    """Returns the faults of a result in a few words each, without numbers that differ from model to model."""
    if 'failed' in result:
        return [result['failed']]
    found = result['measures']
    topology = found['topology']
    checks = [
        ('non-manifold', topology['nonmanifold_edges'] or topology['nonmanifold_vertices']),
        ('faces without three corners', topology['degenerate_faces']),
        ('inconsistent orientation', topology['misoriented_edges']),
        ('inside out', found['inside_out']),
        ('other topology than the input', not found['same_topology']),
        ('crossing faces', found['crossing_faces']),
        ('more than 3 % off the count', abs(result['off']) > 0.03),
    ]
    return [what for what, wrong in checks if wrong]
