"""Invalid input raises a ValueError that names the argument, or a specific exception."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import torus

import spectral_remesh as sr

VERTICES, FACES = torus()


def changed(array, place, value):
    array = array.copy()
    array[place] = value
    return array


ARRAYS = [
    ("vertices", "shape", VERTICES[:, :2], FACES),
    ("vertices", "shape", VERTICES.reshape(-1), FACES),
    ("vertices", "numbers", VERTICES.astype(complex), FACES),
    ("vertices", "numbers", [["a", "b", "c"]], FACES),
    ("vertices", "array", [[0, 0], [0, 0, 0]], FACES),
    ("vertices", "vertex 5 is at .*NaN", changed(VERTICES, (5, 1), np.nan), FACES),
    ("vertices", "vertex 5 is at .*inf", changed(VERTICES, (5, 1), np.inf), FACES),
    ("vertices", "vertex 5 is at .*NaN", changed(VERTICES, (5, 1), np.nan), None),
    ("vertices", r"give read\('a.ply'\)", "a.ply", None),
    ("faces", "shape", VERTICES, FACES[:, :2]),
    ("faces", "shape", VERTICES, FACES.reshape(-1)),
    ("faces", "whole numbers", VERTICES, FACES.astype(float)),
    ("faces", "face 3 has the corner -1", VERTICES, changed(FACES, (3, 0), -1)),
    ("faces", "triangle 3 .* 1800 vertices", VERTICES, changed(FACES, (3, 0), 1800)),
    ("faces", "face 3 has the corner 4294967296", VERTICES, changed(FACES, (3, 0), 2**32)),
    ("faces", "face 0 has the corner -1", VERTICES, [[0, 1, 2, -1]]),
    ("faces", "face 0 has the corner 1800", VERTICES, [[0, 1, 2, 1800]]),
    ("faces", "leave one of them out", sr.Mesh(VERTICES, FACES), FACES),
]


@pytest.mark.parametrize(("argument", "words", "vertices", "faces"), ARRAYS)
def test_bad_arrays_are_named(argument, words, vertices, faces):
    for job in (sr.remesh, sr.sample):
        with pytest.raises(ValueError, match=words) as caught:
            job(vertices, faces, points=100)
        assert isinstance(caught.value, sr.SpectralRemeshError)
        assert caught.value.argument == argument and str(caught.value).startswith(f"{argument}: ")
    with pytest.raises(ValueError, match=words):
        sr.reconstruct(vertices, faces)
    if faces is not None:
        with pytest.raises(ValueError, match=words):
            sr.quality(vertices, faces)


OPTIONS = [
    ("points", {}, "no density is given"),
    ("points", {"points": 2}, "from 3 to"),
    ("points", {"points": 10.5}, "whole number"),
    ("points", {"points": "many"}, "whole number of at least 1, or auto"),
    ("points", {"points": "auto"}, "give an error bound"),
    ("edge_length", {"points": 9, "edge_length": 1.0}, "together with"),
    ("edge_length", {"edge_length": float("nan")}, "not a length"),
    ("sigma_p", {"sigma_p": "wide"}, "number"),
    ("sigma_n", {"points": 9, "sigma_n": -1}, "above zero"),
    ("sigma_n", {"points": 9, "adapt": 1, "sigma_n": 1}, "together with"),
    ("sigma", {"points": 9, "sigma": {"h": -1.0}, "attributes": {"h": VERTICES[:, 0]}}, "above zero"),
    ("sizing", {"sizing": np.ones(7)}, "7 values are given for the 1800 vertices"),
    ("sizing", {"sizing": changed(np.ones(1800), 4, np.nan)}, "vertex 4 has the value NaN"),
    ("sizing", {"sizing": np.ones((1800, 1))}, "shape"),
    ("features", {"points": 9, "features": 200}, "between 0 and 180"),
    ("features", {"points": 9, "features": "sharp"}, "auto or none"),
    ("adapt", {"points": 9, "adapt": 2}, "from 0 to 1"),
    ("max_error", {"points": 9, "max_error": "1%%"}, "positive length"),
    ("weld", {"points": 9, "weld": -1.0}, "not a length"),
    ("smooth", {"points": 9, "smooth": 99}, "from 1.5 to 20"),
    ("normal_fit", {"points": 9, "normal_fit": "line"}, "plane or sphere"),
    ("normal_radius", {"points": 9, "normal_neighbors": 9, "normal_radius": 1.0}, "together with"),
    ("within", {"points": 9, "within": [0, 0, 0, 1, 1, 1]}, "lowest and highest x, y and z"),
    ("within", {"points": 9, "within": [[1, 1, 1], [0, 0, 0]]}, "from 1 to 0 along x"),
    ("select", {"points": 9, "select": [True]}, "1 mark is given for the 1800"),
    ("select", {"points": 9, "select": [0, 1]}, "truth values"),
    ("attributes", {"points": 9, "attributes": {"h": np.ones(7)}}, "'h'.*(1800,)"),
    ("attributes", {"points": 9, "attributes": {"h": ["a"] * 1800}}, "'h': numbers"),
    ("attributes", {"points": 9, "attributes": np.ones(1800)}, "from names to arrays"),
    ("seed", {"points": 9, "seed": -1}, "negative|unsigned"),
    ("threads", {"points": 9, "threads": 0}, "from 1 to 1024"),
    ("progress", {"points": 9, "progress": "bar"}, "function"),
]


@pytest.mark.parametrize(("argument", "options", "words"), OPTIONS)
def test_bad_options_are_named(argument, options, words):
    with pytest.raises(sr.ArgumentError, match=words) as caught:
        sr.remesh(VERTICES, FACES, **options)
    assert caught.value.argument == argument


def test_texts_name_arguments_and_no_flags():
    with pytest.raises(sr.FileError) as caught:
        sr.read(__file__)
    assert "give its format: one of obj" in str(caught.value) and "--" not in str(caught.value)


def test_errors_have_kinds(tmp_path):
    with pytest.raises(sr.MeshError, match="line|position"):
        sr.remesh(np.zeros((9, 3)), points=9)
    with pytest.raises(sr.MeshError, match="no property 'h'"):
        sr.remesh(VERTICES, FACES, sizing="h")
    with pytest.raises(sr.MeshError, match="no triangles"):
        sr.quality(VERTICES)
    with pytest.raises(OSError, match="none.ply: .*no such file"):
        sr.read(tmp_path / "none.ply")
    (tmp_path / "bad.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 nan\n")
    with pytest.raises(sr.FormatError, match="bad.off:4: .*nan"):
        sr.read(tmp_path / "bad.off")
    with pytest.raises(sr.ArgumentError, match="format: .*is not a mesh format"):
        sr.read(tmp_path / "bad.off", format="doc")
    with pytest.raises(sr.FileError, match="no format with the extension"):
        sr.write(tmp_path / "a.doc", sr.Mesh(VERTICES, FACES))
    assert all(issubclass(getattr(sr, name), sr.SpectralRemeshError) for name in sr.__all__ if name.endswith("Error"))


def test_textures_of_another_mesh_are_refused():
    mesh = sr.Mesh(VERTICES, FACES, texture=np.zeros((7, 3, 2)))
    with pytest.raises(sr.ArgumentError, match="attributes: texture coordinates are given for 7 triangles"):
        sr.remesh(mesh, points=100)
