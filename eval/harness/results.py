"""The figures of a run as JSON: what was measured, when, with which versions, on what machine, by which command.

`experiments` has the return value of each experiment's `run`, or {'failed': why}. Experiments from a different run that
were put into the file have their date, versions, machine and command in `apart`. RESULTS.md is written from this file
only. Each experiment runs in a separate process, and the file is written after each one, so that an experiment that
fails, hangs or is interrupted does not affect the others.
"""

import contextlib
import datetime
import importlib
import importlib.metadata
import json
import multiprocessing
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
import traceback

from .context import EVAL, ROOT, Context, cases_at_hand
from .experiments import NAMES

SCHEMA = 'spectral-remesh/eval/1'
LATEST = os.path.join(EVAL, 'results', 'latest.json')
PARTIAL = os.path.join(EVAL, 'partial', 'results.json')
# Members kept from a run when only some of its experiments are put into another.
MADE_WITH = ('date', 'command', 'quick', 'seed', 'versions', 'machine', 'missing_models')
# Seconds after which an experiment is ended.
LIMIT = 1800


def experiment(name):
    return importlib.import_module('.experiments.' + name, __package__)


def run(names, models, quick, out, command, whole=None):
    """Runs the experiments, writes their figures to `out` after each one, and returns them. If `whole`, the figures of
    an earlier run, is given, they replace its figures of the same experiments."""
    cases, missing = cases_at_hand(None if quick else models)
    for name in [] if quick else missing:
        sys.stderr.write('%s is left out: its model is not there (--models FOLDER)\n' % name)
    found = {'schema': SCHEMA, 'date': datetime.date.today().isoformat(), 'command': command, 'quick': quick,
             'seed': Context.seed, 'versions': versions(), 'machine': machine(), 'missing_models': missing,
             'seconds': {}, 'experiments': {}}
    began = time.perf_counter()
    for name in names:
        start = time.perf_counter()
        _tell(start - began, name)
        with tempfile.TemporaryDirectory() as scratch:
            context = Context(cases_for(name, cases), scratch, os.path.join(folder_of(out), 'figures'), quick)
            raw = found['experiments'][name] = alone(experiment(name).run, context)
        found['seconds'][name] = time.perf_counter() - start
        _tell(time.perf_counter() - began, '%s: %s' % (name, raw.get('failed', 'done')))
        _save(joined(whole, found) if whole else found, out)
    return joined(whole, found) if whole else found


def cases_for(name, cases):
    """Returns the cases that the experiment with this name uses."""
    return [case for case in cases if case.only in (None, name)]


def joined(whole, part):
    """Returns the figures of a run, with experiments of a later run in place of its own, and the origin of those."""
    experiments = whole['experiments'] | part['experiments']
    return whole | {
        'seconds': whole['seconds'] | part['seconds'],
        'experiments': {name: experiments[name] for name in sorted(experiments, key=NAMES.index)},
        'apart': whole.get('apart', {}) | {
            name: {key: part[key] for key in MADE_WITH} for name in part['experiments']},
    }


def _tell(seconds, words):
    sys.stderr.write('[%4.1f min] %s\n' % (seconds / 60, words))


def _save(found, path):
    """Writes the file completely or not at all."""
    os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
    with open(path + '.new', 'w', encoding='utf-8') as f:
        json.dump(found, f, indent=1, ensure_ascii=False, allow_nan=False)
        f.write('\n')
    os.replace(path + '.new', path)


def alone(measure, context, limit=LIMIT):
    """Returns `measure(context)`, run in a separate process, so that no error, crash or hang affects the others."""
    target = context.file('raw.json')
    process = multiprocessing.get_context('spawn').Process(target=_measured, args=(measure, context, target))
    process.start()
    try:
        process.join(limit)
        late = process.is_alive()
    finally:
        _end(process)
    if os.path.exists(target):
        with open(target, encoding='utf-8') as f:
            return json.load(f)
    return {'failed': 'not done after %g s' % limit if late else 'ended with status %s' % process.exitcode}


def _measured(measure, context, target):
    """Writes the raw figures, or the error."""
    # A separate process group, so that the processes that it starts can be ended with it.
    os.setpgid(0, 0)
    try:
        raw = json.dumps(measure(context), allow_nan=False)
    except Exception as problem:
        traceback.print_exc()
        raw = json.dumps({'failed': '%s: %s' % (type(problem).__name__, problem)})
    with open(target + '.new', 'w', encoding='utf-8') as f:
        f.write(raw)
    os.replace(target + '.new', target)


def _end(process):
    """Ends a process and its process group."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def versions():
    """Returns the versions of the program under test and of the packages that the harness uses."""
    def words(command):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        return done.stdout.strip() if done.returncode == 0 else None

    found = {'remesh': (words([Context.binary, '--version']) or 'not built').removeprefix('remesh '),
             'commit': words(['git', 'describe', '--always', '--dirty']), 'python': platform.python_version()}
    with open(os.path.join(EVAL, 'requirements.txt'), encoding='utf-8') as f:
        for line in f:
            name = line.split('==')[0].strip()
            if name and not name.startswith('#'):
                found[name] = importlib.metadata.version(name)
    return found


def machine():
    return {'cores': len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count(),
            'architecture': platform.machine(), 'system': platform.system()}


def command_line(options):
    """Returns the command as typed, without names of folders outside the project."""
    words = ['eval/run']
    words += ['--models FOLDER'] if options.models else []
    words += ['--only ' + options.only] if options.only else []
    words += ['--quick'] if options.quick else []
    return ' '.join(words)


def load(path):
    """Returns the figures in a file. Exits if it is not a file of figures."""
    try:
        with open(path, encoding='utf-8') as f:
            found = json.load(f)
    except (OSError, ValueError) as problem:
        sys.exit('eval/run: %s: %s' % (path, problem))
    if found.get('schema') != SCHEMA:
        sys.exit('eval/run: %s is not of schema %s' % (path, SCHEMA))
    return found


def committed():
    """Returns the figures of the last committed run, or None."""
    name = os.path.relpath(LATEST, ROOT)
    done = subprocess.run(['git', 'show', 'HEAD:./' + name], cwd=ROOT, capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else None


def folder_of(path):
    """Returns the folder of RESULTS.md for a file: eval/ for the latest complete run, otherwise that of the file."""
    return EVAL if os.path.abspath(path) == LATEST else os.path.dirname(os.path.abspath(path))


def report(found, folder):
    """Writes RESULTS.md and figures/ into `folder`, and returns the path of RESULTS.md."""
    figures = os.path.join(folder, 'figures')
    os.makedirs(figures, exist_ok=True)
    parts = [_heading(found)]
    for name, raw in found['experiments'].items():
        module = experiment(name)
        parts.append('## ' + module.TITLE)
        if name in found.get('apart', {}):
            parts.append('Not of the same run as the rest. ' + ' '.join(_measured_with(found['apart'][name])))
        parts.append('Failed: %s' % raw['failed'] if 'failed' in raw else module.report(raw, figures))
    path = os.path.join(folder, 'RESULTS.md')
    with open(path, 'w', encoding='utf-8') as f:
        f.write('\n\n'.join(parts) + '\n')
    return path


def _heading(found):
    tools = ', '.join('%s %s' % (name, version) for name, version in found['versions'].items()
                      if name not in ('remesh', 'commit'))
    facts = [
        *_measured_with(found),
        'Took %.0f min.' % (sum(found['seconds'].values()) / 60),
        'The harness used %s.' % tools,
        'Written from the figures in JSON. `eval/README.md` says what the measures mean and how we are biased.',
    ]
    return '# Results\n\n' + '\n'.join('- ' + fact for fact in facts)


def _measured_with(found):
    return [
        'Measured on %s by `%s`%s.' % (found['date'], found['command'], _models(found)),
        'remesh %s (%s), seed %d.' % (found['versions']['remesh'], found['versions']['commit'], found['seed']),
        'Machine: %s.' % machine_words(found),
    ]


def _models(found):
    if found['quick']:
        return ', on the models of data/ alone'
    return ', without the models %s' % ', '.join(found['missing_models']) if found['missing_models'] else ''


def machine_words(found):
    return '%(cores)d cores, %(architecture)s, %(system)s' % found['machine']
