from collections.abc import Callable
from os import PathLike
from typing import Any, final

from numpy import float64, int64
from numpy.typing import NDArray

__all__ = [
    "Attributes",
    "Mesh",
    "Reconstructed",
    "Remeshed",
    "Sampled",
    "__version__",
    "levels",
    "main",
    "picture",
    "quality",
    "read",
    "reconstruct",
    "remesh",
    "sample",
    "split",
    "write",
]

__version__: str

_Array = NDArray[Any]
_Told = tuple[str, str]
_Progress = Callable[[str, float], object]

@final
class Attributes:
    def arrays(self) -> dict[str, _Array]: ...
    def texture(self) -> NDArray[float64] | None: ...

@final
class Mesh:
    def __new__(
        cls,
        vertices: _Array,
        faces: _Array | None,
        arrays: dict[str, _Array],
        texture_coordinates: NDArray[float64] | None,
        base: Attributes | None,
    ) -> Mesh: ...

@final
class Remeshed:
    @property
    def vertices(self) -> NDArray[float64]: ...
    @property
    def faces(self) -> NDArray[int64]: ...
    @property
    def attributes(self) -> Attributes: ...
    @property
    def origin(self) -> tuple[NDArray[int64], NDArray[int64], NDArray[float64]]: ...
    @property
    def face_origin(self) -> NDArray[int64]: ...
    @property
    def sharp_edges(self) -> NDArray[int64]: ...
    @property
    def report(self) -> _Told | None: ...
    @property
    def shortcomings(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Sampled:
    @property
    def vertices(self) -> NDArray[float64]: ...
    @property
    def attributes(self) -> Attributes: ...
    @property
    def report(self) -> _Told: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Reconstructed:
    @property
    def vertices(self) -> NDArray[float64]: ...
    @property
    def faces(self) -> NDArray[int64]: ...
    @property
    def report(self) -> _Told: ...

def remesh(mesh: Mesh, arguments: dict[str, object], threads: int | None, progress: _Progress | None) -> Remeshed: ...
def levels(
    mesh: Mesh, arguments: dict[str, object], counts: list[int], threads: int | None, progress: _Progress | None
) -> list[Remeshed]: ...
def sample(mesh: Mesh, arguments: dict[str, object], threads: int | None, progress: _Progress | None) -> Sampled: ...
def reconstruct(mesh: Mesh, arguments: dict[str, object], threads: int | None, progress: _Progress | None) -> Reconstructed: ...
def quality(mesh: Mesh, against: Mesh | None, threads: int | None) -> _Told: ...
def read(path: str | PathLike[str], format: str | None) -> tuple[NDArray[float64], NDArray[int64], Attributes, list[str]]: ...
def write(path: str | PathLike[str], mesh: Mesh, format: str | None) -> None: ...
def split(vertices: _Array, corners: NDArray[int64], sizes: NDArray[int64]) -> NDArray[int64]: ...
def picture(mesh: Mesh, size: int) -> bytes: ...
def main(arguments: list[str]) -> int: ...
