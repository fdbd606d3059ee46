"""Tests running programs, comparing runs, and tuning counts."""

import contextlib
import io
import os
import sys
import tempfile
import time
import unittest

import numpy as np

from harness import compare, mesh, process, race, readme, results, tables, verdicts
from harness.context import ROOT, Case, Context, cases_at_hand
from harness.experiments import cad, remeshers
from harness.verdicts import faults_of


class Process(unittest.TestCase):
    def test_time_and_output(self):
        ran = process.run([sys.executable, '-c', 'import time; time.sleep(0.2); print("said")'])
        self.assertEqual(ran.output, 'said\n')
        self.assertTrue(0.2 <= ran.seconds < 2, ran.seconds)

    def test_memory_is_that_of_the_program(self):
        """The measured memory is the program's own, not that of the harness, which uses far more."""
        held = bytearray(300_000_000)
        held[::4096] = b'x' * len(held[::4096])
        small = process.run([sys.executable, '-c', 'pass']).megabytes
        large = process.run([sys.executable, '-c', 'held = b"x" * int("100000000")']).megabytes
        self.assertLess(small, 50)
        self.assertTrue(90 < large - small < 130, (small, large))

    def test_what_takes_too_long_is_ended(self):
        with self.assertRaisesRegex(process.Failed, 'not done after 0.3 s'):
            process.run([sys.executable, '-c', 'import time; time.sleep(60)'], timeout=0.3)

    def test_refusals_and_crashes_are_told_apart(self):
        with self.assertRaisesRegex(process.Failed, 'exit status 3: no'):
            process.run([sys.executable, '-c', 'import sys; sys.exit(print("no", file=sys.stderr) or 3)'])
        with self.assertRaisesRegex(process.Failed, 'signal 6'):
            process.run([sys.executable, '-c', 'import os; os.abort()'])
        with self.assertRaisesRegex(process.Failed, 'no program'):
            process.run(['/no/such/program'])


class Grid:
    """A remesher that makes a flat grid with a share of the requested vertices, and records the requests."""
    COUNTS = False

    def __init__(self, share, script=''):
        self.share, self.script, self.asked = share, script, []

    def command(self, _source, target, asked, _sharp):
        self.asked.append(asked)
        return [sys.executable, '-c', self.script + GRID, target, str(max(4, round(self.share * asked)))]

    def seconds(self, output, _target):
        return float(output)


GRID = """
import sys
import numpy as np
from harness import mesh
count = int(sys.argv[2]) // 2
places = np.stack(np.meshgrid(np.arange(count), [0, 1, 2]), axis=-1).reshape(-1, 2)[:2 * count]
row = np.arange(count - 1)
faces = np.concatenate([np.stack([row, row + 1, row + count], 1), np.stack([row + 1, row + count + 1, row + count], 1)])
mesh.write(sys.argv[1], mesh.Mesh(np.column_stack([places, np.zeros(len(places))]), faces))
print(0.25)
"""


class Race(unittest.TestCase):
    def results(self, other, rounds=2, budget=60):
        """Runs one race against `other`, in which ours is a program that meets the count."""
        reference = mesh.Mesh(np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0.0]]), np.array([[0, 1, 2]]))
        with tempfile.TemporaryDirectory() as scratch:
            programs = {'remesh': Grid(1), 'other': other}
            return race.race(programs, 'no source', reference, 400, False, rounds, scratch, budget)

    def test_counts_are_tuned(self):
        other = Grid(0.8)
        found = self.results(other)['other']
        self.assertEqual(found['vertices'], 400)
        self.assertEqual(other.asked, [400, 500, 500])
        self.assertEqual(len(found['seconds']), 2)
        self.assertEqual(len(found['our_process_seconds']), 2)

    def test_given_counts_are_left_alone(self):
        other = Grid(0.8)
        other.COUNTS = True
        found = self.results(other)['other']
        self.assertEqual(other.asked, [400, 400])
        self.assertAlmostEqual(found['off'], -0.2)
        self.assertIn('more than 3 % off the count', faults_of(found))

    def test_what_tells_no_time_is_a_result(self):
        class Silent(Grid):
            def seconds(self, output, target):
                return output.splitlines()[99]

        self.assertIn('told no time', self.results(Silent(1))['other']['failed'])

    def test_without_time_left_each_is_timed_once(self):
        found = self.results(Grid(1), rounds=5, budget=0)
        self.assertEqual([len(result['seconds']) for result in found.values()], [1, 1])
        self.assertTrue(all('measures' in result for result in found.values()))

    def test_a_crash_is_a_result(self):
        found = self.results(Grid(1, 'import os; os.abort()'))
        self.assertIn('signal 6', found['other']['failed'])
        self.assertIn('measures', found['remesh'])

    def test_a_crash_of_ours_is_not_the_peers(self):
        reference = mesh.Mesh(np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0.0]]), np.array([[0, 1, 2]]))
        with tempfile.TemporaryDirectory() as scratch:
            programs = {'remesh': Grid(1, 'raise SystemExit(1)'), 'other': Grid(1)}
            found = race.race(programs, 'no source', reference, 400, False, 1, scratch)
        self.assertIn('failed', found['remesh'])
        self.assertIn('measures', found['other'])
        self.assertEqual(race.ratios(found['other']), [])

    def test_no_file_is_a_result(self):
        found = self.results(Grid(1, 'raise SystemExit'))
        self.assertEqual(found['other'], {'failed': 'wrote no result'})


class Words(unittest.TestCase):
    """Tables and verdicts are computed from figures; here, from made-up ones."""

    def result(self, **changed):
        shape = {'theta_min': 40.0, 'theta_min_mean': 57.0, 'theta_max': 90.0, 'q_min': 0.7, 'q_mean': 0.97,
                 'percent_below_30': 0.0, 'percent_above_90': 0.0, 'edge_cv': 0.09}
        topology = {'percent_valence_6': 95.0, 'nonmanifold_edges': 0, 'nonmanifold_vertices': 0,
                    'misoriented_edges': 0, 'degenerate_faces': 0}
        measures = {'shape': shape | changed, 'topology': topology, 'crossing_faces': 0, 'same_topology': True,
                    'inside_out': False, 'distance': {'rms': 0.02, 'hausdorff': 0.4}}
        return {'vertices': 400, 'off': 0.0, 'measures': measures, 'megabytes': 20.0, 'seconds': [1.0, 2.0, 1.5],
                'process_seconds': [2.0, 3.0, 2.5], 'our_seconds': [1.0, 1.0, 1.0],
                'our_process_seconds': [1.0, 1.0, 1.0]}

    def raw(self):
        fast = self.result(theta_min=30.0, edge_cv=0.07) | {'seconds': [0.5, 0.4, 0.6], 'off': 0.05}
        results = {'remesh': self.result(), 'meshlab': fast, 'cgal': {'failed': 'signal 11: no message'}}
        programs = {name: {'label': name, 'version': '1', 'settings': 'none'} for name in results}
        programs['geogram'] = {'label': 'geogram', 'settings': 'none', 'missing': 'not on the path'}
        models = {'ball': {'points': 400, 'sharp': False, 'results': results}}
        return {'programs': programs, 'models': models, 'not_at_hand': [], 'rounds': 3}

    def test_report(self):
        text = remeshers.report(self.raw(), None)
        self.assertIn('| geogram | **missing**: not on the path | none |', text)
        self.assertIn('Failed: cgal on ball (signal 11: no message).', text)
        self.assertIn('**meshlab** (1 of 1 models): ours is better in θmin on all. Ours is worse in variation of edges '
                      'on all. It takes 0.5 times as long as ours; shorter in every pair of runs on all. '
                      'Its faults: more than 3 % off the count (ball).', text)
        self.assertIn('**cgal** (0 of 1 models): nothing to compare. Its faults: signal 11: no message (ball).', text)

    def cad_raw(self):
        """Three parts: on two, one program is worse in angles and better in edges; on the third, it is equally good."""
        raw = self.raw()
        edges = {'sharp_edges': {'rms': 0.1, 'largest': 0.4}}
        own = self.result()
        own['measures'] |= edges
        other = self.result(theta_min=10.0)
        other['measures'] |= {'sharp_edges': {'rms': 0.0, 'largest': 0.0}}
        results = {'remesh': own, 'meshlab': other, 'cgal': {'failed': 'signal 11: no message'}}
        sound = {'vertices': 90, 'manifold': True, 'crossing_faces': 0}
        models = {'plate': {'results': results, 'input': sound},
                  'bolt': {'results': results, 'input': sound | {'manifold': False, 'crossing_faces': 7}},
                  'nut': {'results': results | {'meshlab': own}, 'input': sound}}
        return raw | {'models': {n: m | {'points': 400, 'sharp': True} for n, m in models.items()}, 'points': 400}

    def test_cad_report(self):
        text = cad.report(self.cad_raw(), None)
        self.assertIn('so that another topology is no fault of a program: bolt.', text)
        self.assertIn('Faces that cross in the input: bolt (7).', text)
        self.assertIn('| meshlab | 0.000 / 0.00 | 0.000 / 0.00 | 0.100 / 0.40 |', text)
        self.assertIn('Failed: cgal on plate (signal 11: no message)', text)
        head, row = (next(line.split(' | ') for line in text.splitlines() if line.startswith(start))
                     for start in ('| parts on which', '| meshlab, of 3'))
        self.assertEqual(row[head.index('θmin')], '2 : 0')
        self.assertEqual(row[head.index('RMS distance of sharp edges')], '0 : 2')
        self.assertEqual(row[head.index('Qave')], '0 : 0')
        self.assertIn('- **meshlab** (3 of 3 models): on most ours is better in θmin, and worse in RMS distance of sharp '
                      'edges. Neither on most in mean θmin,', text)
        self.assertIn('- **cgal** (0 of 3 models): nothing to compare.', text)

    def test_half_of_the_models_are_not_most(self):
        models = self.cad_raw()['models']
        both = {name: models[name]['results'] for name in ('plate', 'nut')}
        self.assertIn('ours is better in nothing, and worse in nothing.', verdicts.mostly('any', both, 'meshlab'))

    def found(self):
        machine = {'cores': 2, 'architecture': 'any', 'system': 'any'}
        return {'versions': {'remesh': '1'}, 'date': 'today', 'command': 'eval/run', 'machine': machine,
                'experiments': {'remeshers': self.raw(), 'clouds': {'failed': 'no reason'}}}

    def test_best_of_the_others(self):
        text = readme.section(self.found())
        self.assertIn('| **θmin, remesh** | **40.0** |\n| best of the others | 30.0† meshlab |', text)
        self.assertIn('| **seconds, remesh** | **1.50** |\n| best of the others | 0.50† meshlab |', text)

    def test_short_table(self):
        text = readme.short_section(self.found())
        self.assertRegex(text, r'\| ball \| 400 \| \*\*40\.0\*\* \| 30\.0† meshlab \|.*'
                               r'\| \*\*1\.50\*\* \| 0\.50† meshlab \|')
        none = self.found() | {'experiments': {}}
        self.assertNotIn('|', readme.short_section(none))

    def test_only_what_is_between_the_markers_changes(self):
        page = 'above\n%s\nold\n%s\nbelow\n'
        new = readme.between_markers(page % (readme.BEGIN, readme.END), 'new', 'page')
        self.assertEqual(new, 'above\n%s\nnew\n%s\nbelow\n' % (readme.BEGIN, readme.END))
        for wrong in ['none', page % (readme.END, readme.BEGIN)]:
            with self.assertRaisesRegex(SystemExit, 'page needs one'):
                readme.between_markers(wrong, 'new', 'page')


def figures(context):
    return {'seed': context.seed}


def raises(_context):
    raise ValueError('no reason')


def crashes(_context):
    os.abort()


def hangs(context):
    """Hangs in a program that it starts."""
    process.run([sys.executable, '-c', 'import os, time; print(os.getpid(), file=open(%r, "w")); time.sleep(60)'
                 % context.file('pid')])


class Alone(unittest.TestCase):
    def result(self, measure, limit=60, look=lambda scratch: None):
        with tempfile.TemporaryDirectory() as scratch:
            raw = results.alone(measure, Context([], scratch, scratch), limit)
            look(scratch)
            return raw

    def test_figures_come_back(self):
        self.assertEqual(self.result(figures), {'seed': 0})

    def test_errors_and_crashes_are_results(self):
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(self.result(raises), {'failed': 'ValueError: no reason'})
        self.assertEqual(self.result(crashes), {'failed': 'ended with status -6'})

    def test_what_hangs_is_ended_with_all_that_it_started(self):
        def look(scratch):
            with open(os.path.join(scratch, 'pid'), encoding='utf-8') as f:
                pid = int(f.read())
            for _ in range(100):
                try:
                    os.kill(pid, 0)
                except ProcessLookupError:
                    return
                time.sleep(0.05)
            self.fail('the program goes on')

        self.assertEqual(self.result(hangs, 3, look), {'failed': 'not done after 3 s'})


class Cases(unittest.TestCase):
    def test_some_are_for_one_experiment(self):
        """The listed CAD parts are used by `cad` only; `cad` also uses the sharp models of all experiments."""
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, 'real'))
            part, scan = os.path.join(folder, 'real', 'cgal__anchor.off'), os.path.join(folder, 'horse.ply')
            for path in (part, scan):
                with open(path, 'w', encoding='utf-8'):
                    pass
            cases, missing = cases_at_hand(folder)
        named = {case.name: case for case in cases}
        self.assertEqual(named['anchor'], Case('anchor', part, 5000, True, 'cad'))
        self.assertEqual(named['horse'], Case('horse', scan, 8600))
        self.assertIn('block', missing)
        self.assertNotIn('anchor', [case.name for case in results.cases_for('cases', cases)])
        self.assertIn('horse', [case.name for case in results.cases_for('cases', cases)])
        sharp = {case.name for case in results.cases_for('cad', cases) if case.sharp}
        self.assertEqual(sharp, {'anchor', 'bracket'})


class Into(unittest.TestCase):
    """Figures of some experiments replace those of an earlier run."""

    def run_of(self, date, **experiments):
        return {'schema': results.SCHEMA, 'date': date, 'command': 'eval/run', 'quick': False, 'seed': 0,
                'versions': {'remesh': date, 'commit': 'c' + date}, 'machine': {'cores': 2, 'architecture': 'a',
                'system': 's'}, 'missing_models': [], 'seconds': dict.fromkeys(experiments, 60.0),
                'experiments': experiments}

    def test_only_those_change_and_say_when(self):
        whole = self.run_of('monday', table1={'failed': 'old'}, cases={'failed': 'old'})
        later = self.run_of('friday', table1={'failed': 'new'}, cad={'failed': 'new'})
        found = results.joined(whole, later)
        self.assertEqual(found['date'], 'monday')
        self.assertEqual([(name, raw['failed']) for name, raw in found['experiments'].items()],
                         [('cases', 'old'), ('cad', 'new'), ('table1', 'new')])
        with tempfile.TemporaryDirectory() as folder:
            results.report(found, folder)
            with open(os.path.join(folder, 'RESULTS.md'), encoding='utf-8') as f:
                text = f.read()
        self.assertIn('## All models\n\nFailed: old', text)
        self.assertIn('## CAD parts\n\nNot of the same run as the rest. Measured on friday by `eval/run`. remesh friday '
                      '(cfriday), seed 0. Machine: 2 cores, a, s.\n\nFailed: new', text)

    def test_the_last_one_counts(self):
        whole = self.run_of('monday', cases={'failed': 'old'})
        for date in ('friday', 'sunday'):
            whole = results.joined(whole, self.run_of(date, cad={'figure': date}))
        self.assertEqual(whole['experiments']['cad'], {'figure': 'sunday'})
        self.assertEqual({name: made['date'] for name, made in whole['apart'].items()}, {'cad': 'sunday'})


class Compare(unittest.TestCase):
    def test_beyond_noise(self):
        found = compare.Changes()
        for new in (1.0, 1.09, 1.2, 0.8):
            compare._sort(found, 'Q %g' % new, (1.0, 1, 0.1), (new, 1, 0.1))
        self.assertEqual(found.same, 2)
        self.assertEqual(found.better, ['Q 1.2: 1.2, was 1'])
        self.assertEqual(found.worse, ['Q 0.8: 0.8, was 1'])

    def test_less_is_better_where_it_is(self):
        found = compare.Changes()
        compare._sort(found, 'seconds', (1.0, -1, 0.1), (2.0, -1, 0.1))
        self.assertEqual(found.worse, ['seconds: 2, was 1'])


class Tables(unittest.TestCase):
    def test_spread(self):
        self.assertEqual(tables.spread([3, 1, 2]), '2.00 (1.00..3.00)')
        self.assertEqual(tables.spread([1, 2]), '1.50 (1.00..2.00)')
        self.assertEqual(tables.spread([None]), '-')

    def test_failures_are_faults(self):
        self.assertEqual(faults_of({'failed': 'not done after 60 s'}), ['not done after 60 s'])

    def test_ratio_of_pairs(self):
        result = {'seconds': [2, 6], 'our_seconds': [1, 2]}
        self.assertEqual(race.ratios(result), [2, 3])
        untold = {'seconds': [None], 'process_seconds': [3], 'our_process_seconds': [2]}
        self.assertEqual(race.ratios(untold), [1.5])


if __name__ == '__main__':
    unittest.main()
