"""This project's own program restricted to the paper's method: samples by scan and ascent, joined, not optimised."""

from . import remesh
from .remesh import BY_PIP, COUNTS, missing, seconds, version  # noqa: F401

LABEL = 'remesh --optimize 0'
SETTINGS = "`--points N --optimize 0`: the paper's samples as the ascent leaves them"


def command(source, target, wanted, sharp):
    return remesh.command(source, target, wanted, sharp, ['--optimize', '0'])
