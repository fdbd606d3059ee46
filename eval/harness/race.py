"""Runs several programs on one model and times them next to each other.

Every run of a peer comes directly before or after one of ours on the same file, which two peers share, so that both
times of a pair are measured under the same conditions. The edge length of programs that take only an edge length is
tuned until the number of vertices fits: in at most `TRIES` runs, the closest of which counts as the first timing.
Programs are timed in as many rounds as the time allows; slow programs are timed once. A crash, a refusal, a timeout or
an unreadable output is a result, too: {'failed': why}.
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
    """Returns the results by name of `programs` (a dict of values of `peers.peer`), which must contain 'remesh'.

    `source` is a file written by harness.mesh, `reference` its content as a mesh; `budget` is in seconds.
    """
    entry = _Entry(source, wanted, sharp, scratch)
    until = time.perf_counter() + budget
    own = programs['remesh']
    lanes = [_Lane(own if name != 'remesh' else None, program, name, entry, reference)
             for name, program in programs.items()]
    # Round by round, so that no program has had many more runs than another when the time is up.
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
        # Times of our last run, until a second peer has used them.
        self.ours = None

    def run(self, program, name, asked):
        """Runs a program once. Returns the seconds of remeshing alone and of the process, and megabytes."""
        target = os.path.join(self.scratch, name + '.ply')
        if os.path.exists(target):
            os.remove(target)
        command = program.command(self.source, target, asked, self.sharp)
        # Exit status 3 of ours means an unverified result.
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
    """One program: its result and its runs so far. The first run is made on construction."""

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
    """Returns the measures, or raises `Failed`: a broken mesh affects only its own row."""
    try:
        return measure(found, reference, sharp=sharp)
    except Exception as problem:  # any error of the libraries on a broken mesh
        raise process.Failed('its result cannot be measured: %s' % problem) from problem


def _tuned(own, program, name, entry):
    """Returns the number to request, the resulting mesh, and a list with the run that made it."""
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
    """Runs the program next to ours, reusing our last run if it was directly before; `own` is None for ours itself."""
    run = entry.run(program, name, asked)
    if not own:
        return {**run, 'our_alone': run['alone'], 'our_process': run['process']}
    ours, entry.ours = entry.ours, None
    if not ours:
        ours = entry.ours = _ours(own, entry)
    return {**run, 'our_alone': ours['alone'], 'our_process': ours['process']}


def _ours(own, entry):
    """Returns our times. A failure of ours has its own row and is not attributed to the peer."""
    try:
        return entry.run(own, 'remesh.pair', entry.wanted)
    except process.Failed:
        return {'alone': None, 'process': None}


def _read(path):
    """Reads a result. Raises `Failed`."""
    try:
        found = mesh.read(path)
    except Exception as problem:  # any error of the reader on a broken file
        raise process.Failed('its result cannot be read: %s' % problem) from problem
    if not len(found.triangles):
        raise process.Failed('its result has no triangles')
    if not np.all(np.isfinite(found.vertices)):
        raise process.Failed('its result has vertices that are nowhere')
    return found


def ratios(result):
    """Returns the time of each run relative to ours, for the pairs in which ours did not fail. Compares remeshing alone
    if the program reports it, and whole processes otherwise."""
    alone = result['seconds'][0] is not None
    key = ('seconds', 'our_seconds') if alone else ('process_seconds', 'our_process_seconds')
    return [theirs / ours for theirs, ours in zip(result[key[0]], result[key[1]]) if ours]


def median_of(values):
    """Returns the median of the known values, or None without any."""
    known = [v for v in values if v is not None]
    return statistics.median(known) if known else None
