"""The display of a mesh in a notebook: a picture, and a table of its report."""

from __future__ import annotations

import base64
from collections.abc import Callable
from html import escape
from typing import Any

from . import _native
from ._mesh import Mesh, Remeshed

_PICTURE_SIZE = 360

# Rows of the table: a name, and a function that formats its value from a mesh's part of the report.
_ROWS: list[tuple[str, Callable[[dict[str, Any]], str]]] = [
    ("vertices", lambda mesh: f"{mesh['topology']['vertices']:,}"),
    ("faces", lambda mesh: f"{mesh['topology']['faces']:,}"),
    ("components", lambda mesh: str(mesh["topology"]["components"])),
    ("boundary loops", lambda mesh: str(mesh["topology"]["boundary_loops"])),
    ("smallest angle", lambda mesh: f"{mesh['shape']['theta_min']:.1f}°"),
    ("mean smallest angle", lambda mesh: f"{mesh['shape']['theta_min_mean']:.1f}°"),
    ("mean edge length", lambda mesh: f"{mesh['shape']['edge_mean']:.4g}"),
]


def of_mesh(mesh: Mesh) -> str:
    """Returns a picture, unless there are only points, and a table."""
    return f'<div style="display:flex;gap:1em;align-items:center">{_picture(mesh)}{_table(mesh)}</div>'


def _picture(mesh: Mesh) -> str:
    if not len(mesh.faces):
        return ""
    png = base64.b64encode(_native.picture(mesh._to_native(), _PICTURE_SIZE)).decode()
    return f'<img alt="{escape(repr(mesh))}" src="data:image/png;base64,{png}">'


def _table(mesh: Mesh) -> str:
    report = mesh.report if isinstance(mesh, Remeshed) else None
    lines = [_line([name, figure]) for name, figure in _counts(mesh)] if report is None else _figures(report)
    if isinstance(mesh, Remeshed):
        lines.append(_line(["verified", "yes" if mesh.verified else f"no: {', '.join(mesh.shortcomings)}"]))
    lines += [_line(["note", note]) for note in mesh.notes]
    return f"<table>{''.join(lines)}</table>"


def _counts(mesh: Mesh) -> list[tuple[str, str]]:
    return [("vertices", f"{len(mesh.vertices):,}"), ("faces", f"{len(mesh.faces):,}")]


def _figures(report: dict[str, Any]) -> list[str]:
    """Returns rows with the input beside the output."""
    columns = [mesh for mesh in (report["input"], report["output"]) if mesh is not None and mesh["shape"]]
    lines = [_line(["", *["input", "result"][-len(columns) :]])]
    lines += [_line([name, *(figure(mesh) for mesh in columns)]) for name, figure in _ROWS]
    if report["distance"] is not None:
        lines.append(_line(["Hausdorff distance", f"{report['distance']['hausdorff']:.3g} % of the diagonal"]))
    return lines


def _line(cells: list[str]) -> str:
    """Returns a row: a name, and its figures, right-aligned, or a single text across all columns, left-aligned."""
    name, *figures = cells
    if len(figures) == 1:
        return f'<tr>{_name(name)}<td colspan="2" style="text-align:left">{escape(figures[0])}</td></tr>'
    columns = "".join(f'<td style="text-align:right">{escape(figure)}</td>' for figure in figures)
    return f"<tr>{_name(name)}{columns}</tr>"


def _name(name: str) -> str:
    return f'<th style="text-align:left">{escape(name)}</th>'
