"""Running a program to its end, with its time and memory."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass


class Failed(Exception):
    """A program that crashed, refused or ran out of its time; the message says which."""


@dataclass(frozen=True)
class Ran:
    """Wall seconds of the whole process, its most resident memory in megabytes, and what it wrote."""
    seconds: float
    megabytes: float
    output: str


def run(command, timeout=None, may_exit=(0,), environment=None):
    """Runs `command` (a list of words) for at most `timeout` seconds. Raises `Failed`."""
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as printed:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=printed, stderr=said, env=environment, start_new_session=True)
        code, usage = _wait(process, start, timeout)
        seconds = time.perf_counter() - start
        said.seek(0)
        printed.seek(0)
        lines = said.read().decode(errors='replace').strip().splitlines()
        output = printed.read().decode(errors='replace')
    if code not in may_exit:
        what = 'signal %d' % -code if code < 0 else 'exit status %d' % code
        raise Failed('%s: %s' % (what, lines[-1] if lines else 'no message'))
    return Ran(seconds, usage.ru_maxrss / (1e6 if sys.platform == 'darwin' else 1e6 / 1024), output)


def _wait(process, start, timeout):
    """Exit status and resources used; the whole group is killed when its time is over."""
    while True:
        pid, status, usage = os.wait4(process.pid, 0 if timeout is None else os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage
        if time.perf_counter() - start > timeout:
            os.killpg(process.pid, signal.SIGKILL)
            os.wait4(process.pid, 0)
            process.returncode = -signal.SIGKILL
            raise Failed('not done after %d s' % timeout)
        time.sleep(0.002)
