"""Clouds of any size, sampled and meshed on many machines by Dask.

Machines share a folder; its files are the interface, as for the command ``remesh tiles``. It may be in an object store. A tile
that fails, or whose worker dies, is sampled again by another one, and so are pieces of the mesh. The result has the same bytes
for any number of tiles and workers.
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

#: The command of this package, wherever it runs.
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

    ``folder`` is one that all workers have under this name, or an address that fsspec knows on all of them, such as
    ``s3://bucket/work``: then each has a copy of what it needs in its own temporary directory. What is in it stays. ``client`` is
    that of a Dask cluster, a local one of as many processes as there are cores without. There are at least ``tiles`` tiles, if
    there can be as many. A tile that fails is tried ``retries`` times more. ``progress`` is called with the share that is done.
    ``command`` is how workers call the program. ``options`` are those of ``remesh tiles plan``: ``points=300000``, ``smooth=2``,
    ``scan_only=True``, ``memory="2G"``.

    Raises ``RuntimeError`` with what the program said if a step of it fails, and ``ImportError`` without
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
    """Makes a mesh of the cloud in the file ``source``, and writes it as ``target``.

    The arguments and errors are those of :func:`sample`. ``RuntimeError`` is also raised for a mesh that is written, but not
    sound.
    """
    place = shared(folder)
    with place.at_home() as home:
        said = _plan(command, source, home, tiles, options)
        place.planned(home)
        # The last words are the first and the last number of each round.
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
    """Makes a plan; the words that the program prints of it."""
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
    """Does a step for each number, one round after the other, on one thread each: there is a worker for each core."""
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
    """What the program prints in a step. If it fails, the last line says what is wrong."""
    paths = (str(Path(word)) if isinstance(word, os.PathLike) else str(word) for word in words)
    ran = subprocess.run([*command, "tiles", step, *paths], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        raise RuntimeError(ran.stderr.strip() or f"remesh tiles {step} ended with status {ran.returncode}")
    return ran.stdout
