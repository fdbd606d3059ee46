"""The folder that machines share, by a name that all of them know or in an object store."""

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

#: What the names of files begin with that the program has not completed.
UNFINISHED = ".remesh-"

#: What the names of files begin with that a step of a plan makes.
OF_STEP = {"sample": "tile-", "mesh": "piece-"}


class Folder:
    """One that all machines have under the same name."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path

    @contextmanager
    def at_home(self) -> Iterator[str | os.PathLike[str]]:
        """Where the plan is made and the result is merged."""
        yield self.path

    def planned(self, home: str | os.PathLike[str]) -> None:
        """Gives all machines the plan that was made at home."""

    @contextmanager
    def at_work(self, step: str, number: int) -> Iterator[str | os.PathLike[str]]:
        """Where a worker does a step."""
        yield self.path

    def done(self, home: str | os.PathLike[str]) -> None:
        """Brings home what all workers have made, and removes what those that died left."""
        for unfinished in Path(self.path).glob(f"{UNFINISHED}*"):
            unfinished.unlink(missing_ok=True)

    def leave(self, client: Client) -> None:
        """Removes what only the workers of a cluster need."""


def _is_made(name: str) -> bool:
    return name.startswith(tuple(OF_STEP.values()))


def _is_part(name: str) -> bool:
    return _is_made(name.removeprefix(".")) and not _is_made(name)


#: The threads of a worker have one copy.
_FETCHING = threading.Lock()


class Store(Folder):
    """One at an address of fsspec. Home and each worker have copies of what they need of it, in temporary folders."""

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
            # Samples depend on the plan only.
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
        """The file system of fsspec, and the place in it."""
        from fsspec.core import url_to_fs

        system, root = url_to_fs(str(self.path))
        system.invalidate_cache()
        return system, root

    def _names(self) -> list[str]:
        """The names of the complete files."""
        return [name for name in self._all_names() if name and not name.startswith(".")]

    def _all_names(self) -> Iterable[str]:
        system, root = self._open()
        paths = system.ls(root, detail=False) if system.exists(root) else []
        return (path.rstrip("/").rsplit("/", 1)[-1] for path in paths)

    def _fetch(self, copy: Path, names: Iterable[str]) -> None:
        """Copies the files of these names that are not there."""
        system, root = self._open()
        for name in names:
            if not (copy / name).exists():
                system.get_file(f"{root}/{name}", str(copy / f".{name}"))
                (copy / f".{name}").replace(copy / name)

    def _put(self, copy: Path, name: str) -> None:
        """Adds a file, which others see when it is complete."""
        system, root = self._open()
        part = f"{root}/.{name}-{uuid.uuid4().hex}"
        system.put_file(str(copy / name), part)
        system.mv(part, f"{root}/{name}")


def shared(folder: str | os.PathLike[str]) -> Folder:
    """The folder of this name or address."""
    return Store(folder) if isinstance(folder, str) and "://" in folder else Folder(folder)
