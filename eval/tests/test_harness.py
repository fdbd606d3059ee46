"""Running programs, comparing runs, and tuning counts."""

import sys
import unittest

from harness import compare, process, race, tables
from harness.verdicts import faults_of


class Process(unittest.TestCase):
    def test_time_and_output(self):
        ran = process.run([sys.executable, '-c', 'import time; time.sleep(0.2); print("said")'])
        self.assertEqual(ran.output, 'said\n')
        self.assertTrue(0.2 <= ran.seconds < 2, ran.seconds)

    def test_memory_is_that_of_the_program(self):
        """Not that of the harness, which has far more; and what the program takes is seen."""
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
