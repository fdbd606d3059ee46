"""Shapes and files for the tests."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
from pathlib import Path

import numpy as np
import pytest

import spectral_remesh as sr

ROOT = Path(__file__).resolve().parents[2]


def torus(n: int = 60, m: int = 30) -> tuple[np.ndarray, np.ndarray]:
    """Returns a torus around z with radii 2 and 0.7. Its Euler characteristic is 0."""
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    a, b = 2 * np.pi * i / n, 2 * np.pi * j / m
    r = 2 + 0.7 * np.cos(b)
    vertices = np.stack([r * np.cos(a), r * np.sin(a), 0.7 * np.sin(b)], axis=-1).reshape(-1, 3)

    def number(di: int, dj: int) -> np.ndarray:
        return ((i + di) % n * m + (j + dj) % m).reshape(-1)

    corners = number(0, 0), number(1, 0), number(1, 1), number(0, 1)
    faces = [np.stack([corners[k] for k in triangle], axis=-1) for triangle in ((0, 1, 2), (0, 2, 3))]
    return vertices, np.concatenate(faces)


def euler(faces: np.ndarray) -> int:
    """Returns the Euler characteristic of a closed mesh, and asserts that each edge has exactly two faces."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    different, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 2).all()
    return len(np.unique(faces)) - len(different) + len(faces)


def command(*words: object, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs the command installed with the package."""
    program = shutil.which("remesh", path=os.pathsep.join([sysconfig.get_path("scripts"), os.environ["PATH"]]))
    assert program is not None
    return subprocess.run([program, *map(str, words)], cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def data() -> Path:
    return ROOT / "data"


@pytest.fixture
def marked(tmp_path: Path) -> Path:
    """A file with a torus and the properties ``h``, edge lengths, and ``half``, 1 where x is positive."""
    vertices, faces = torus()
    positive = vertices[:, 0] > 0
    attributes = {"h": np.where(positive, 0.15, 0.25).astype(np.float32), "half": positive.astype(np.uint8)}
    sr.write(tmp_path / "marked.ply", sr.Mesh(vertices, faces, attributes=attributes))
    return tmp_path / "marked.ply"
