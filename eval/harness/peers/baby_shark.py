"""The Rust crate baby_shark, through the program that `eval/setup` builds from eval/peers/baby_shark."""

import os

from .. import process
from ..context import EVAL
from . import last_json

LABEL = 'baby_shark'
SETTINGS = '`IncrementalRemesher`, 10 iterations (its default), in f64, edge length tuned to the count'
BY_PIP = False
COUNTS = False
BINARY = os.path.join(EVAL, '.built', 'baby_shark')


def missing():
    return None if os.path.isfile(BINARY) else 'not built: eval/setup builds it with cargo'


def version():
    return 'baby_shark ' + process.run([BINARY, '--version']).output.strip()


def command(source, target, wanted, _sharp):
    return [BINARY, source, target, str(wanted)]


def seconds(output, _target):
    return last_json(output)['seconds']
