"""The folder that machines share, at the same path on all of them or in an object store."""

from __future__ import annotations

import os
import shutil
import tempfile
import threading
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from distributed import Client, Worker

#: Prefix of the names of files that the program has not completed.
UNFINISHED = ".remesh-"

#: Prefix of the names of the files that each step of a plan writes.
OF_STEP = {"sample": "tile-", "mesh": "piece-"}


class Folder:
    """A folder at the same path on all machines."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path

    @contextmanager
    def at_home(self) -> Iterator[str | os.PathLike[str]]:
        """Yields the folder in which the plan is made and the result merged."""
        yield self.path

    def planned(self, home: str | os.PathLike[str]) -> None:
        """Makes the plan in ``home`` available to all machines."""

    @contextmanager
    def at_work(self, step: str, number: int) -> Iterator[str | os.PathLike[str]]:
        """Yields the folder in which a worker does a step."""
        yield self.path

    def done(self, home: str | os.PathLike[str]) -> None:
        """Copies the output of all workers to ``home``, and removes the unfinished files of workers that died."""
        for unfinished in Path(self.path).glob(f"{UNFINISHED}*"):
            unfinished.unlink(missing_ok=True)

    def leave(self, client: Client) -> None:
        """Removes the files that only the workers of a cluster need."""


def _is_made(name: str) -> bool:
    return name.startswith(tuple(OF_STEP.values()))


def _is_part(name: str) -> bool:
    return _is_made(name.removeprefix(".")) and not _is_made(name)


#: Held while files are fetched, since the threads of a worker share one copy.
_FETCHING = threading.Lock()


class Store(Folder):
    """A folder at an fsspec address. Home and each worker copy the files they need to temporary folders."""

    def __init__(self, address: str) -> None:
        super().__init__(address)
        self.copy = f"remesh-{uuid.uuid4().hex}"

    @contextmanager
    def at_home(self) -> Iterator[Path]:
        with tempfile.TemporaryDirectory(prefix="remesh-") as home:
            yield Path(home)

    def planned(self, home: str | os.PathLike[str]) -> None:
        system, root = self._open()
        for name in filter(_is_made, self._names()):
            system.rm_file(f"{root}/{name}")
        system.makedirs(root, exist_ok=True)
        for path in Path(home).iterdir():
            system.put_file(str(path), f"{root}/{path.name}")

    @contextmanager
    def at_work(self, step: str, number: int) -> Iterator[Path]:
        from distributed import get_worker

        copy = self._copy_of(get_worker())
        with _FETCHING:
            copy.mkdir(exist_ok=True)
            # Samples depend only on the plan.
            self._fetch(copy, (name for name in self._names() if step != "sample" or not _is_made(name)))
        yield copy
        self._put(copy, f"{OF_STEP[step]}{number}")

    def done(self, home: str | os.PathLike[str]) -> None:
        self._fetch(Path(home), self._names())
        system, root = self._open()
        for name in filter(_is_part, self._all_names()):
            system.rm_file(f"{root}/{name}")

    def leave(self, client: Client) -> None:
        client.run(self._remove_copy)

    def _remove_copy(self, dask_worker: Worker) -> None:
        shutil.rmtree(self._copy_of(dask_worker), ignore_errors=True)

    def _copy_of(self, worker: Worker) -> Path:
        return Path(worker.local_directory) / self.copy

    def _open(self) -> tuple[Any, str]:
        """Returns the fsspec file system, and the path in it."""
        from fsspec.core import url_to_fs

        system, root = url_to_fs(str(self.path))
        system.invalidate_cache()
        return system, root

    def _names(self) -> list[str]:
        """Returns the names of the complete files."""
        return [name for name in self._all_names() if name and not name.startswith(".")]

    def _all_names(self) -> Iterable[str]:
        system, root = self._open()
        paths = system.ls(root, detail=False) if system.exists(root) else []
        return (path.rstrip("/").rsplit("/", 1)[-1] for path in paths)

    def _fetch(self, copy: Path, names: Iterable[str]) -> None:
        """Fetches the files with these names that ``copy`` lacks."""
        system, root = self._open()
        for name in names:
            if not (copy / name).exists():
                system.get_file(f"{root}/{name}", str(copy / f".{name}"))
                (copy / f".{name}").replace(copy / name)

    def _put(self, copy: Path, name: str) -> None:
        """Uploads a file. Others see it only once it is complete."""
        system, root = self._open()
        part = f"{root}/.{name}-{uuid.uuid4().hex}"
        system.put_file(str(copy / name), part)
        system.mv(part, f"{root}/{name}")


def shared(folder: str | os.PathLike[str]) -> Folder:
    """Returns the folder at this path or address."""
    return Store(folder) if isinstance(folder, str) and "://" in folder else Folder(folder)
