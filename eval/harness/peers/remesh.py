"""This project's own program, run by its command line like any other."""

import json
import os
import subprocess

from ..context import Context

LABEL = 'remesh'
SETTINGS = '`--points N`, nothing else'
BY_PIP = False
COUNTS = True
BINARY = Context.binary

# Stages of the report that do not count as remeshing.
APART = ('read', 'measure', 'write')


def missing():
    return None if os.path.isfile(BINARY) else 'not built: cargo build --release'


def version():
    return subprocess.run([BINARY, '--version'], capture_output=True, text=True, check=True).stdout.strip()


def command(source, target, wanted, _sharp, options=()):
    """Returns the command. The program finds sharp edges itself."""
    return [BINARY, source, target, '--points', str(wanted), '--quiet', '--report', target + '.json', *options]


def seconds(_output, target):
    with open(target + '.json', encoding='utf-8') as f:
        return sum(stage['seconds'] for stage in json.load(f)['stages'] if stage['name'] not in APART)
