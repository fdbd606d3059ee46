"""Reads and writes files in every format of the command."""

from __future__ import annotations

import os
from typing import Any

from . import _native
from ._foreign import as_mesh
from ._mesh import Mesh


def read(path: str | os.PathLike[str], *, format: str | None = None) -> Mesh:
    """Reads a mesh or a cloud of points.

    Args:
        path: The file. Files compressed with gzip are decompressed.
        format: The extension of a format, such as ``"ply"``. By default the name or the content decides.

    Returns:
        The mesh with its attributes, texture coordinates, materials and names of parts, and notes on what was left out.

    Raises:
        FileError: If it cannot be read, or its format cannot be determined.
        FormatError: If the content does not conform to the format. It names the line, the byte or the part.
        ArgumentError: If ``format`` is unknown.
    """
    vertices, faces, others, notes = _native.read(path, format)
    mesh = Mesh(vertices, faces)
    mesh._with(others, notes)
    return mesh


def write(path: str | os.PathLike[str], mesh: Any, *, format: str | None = None) -> None:
    """Writes a mesh, or points if it has no faces, with the attributes that the format can hold.

    An existing file is replaced only once the new one is complete.

    Args:
        path: The file. ``.gz`` may follow the extension.
        mesh: A mesh of this package, or any that :func:`remesh` accepts.
        format: The extension of a format. By default the name decides.

    Raises:
        FileError: If it cannot be written, or the format cannot hold triangles or points.
        ArgumentError: If ``mesh`` is not a mesh, or ``format`` is unknown.
    """
    _native.write(path, as_mesh(mesh)._to_native(), format)
