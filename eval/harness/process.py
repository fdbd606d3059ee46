"""Runs a program to its end, and measures its time and memory."""

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass

LAUNCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'launch.py')


class Failed(Exception):
    """A program crashed, refused or exceeded its time limit; the message says which."""


@dataclass(frozen=True)
class Ran:
    """Wall-clock seconds of the whole process, its peak resident memory in megabytes, and its standard output."""
    seconds: float
    megabytes: float
    output: str


def run(command, timeout=600, may_exit=(0,), environment=None):
    """Runs `command` (a list of words) for at most `timeout` seconds. Raises `Failed`."""
    program = shutil.which(command[0])
    if program is None:
        raise Failed('no program %s' % command[0])
    reading, writing = os.pipe()
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as printed, os.fdopen(reading) as told:
        words = [sys.executable, '-I', '-S', LAUNCH, str(writing), str(timeout), program, *command[1:]]
        # The launcher has a separate process group, so that it can end the program when the harness is ended.
        process = subprocess.Popen(words, stdout=printed, stderr=said, env=environment, pass_fds=[writing],
                                   process_group=0)
        os.close(writing)
        process.wait()
        took = told.read().split()
        said.seek(0)
        printed.seek(0)
        lines = said.read().decode(errors='replace').strip().splitlines()
        output = printed.read().decode(errors='replace')
    if took == ['late']:
        raise Failed('not done after %g s' % timeout)
    code = os.waitstatus_to_exitcode(int(took[0])) if took else process.returncode
    if code not in may_exit:
        what = 'signal %d' % -code if code < 0 else 'exit status %d' % code
        raise Failed('%s: %s' % (what, lines[-1] if lines else 'no message'))
    return Ran(float(took[1]), int(took[2]) / (1e6 if sys.platform == 'darwin' else 1e6 / 1024), output)
