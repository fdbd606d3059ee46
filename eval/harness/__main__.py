"""The command line: `eval/run`."""

import argparse
import os
import signal
import sys
import tempfile
import unittest

from . import compare, gallery, readme, results
from .context import EVAL
from .experiments import NAMES


def main():
    words = sys.argv[1:]
    options = _arguments().parse_args(words if words and words[0] in (*COMMANDS, '-h', '--help') else ['run'] + words)
    sys.exit(COMMANDS[options.command](options))


def _arguments():
    arguments = argparse.ArgumentParser(prog='eval/run', description="The paper's experiments and the comparison with "
                                        'other remeshers. Without a command it runs all of it; `eval/run run --help` '
                                        'has the options of that.')
    commands = arguments.add_subparsers(dest='command', required=True)
    run = commands.add_parser('run', help='measure, write the figures as JSON and RESULTS.md from them')
    run.add_argument('--models', metavar='FOLDER', help='where the models of eval/cases.json are')
    run.add_argument('--only', metavar='NAME,NAME', help='only these experiments: %s' % ', '.join(NAMES))
    run.add_argument('--quick', action='store_true', help="a minute's part of everything, on data/ alone")
    run.add_argument('--out', metavar='F.json', help='where the figures go (default: %s for a whole run, else %s); '
                     'RESULTS.md and its pictures go beside it' % (_short(results.LATEST), _short(results.PARTIAL)))
    run.add_argument('--into', metavar='F.json', help='put the figures of --only into those of an earlier run, such '
                     'as %s, in place of its own, and write its RESULTS.md again' % _short(results.LATEST))
    report = commands.add_parser('report', help='write RESULTS.md and its plots again from figures')
    report.add_argument('file', nargs='?', default=results.LATEST)
    two = commands.add_parser('compare', help='what got better and worse between two files; exit status 1 if worse')
    two.add_argument('before')
    two.add_argument('after')
    table = commands.add_parser('readme', help='write the tables of README.md and docs/figures.md')
    table.add_argument('file', nargs='?', default=results.LATEST)
    commands.add_parser('gallery', help='draw the pictures of docs/gallery.md again')
    commands.add_parser('test', help='test the measures and the experiments, against `remesh quality` and MeshLab, too')
    return arguments


def _short(path):
    return os.path.relpath(path, os.path.dirname(EVAL))


def _run(options):
    names = options.only.split(',') if options.only else NAMES
    unknown = sorted(set(names) - set(NAMES))
    if unknown:
        sys.exit('eval/run: no experiment is called %s' % ', '.join(unknown))
    if options.into and (options.out or options.quick or not options.only):
        sys.exit('eval/run: --into goes with --only, and neither with --quick nor with --out')
    whole = results.load(options.into) if options.into else None
    # A run that is ended from outside also ends the processes that it started.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit('eval/run: ended; `eval/run report` shows what was done'))
    all_of_it = not options.only and not options.quick
    out = options.into or options.out or (results.LATEST if all_of_it else results.PARTIAL)
    found = results.run(names, options.models, options.quick, out, results.command_line(options), whole)
    _report(out)
    committed = results.committed()
    if committed:
        print(compare.text(committed, found, 'the last committed run', 'this one'))
    return 1 if any('failed' in raw for raw in found['experiments'].values()) else 0


def _report(path):
    print('wrote %s' % _short(results.report(results.load(path), results.folder_of(path))))
    return 0


def _compare(options):
    before, after = results.load(options.before), results.load(options.after)
    print(compare.text(before, after, options.before, options.after))
    return 1 if compare.changes(before, after).worse else 0


def _readme(options):
    readme.rewrite(results.load(options.file))
    return 0


def _gallery(_options):
    with tempfile.TemporaryDirectory() as scratch:
        for path in gallery.draw(scratch):
            print('wrote %s' % _short(path))
    return 0


def _test(_options):
    suite = unittest.defaultTestLoader.discover(os.path.join(EVAL, 'tests'), top_level_dir=EVAL)
    return 0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1


COMMANDS = {'run': _run, 'report': lambda options: _report(options.file), 'compare': _compare, 'readme': _readme,
            'gallery': _gallery, 'test': _test}

if __name__ == '__main__':
    main()
