"""Samples and meshes clouds of any size on many machines, with Dask.

The machines share a folder, which may be in an object store. As with the command ``remesh tiles``, its files are the
interface. If a tile of samples or a piece of the mesh fails, or its worker dies, another worker makes it again. The result has
the same bytes for any number of tiles and workers.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._folders import Folder, shared

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["mesh", "sample"]

#: The command of this package in the current Python environment.
COMMAND = (sys.executable, "-m", "spectral_remesh")


def sample(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    folder: str | os.PathLike[str],
    client: Client | None = None,
    tiles: int = 16,
    retries: int = 3,
    progress: Callable[[float], object] | None = None,
    command: Sequence[str] = COMMAND,
    **options: Any,
) -> None:
    """Samples the cloud in the file ``source`` into the file ``target``.

    ``folder`` is a path that is the same on all workers, or an address that fsspec knows on all of them, such as
    ``s3://bucket/work``. With an address, each worker copies the files it needs to its own temporary directory. The files in
    the folder are kept. ``client`` is the client of a Dask cluster, by default a local one with a process per core. There are
    at least ``tiles`` tiles, if the cloud allows as many. A failed tile is retried ``retries`` times. ``progress`` is called
    with the completed share. ``command`` is the command with which workers call the program. ``options`` are those of
    ``remesh tiles plan``: ``points=300000``, ``smooth=2``, ``scan_only=True``, ``memory="2G"``.

    Raises ``RuntimeError`` with the error message of the program if one of its steps fails, and ``ImportError`` without
    ``dask[distributed]``.
    """
    place = shared(folder)
    with place.at_home() as home:
        said = _plan(command, source, home, tiles, options)
        place.planned(home)
        _run_rounds([("sample", range(int(said[0])))], place, client, retries, progress, command)
        place.done(home)
        _run(command, "merge", home, target)


def mesh(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    folder: str | os.PathLike[str],
    client: Client | None = None,
    tiles: int = 16,
    retries: int = 3,
    progress: Callable[[float], object] | None = None,
    command: Sequence[str] = COMMAND,
    **options: Any,
) -> None:
    """Meshes the cloud in the file ``source`` into the file ``target``.

    The arguments and errors are those of :func:`sample`. ``RuntimeError`` is also raised if the written mesh is not sound.
    """
    place = shared(folder)
    with place.at_home() as home:
        said = _plan(command, source, home, tiles, options)
        place.planned(home)
        # The words after "mesh" are the first and the last piece of each round.
        ends = [map(int, word.split("-")) for word in said[said.index("mesh") + 1 :]]
        rounds = [("sample", range(int(said[0])))] + [("mesh", range(first, last + 1)) for first, last in ends]
        _run_rounds(rounds, place, client, retries, progress, command)
        place.done(home)
        _run(command, "merge", home, target, "--mesh")


def _plan(
    command: Sequence[str],
    source: str | os.PathLike[str],
    folder: str | os.PathLike[str],
    tiles: int,
    options: dict[str, Any],
) -> list[str]:
    """Makes a plan, and returns the words that the program prints about it."""
    words = [word for name, value in options.items() for word in _flag(name, value)]
    return _run(command, "plan", source, folder, "--tiles", tiles, *words).split()


def _run_rounds(
    rounds: Sequence[tuple[str, range]],
    place: Folder,
    client: Client | None,
    retries: int,
    progress: Callable[[float], object] | None,
    command: Sequence[str],
) -> None:
    """Runs the step of each number, one round after the other. Each uses one thread, since there is a worker per core."""
    from distributed import Client, as_completed

    own = Client(threads_per_worker=1) if client is None else None
    done, all_of_them = 0, sum(len(numbers) for _, numbers in rounds)
    try:
        cluster = own or client
        assert cluster is not None
        for step, numbers in rounds:
            work = functools.partial(_do, command, step, place)
            for future in as_completed(cluster.map(work, numbers, retries=retries, pure=False)):
                future.result()
                done += 1
                if progress is not None:
                    progress(done / all_of_them)
        place.leave(cluster)
    finally:
        if own is not None:
            own.close()


def _do(command: Sequence[str], step: str, place: Folder, number: int) -> None:
    with place.at_work(step, number) as folder:
        _run(command, step, folder, number, "--threads", 1)


def _flag(name: str, value: object) -> list[str]:
    flag = "--" + name.replace("_", "-")
    if isinstance(value, bool):
        return [flag] if value else []
    return [flag, str(value)]


def _run(command: Sequence[str], step: str, *words: object) -> str:
    """Runs a step of the program and returns its output. If it fails, the error has what it printed on standard error."""
    paths = (str(Path(word)) if isinstance(word, os.PathLike) else str(word) for word in words)
    ran = subprocess.run([*command, "tiles", step, *paths], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        raise RuntimeError(ran.stderr.strip() or f"remesh tiles {step} ended with status {ran.returncode}")
    return ran.stdout
