"""Files, in every format of the command."""

from __future__ import annotations

import os
from typing import Any

from . import _native
from ._foreign import as_mesh
from ._mesh import Mesh


def read(path: str | os.PathLike[str], *, format: str | None = None) -> Mesh:
    """Reads a mesh or a cloud of points.

    Args:
        path: The file. Files packed by gzip are unpacked.
        format: The ending of a format, such as ``"ply"``, if neither the name nor the content should decide.

    Returns:
        The mesh with its attributes, texture coordinates, materials and names of parts, and notes of what was left out.

    Raises:
        FileError: If it cannot be read, or its format cannot be told.
        FormatError: If the content is not what the format says; it names the line, the byte or the part.
        ArgumentError: For a format that there is not.
    """
    vertices, faces, others, notes = _native.read(path, format)
    mesh = Mesh(vertices, faces)
    mesh._with(others, notes)
    return mesh


def write(path: str | os.PathLike[str], mesh: Any, *, format: str | None = None) -> None:
    """Writes a mesh, or points if it has no faces, with as much of its attributes as the format can hold.

    The file replaces an existing one only when it is complete.

    Args:
        path: The file. ``.gz`` may follow the ending.
        mesh: A mesh of this package, or any that :func:`remesh` takes.
        format: The ending of a format, if the name should not decide.

    Raises:
        FileError: If it cannot be written, or the format has no triangles or no points.
        ArgumentError: For what is no mesh, and for a format that there is not.
    """
    _native.write(path, as_mesh(mesh)._to_native(), format)
