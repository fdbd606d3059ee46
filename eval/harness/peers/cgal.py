"""CGAL's isotropic remeshing, through the program that `eval/setup` builds from eval/peers/cgal.cpp."""

import os

from .. import process
from ..context import EVAL
from . import last_json

LABEL = 'CGAL'
SETTINGS = '`isotropic_remeshing`, 10 iterations, edge length tuned to the count; CAD parts with edges of 60 degrees ' \
    'split and protected, as its manual asks'
BY_PIP = False
COUNTS = False
BINARY = os.path.join(EVAL, '.built', 'cgal')


def missing():
    return None if os.path.isfile(BINARY) else 'not built: g++ or libcgal-dev was not there for eval/setup'


def version():
    return 'CGAL ' + process.run([BINARY, '--version']).output.strip()


def command(source, target, wanted, sharp):
    words = [BINARY, source, target, str(wanted)]
    return words + ['sharp'] if sharp else words


def seconds(output, _target):
    return last_json(output)['seconds']
