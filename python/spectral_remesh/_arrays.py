"""Converts users' arrays to the types that the compiled half reads. Arrays of common types are not copied."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._errors import ArgumentError

Array = NDArray[Any]

#: Types that the compiled half reads without conversion.
_PLAIN = [np.dtype(name) for name in ("?", "f4", "f8", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")]


def as_vertices(values: ArrayLike) -> Array:
    """Returns positions, of shape (n, 3)."""
    array = _numbers("vertices", values, "fiu", "numbers")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError("vertices", f"an array of shape (n, 3) is expected, not {array.shape}")
    return array


def as_faces(values: ArrayLike | None, vertices: Array) -> Array | None:
    """Returns triangles, of shape (m, 3), or ``None`` if there are no faces. Polygons, of shape (m, k), are split."""
    if values is None or np.size(values) == 0:
        return None
    array = _numbers("faces", values, "iu", "whole numbers")
    if array.ndim != 2 or array.shape[1] < 3:
        raise ArgumentError("faces", f"an array of shape (m, 3) is expected, not {array.shape}")
    if array.shape[1] > 3:
        return split(vertices, array, np.full(len(array), array.shape[1]))
    return array


def split(vertices: Array, corners: ArrayLike, sizes: ArrayLike) -> Array:
    """Splits polygons into triangles. ``corners`` has the corners of all polygons in order, ``sizes`` the number per polygon."""
    numbers = [np.ascontiguousarray(values, dtype=np.int64).reshape(-1) for values in (corners, sizes)]
    return _native.split(vertices, *numbers)


def as_attributes(arrays: Mapping[str, ArrayLike], vertices: int) -> dict[str, Array]:
    """Converts arrays of shape (vertices,) or (vertices, components) to matrices."""
    return {name: _as_columns(name, values, vertices) for name, values in arrays.items()}


def _as_columns(name: str, values: ArrayLike, vertices: int) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise ArgumentError("attributes", f"{name!r}: numbers are expected, not {array.dtype}")
    if array.ndim == 1:
        array = array.reshape(-1, 1)
    if array.ndim != 2 or array.shape[1] == 0 or len(array) != vertices:
        wanted = f"an array of shape ({vertices},) or ({vertices}, components) is expected, not {np.shape(values)}"
        raise ArgumentError("attributes", f"{name!r}: {wanted}")
    return _plain(array.astype(_of_a_file(array), copy=False))


def _of_a_file(array: Array) -> np.dtype[Any]:
    """Returns the type in which files store such numbers. No format has integers of eight bytes."""
    if array.dtype.kind == "b":
        return np.dtype(np.uint8)
    if array.dtype.kind == "f":
        return np.dtype(np.float32 if array.dtype.itemsize <= 4 else np.float64)
    if array.dtype.itemsize < 8:
        return array.dtype
    for integers in (np.int32, np.uint32):
        bounds = np.iinfo(integers)
        if not array.size or (array.min() >= bounds.min and array.max() <= bounds.max):
            return np.dtype(integers)
    return np.dtype(np.float64)


def as_lengths(values: str | ArrayLike | None) -> str | Array | None:
    """Converts the argument ``sizing``."""
    if values is None or isinstance(values, str):
        return values
    return _vector("sizing", values, "fiu", "lengths").astype(np.float64, copy=False)


def as_marks(values: str | ArrayLike | None) -> str | Array | None:
    """Converts the argument ``select``."""
    if values is None or isinstance(values, str):
        return values
    return _vector("select", values, "b", "truth values")


def as_sharp_edges(values: str | float | ArrayLike | None) -> str | float | Array | None:
    """Converts the argument ``features``."""
    if values is None or isinstance(values, str) or np.ndim(values) == 0:
        return values  # type: ignore[return-value]
    array = _numbers("features", values, "iu", "numbers of vertices")
    if array.ndim != 2 or array.shape[1] != 2:
        raise ArgumentError("features", f"the two vertices of each edge are expected, of shape (edges, 2), not {array.shape}")
    if array.size and (array.min() < 0 or array.max() > np.iinfo(np.uint32).max):
        raise ArgumentError("features", "no vertex has a number below 0 or above 4,294,967,295")
    return array.astype(np.uint32)


def as_box(values: ArrayLike | None) -> list[list[float]] | None:
    """Converts the argument ``within``."""
    if values is None:
        return None
    array = _numbers("within", values, "fiu", "numbers")
    if array.shape != (2, 3):
        raise ArgumentError("within", f"the lowest and highest x, y and z, of shape (2, 3), are expected, not {array.shape}")
    corners: list[list[float]] = array.astype(np.float64).tolist()
    return corners


def _vector(argument: str, values: ArrayLike, kinds: str, wanted: str) -> Array:
    array = _numbers(argument, values, kinds, wanted)
    if array.ndim != 1:
        raise ArgumentError(argument, f"an array of shape (vertices,) is expected, not {array.shape}")
    return array


def _numbers(argument: str, values: ArrayLike, kinds: str, wanted: str) -> Array:
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ArgumentError(argument, f"it cannot be converted to an array: {error}") from None
    if array.dtype.kind not in kinds:
        raise ArgumentError(argument, f"{wanted} are expected, not {array.dtype}")
    return _plain(array)


def _plain(array: Array) -> Array:
    """Returns the same numbers in a type, byte order and alignment that compiled code can read."""
    if array.dtype not in _PLAIN:
        native = array.dtype.newbyteorder("=")
        return array.astype(native if native in _PLAIN else np.float64)
    return array if array.flags.aligned else array.copy()
