"""The command ``remesh``, also run by ``python -m spectral_remesh``."""

from __future__ import annotations

import sys

from . import _native


def main() -> int:
    """Runs the command with the arguments of the process, and returns its exit status."""
    return _native.main(["remesh", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
