"""Finds what got better and what got worse between two runs, beyond noise.

An experiment whose figures of this program are to be watched provides them by

    watched(raw) -> {name: (value, sense, noise)}

where sense is +1 if more is better and -1 if less is better, and noise is the difference that is not significant.
Seconds are compared only if both runs were on machines with the same architecture, system and number of cores.
"""

from dataclasses import dataclass, field

from . import results


@dataclass
class Changes:
    """What got better or worse and what is missing, one line each, and the number of unchanged figures."""
    better: list = field(default_factory=list)
    worse: list = field(default_factory=list)
    gone: list = field(default_factory=list)
    same: int = 0


def changes(before, after):
    found = Changes()
    alike = before['machine'] == after['machine']
    for name, raw in after['experiments'].items():
        old, new = _watched(name, before['experiments'].get(name)), _watched(name, raw)
        if 'failed' in raw and old:
            found.worse.append('%s failed: %s' % (name, raw['failed']))
        found.gone += ['%s: %s' % (name, what) for what in old if what not in new and before['quick'] == after['quick']]
        for what in (w for w in new if w in old and (alike or 'seconds' not in w)):
            _sort(found, '%s: %s' % (name, what), old[what], new[what])
    return found


def _watched(name, raw):
    module = results.experiment(name)
    return module.watched(raw) if raw and 'failed' not in raw and hasattr(module, 'watched') else {}


def _sort(found, what, old, new):
    gain = (new[0] - old[0]) * new[1]
    if abs(gain) <= max(old[2], new[2]):
        found.same += 1
    else:
        (found.better if gain > 0 else found.worse).append('%s: %.4g, was %.4g' % (what, new[0], old[0]))


def text(before, after, name_before, name_after):
    """Returns the changes as lines of text."""
    found = changes(before, after)
    lines = ['%s (%s) against %s (%s)' % (name_after, after['date'], name_before, before['date'])]
    for head, which in (('WORSE', found.worse), ('better', found.better)):
        lines += ['%s:' % head] + ['  ' + line for line in which] if which else []
    if found.gone:
        lines.append('%d figures are no longer there, the first of them %s' % (len(found.gone), found.gone[0]))
    return '\n'.join(lines + ['%d figures are the same within noise' % found.same])
