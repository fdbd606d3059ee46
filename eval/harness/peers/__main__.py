"""Runs a remesher that is a Python package: `python -m harness.peers NAME SOURCE TARGET WANTED [sharp]`.

Prints the seconds of remeshing alone as JSON, excluding the start of Python, reading and writing.
"""

import importlib
import json
import sys
import time


def main():
    name, source, target, wanted, *rest = sys.argv[1:]
    module = importlib.import_module('harness.peers.' + name)
    given = module.load(source)
    start = time.perf_counter()
    result = module.remesh(given, int(wanted), rest == ['sharp'])
    seconds = time.perf_counter() - start
    module.save(result, target)
    print(json.dumps({'seconds': seconds}))


if __name__ == '__main__':
    main()
