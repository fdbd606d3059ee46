"""The Python examples on the pages run."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = {"python/README.md": "remeshed.is_watertight", "docs/python.md": "even.is_watertight"}


@pytest.mark.parametrize(("page", "holds"), PAGES.items())
def test_the_examples_run_in_their_order(page, holds, tmp_path, data, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 2
    for package in ("trimesh", "pyvista"):
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    os.symlink(data, tmp_path / "data")
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert eval(holds, names)
