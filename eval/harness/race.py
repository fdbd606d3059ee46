"""One model through several programs, timed beside each other.

Every run of a peer comes right before or right after one of ours on the same file, which two peers share, so that a
pair of times saw the same machine. What only takes an edge length is tuned until the number of vertices fits: at most
`TRIES` runs, the nearest of which counts as the first timing. Programs are timed in rounds, as many as the time allows;
what takes long is timed once. A crash, a refusal, a timeout or an unreadable result is a result: {'failed': why}.
"""

import math
import os
import statistics
import time

import numpy as np

from . import mesh, process
from .measures import measure
from .peers import OURS

TRIES = 3
NEAR = 0.03
TIMEOUT = 60
LONG = 10


def race(programs, source, reference, wanted, sharp, rounds, scratch, budget=math.inf):
    """Results by name of `programs` (a dict of what `peers.peer` gives), which must have 'remesh'.

    `source` is a file that harness.mesh wrote, `reference` the same as a mesh; `budget` is in seconds.
    """
    entry = _Entry(source, wanted, sharp, scratch)
    until = time.perf_counter() + budget
    own = programs['remesh']
    lanes = [_Lane(own if name != 'remesh' else None, program, name, entry, reference)
             for name, program in programs.items()]
    # Round by round, so that where the time is up no program has had many more runs than another.
    for _ in range(1, rounds):
        entry.ours = None
        for lane in lanes:
            if time.perf_counter() < until:
                lane.again()
    return {lane.name: lane.result() for lane in lanes}


class _Entry:
    def __init__(self, source, wanted, sharp, scratch):
        self.source, self.wanted, self.sharp = source, wanted, sharp
        self.scratch = scratch
        # Our times since the last run of a peer that has had them beside it.
        self.ours = None

    def run(self, program, name, asked):
        """One run: seconds of remeshing alone, those of the process, megabytes, and the file."""
        target = os.path.join(self.scratch, name + '.ply')
        if os.path.exists(target):
            os.remove(target)
        command = program.command(self.source, target, asked, self.sharp)
        # 3 is how ours says that its result could not be verified.
        ran = process.run(command, TIMEOUT, (0, 3) if name.split('.')[0] in OURS else (0,))
        if not os.path.exists(target):
            raise process.Failed('wrote no result')
        return {'alone': _alone(program, ran.output, target), 'process': ran.seconds, 'megabytes': ran.megabytes}


def _alone(program, output, target):
    try:
        return program.seconds(output, target)
    except (ValueError, LookupError, OSError) as problem:
        raise process.Failed('told no time: %s' % problem) from problem


class _Lane:
    """One program: its result and its runs so far. The first is done at once."""

    def __init__(self, own, program, name, entry, reference):
        self.own, self.program, self.name, self.entry = own, program, name, entry
        self.failed, self.runs = None, []
        try:
            self.asked, found, self.runs = _tuned(own, program, name, entry)
            self.vertices, self.measures = len(found.vertices), _measures(found, reference, entry.sharp)
        except process.Failed as failure:
            self.failed = str(failure)

    def again(self):
        if self.failed or self.runs[-1]['process'] >= LONG:
            return
        try:
            self.runs.append(_pair(self.own, self.program, self.name, self.asked, self.entry))
        except process.Failed as failure:
            self.failed = str(failure)

    def result(self):
        if self.failed:
            return {'failed': self.failed}
        return {
            'vertices': self.vertices,
            'asked': self.asked,
            'off': self.vertices / self.entry.wanted - 1,
            'seconds': [run['alone'] for run in self.runs],
            'process_seconds': [run['process'] for run in self.runs],
            'our_seconds': [run['our_alone'] for run in self.runs],
            'our_process_seconds': [run['our_process'] for run in self.runs],
            'megabytes': max(run['megabytes'] for run in self.runs),
            'measures': self.measures,
        }


def _measures(found, reference, sharp):
    """The measures, or `Failed`: a broken mesh costs its own row alone."""
    try:
        return measure(found, reference, sharp=sharp)
    except Exception as problem:  # whatever the libraries make of a broken mesh
        raise process.Failed('its result cannot be measured: %s' % problem) from problem


def _tuned(own, program, name, entry):
    """What to ask for, the mesh that this gives, and the run that made it, in a list."""
    asked, best = entry.wanted, None
    for _ in range(1 if program.COUNTS else TRIES):
        try:
            run = _pair(own, program, name, asked, entry)
            found = _read(os.path.join(entry.scratch, name + '.ply'))
        except process.Failed:
            if best is None:
                raise
            break
        if best is None or _off(found, entry) < _off(best[1], entry):
            best = asked, found, [run]
        if _off(best[1], entry) <= NEAR:
            break
        asked = max(4, round(asked * entry.wanted / len(found.vertices)))
    return best


def _off(found, entry):
    return abs(len(found.vertices) / entry.wanted - 1)


def _pair(own, program, name, asked, entry):
    """A run of the program beside one of ours, the last one if it is right before; `own` is None for ours itself."""
    run = entry.run(program, name, asked)
    if not own:
        return {**run, 'our_alone': run['alone'], 'our_process': run['process']}
    ours, entry.ours = entry.ours, None
    if not ours:
        ours = entry.ours = _ours(own, entry)
    return {**run, 'our_alone': ours['alone'], 'our_process': ours['process']}


def _ours(own, entry):
    """Our times. A failure of ours has a row of its own and does not count as the peer's."""
    try:
        return entry.run(own, 'remesh.pair', entry.wanted)
    except process.Failed:
        return {'alone': None, 'process': None}


def _read(path):
    """A result, or `Failed`."""
    try:
        found = mesh.read(path)
    except Exception as problem:  # whatever the reader makes of a broken file
        raise process.Failed('its result cannot be read: %s' % problem) from problem
    if not len(found.triangles):
        raise process.Failed('its result has no triangles')
    if not np.all(np.isfinite(found.vertices)):
        raise process.Failed('its result has vertices that are nowhere')
    return found


def ratios(result):
    """How many times as long as ours each run took, by remeshing alone where it is told, else by whole processes; of
    those pairs where ours did not fail."""
    alone = result['seconds'][0] is not None
    key = ('seconds', 'our_seconds') if alone else ('process_seconds', 'our_process_seconds')
    return [theirs / ours for theirs, ours in zip(result[key[0]], result[key[1]]) if ours]


def median_of(values):
    """The median, or None of no values."""
    known = [v for v in values if v is not None]
    return statistics.median(known) if known else None
