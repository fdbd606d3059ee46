"""The Python of the package's page runs."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[1] / "README.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_there_are_examples():
    assert len(BLOCKS) >= 2


def test_the_examples_run_in_their_order(tmp_path, data, monkeypatch):
    for package in ("trimesh", "pyvista"):
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    os.symlink(data, tmp_path / "data")
    names: dict[str, object] = {}
    for block in BLOCKS:
        exec(compile(block, str(PAGE), "exec"), names)
    assert names["remeshed"].is_watertight
