"""Runs a program and measures its time and memory: `python -I -S launch.py PIPE TIMEOUT PROGRAM WORDS...`.

This is a separate, small process, because the system counts the memory of the process that starts a program as the
program's own: the harness uses much memory, this process about 10 MB. Writes `status seconds maxrss` to the descriptor
PIPE.
"""

import os
import signal
import sys
import time


def main():
    pipe, timeout, program = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
    # Processes left behind by the program must not keep the pipe open, and the program must not outlive the
    # harness.
    os.set_inheritable(pipe, False)
    parent = os.getppid()
    start = time.perf_counter()
    # A separate process group, so that processes started by the program can be ended with it.
    pid = os.posix_spawn(program, sys.argv[3:], os.environ, setpgroup=0)
    done = 0
    while not done:
        late = time.perf_counter() - start > timeout or os.getppid() != parent
        if late:
            os.killpg(pid, signal.SIGKILL)
        done, status, usage = os.wait4(pid, 0 if late else os.WNOHANG)
        seconds = time.perf_counter() - start
        if not done:
            time.sleep(0.002)
    # A program that ended in time does not count as late.
    late = late and os.WIFSIGNALED(status)
    os.write(pipe, b'late' if late else b'%d %r %d' % (status, seconds, usage.ru_maxrss))


if __name__ == '__main__':
    main()
