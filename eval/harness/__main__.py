"""The command line: `eval/run`."""

import argparse
import importlib
import json
import os
import sys
import tempfile

from .context import EVAL, Context, cases_at_hand
from .experiments import NAMES


def main():
    arguments = argparse.ArgumentParser(prog='eval/run', description=__doc__)
    arguments.add_argument('--models', metavar='FOLDER', help='where the models of eval/cases.json are')
    arguments.add_argument('--only', metavar='NAME,NAME', help='only these experiments: %s' % ', '.join(NAMES))
    arguments.add_argument('--quick', action='store_true', help="a minute's part of everything")
    options = arguments.parse_args()
    names = options.only.split(',') if options.only else NAMES
    cases, missing = cases_at_hand(options.models)
    for name in missing:
        sys.stderr.write('%s is left out: its model is not there (--models FOLDER)\n' % name)
    figures = os.path.join(EVAL, 'figures')
    os.makedirs(figures, exist_ok=True)
    for name in names:
        experiment = importlib.import_module('.experiments.' + name, __package__)
        with tempfile.TemporaryDirectory() as scratch:
            raw = experiment.run(Context(cases, scratch, options.quick))
        # What is reported is what would be read back.
        print('## %s\n\n%s' % (experiment.TITLE, experiment.report(json.loads(json.dumps(raw)), figures)))


if __name__ == '__main__':
    main()
