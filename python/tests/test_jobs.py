"""The functions do what they promise, on arrays."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from conftest import euler, torus

import spectral_remesh as sr


def test_a_torus_stays_one_with_the_vertices_asked_for():
    remeshed = sr.remesh(*torus(), points=800)
    vertices, faces = remeshed
    assert vertices.shape == (800, 3) and vertices.dtype == np.float64
    assert faces.shape == (1600, 3) and faces.dtype == np.int64
    assert remeshed.verified and euler(faces) == 0
    from_ring = np.hypot(np.hypot(vertices[:, 0], vertices[:, 1]) - 2, vertices[:, 2])
    assert np.allclose(from_ring, 0.7, atol=0.03)
    assert remeshed.report["output"]["topology"]["vertices"] == 800
    assert remeshed.report["output"]["shape"]["theta_min"] > 30
    assert "vertices" in str(remeshed.report)


def test_results_are_the_arrays_of_the_user():
    remeshed = sr.remesh(*torus(), points=300, report=False)
    assert remeshed.report is None
    for array in (*remeshed, *remeshed.origin, remeshed.face_origin, remeshed.sharp_edges):
        assert array.flags.writeable
        array[:1] = 0


def layouts(array: np.ndarray) -> dict[str, np.ndarray]:
    wide = np.zeros((2 * len(array), 7), dtype=array.dtype)
    wide[::2, 1:6:2] = array
    packed = np.zeros(len(array), dtype=[("flag", "u1"), ("row", array.dtype, 3)])
    packed["row"] = array
    return {
        "fortran": np.asfortranarray(array),
        "strided": wide[::2, 1:6:2],
        "reversed": array[::-1][::-1],
        "swapped": array.astype(array.dtype.newbyteorder()),
        "unaligned": packed["row"],
        "read-only": np.frombuffer(array.tobytes(), dtype=array.dtype).reshape(array.shape),
    }


@pytest.mark.parametrize("layout", layouts(np.zeros((1, 3))))
def test_arrays_may_lie_in_memory_in_any_way(layout):
    vertices, faces = torus()
    expected = sr.remesh(vertices, faces, points=200, report=False)
    found = sr.remesh(layouts(vertices)[layout], layouts(faces)[layout], points=200, report=False)
    assert np.array_equal(found.vertices, expected.vertices) and np.array_equal(found.faces, expected.faces)


@pytest.mark.parametrize("floats", ["f2", "f4", "f8", "g", "i1", "u1", "i2", "u4", "i8", "longlong"])
@pytest.mark.parametrize("integers", ["i2", "u2", "i4", "u4", "i8", "u8", "longlong"])
def test_arrays_may_be_of_any_type(floats, integers):
    # All types can represent these numbers.
    vertices = np.array([[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    expected = sr.remesh(vertices.astype(float), faces, points=50, report=False)
    found = sr.remesh(vertices.astype(floats), faces.astype(integers), points=50, report=False)
    assert np.array_equal(found.vertices, expected.vertices)


def test_lists_and_polygons_are_taken_too():
    cube = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    remeshed = sr.remesh(cube, squares, points=400)
    assert remeshed.verified and euler(remeshed.faces) == 2


def test_a_pair_of_arrays_is_a_mesh(tmp_path):
    pair = torus()
    assert np.array_equal(sr.remesh(pair, points=200).vertices, sr.remesh(*pair, points=200).vertices)
    sr.write(tmp_path / "pair.ply", pair)
    assert np.array_equal(sr.read(tmp_path / "pair.ply").faces, pair[1])
    assert sr.quality(pair, against=pair)["distance"]["hausdorff"] < 1e-6


def test_origins_say_where_vertices_lie_on_the_input():
    vertices, faces = torus()
    remeshed = sr.remesh(vertices, faces, points=300, attributes={"x": vertices[:, 0], "all": vertices})
    origin = remeshed.origin
    assert np.array_equal(faces[origin.faces], origin.vertices)
    assert np.allclose(origin.weights.sum(axis=1), 1) and (origin.weights >= 0).all()
    places = (origin.weights[:, :, None] * vertices[origin.vertices]).sum(axis=1)
    assert np.linalg.norm(places - remeshed.vertices, axis=1).max() < 0.05
    assert np.allclose(remeshed.attributes["all"], places)
    assert np.allclose(remeshed.attributes["x"], places[:, 0])
    centres = remeshed.vertices[remeshed.faces].mean(axis=1)
    below = vertices[faces[remeshed.face_origin]].mean(axis=1)
    assert np.linalg.norm(centres - below, axis=1).max() < 0.3


def test_sharp_edges_are_told():
    cube = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    remeshed = sr.remesh(cube, squares, points=400)
    ends = remeshed.vertices[remeshed.sharp_edges]
    assert np.isclose(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum(), 12)
    # Two coordinates of each end are those of an edge of the cube.
    assert (np.isin(ends.round(12), (0, 1)).sum(axis=2) >= 2).all()
    assert sr.remesh(*torus(), points=300).sharp_edges.shape == (0, 2)


def test_sharp_edges_may_be_given():
    cube = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    top = np.array([[4, 5], [7, 5], [6, 7], [4, 6]])
    remeshed = sr.remesh(cube, squares, points=600, features=top)
    ends = remeshed.vertices[remeshed.sharp_edges]
    assert remeshed.verified and (ends[:, :, 2] == 1).all()
    assert np.isclose(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum(), 4)
    for wrong in (top + 4, top - 5, top[:, 0], top + 0.5):
        with pytest.raises(sr.ArgumentError, match="features"):
            sr.remesh(cube, squares, points=600, features=wrong)


def test_attributes_keep_their_types():
    vertices, faces = torus()
    near = vertices[:, 0] > 0
    given = {
        "color": np.full((len(vertices), 4), 200, dtype=np.uint8),
        "class": np.where(near, 7, 2**20),
        "mask": near,
        "half": vertices[:, 0].astype(np.float16),
        "single": vertices.astype(np.float32),
    }
    attributes = sr.remesh(vertices, faces, points=300, attributes=given).attributes
    assert list(attributes) == list(given)
    types = {name: array.dtype.name for name, array in attributes.items()}
    assert types == {"color": "uint8", "class": "int32", "mask": "uint8", "half": "float32", "single": "float32"}
    assert attributes["color"].shape == (300, 4) and (attributes["color"] == 200).all()
    # Labels are those of the nearest vertex, never averages.
    assert set(attributes["class"]) == {7, 2**20}
    assert sr.remesh(vertices, faces, points=300, attributes=False).attributes == {}


def test_lengths_follow_a_field():
    vertices, faces = torus()
    lengths = np.where(vertices[:, 0] > 0, 0.1, 0.3)
    by_array = sr.remesh(vertices, faces, sizing=lengths)
    by_name = sr.remesh(vertices, faces, sizing="h", attributes={"h": lengths})
    assert np.array_equal(by_array.vertices, by_name.vertices)
    assert (by_array.vertices[:, 0] > 0).mean() > 0.7


def test_only_a_part_changes():
    vertices, faces = torus()
    mask = vertices[:, 0] > 0.5
    kept = vertices[vertices[:, 0] < 0.2]
    box = [[0.5, -9, -9], [9, 9, 9]]
    for part in ({"select": mask}, {"within": box}, {"within": np.float32(box)}):
        found = {tuple(row) for row in sr.remesh(vertices, faces, points=200, **part).vertices}
        assert all(tuple(row) in found for row in kept)
    marked = sr.remesh(vertices, faces, points=200, select="side=2", attributes={"side": 2 * mask})
    assert np.array_equal(marked.vertices, sr.remesh(vertices, faces, points=200, select=mask).vertices)


def test_the_threads_do_not_matter_and_the_seed_does():
    one, two = (sr.remesh(*torus(), points=300, threads=threads).vertices for threads in (1, 2))
    other = sr.remesh(*torus(), points=300, seed=7).vertices
    assert np.array_equal(one, two) and not np.array_equal(one, other)


def test_a_cloud_becomes_a_mesh():
    vertices, _ = torus()
    remeshed = sr.remesh(vertices, points=600)
    assert remeshed.verified and euler(remeshed.faces) == 0
    assert (remeshed.origin.faces == -1).all() and len(remeshed.face_origin) == 0
    assert remeshed.report["cloud"]["points"] == len(vertices)


def test_samples_lie_on_the_surface_and_have_its_normals():
    vertices, faces = torus()
    sampled = sr.sample(vertices, faces, points=500)
    assert sampled.vertices.shape == sampled.normals.shape == (500, 3) and len(sampled.faces) == 0
    assert np.allclose(np.linalg.norm(sampled.normals, axis=1), 1)
    assert sampled.indices is None and sampled.report["samples"] == 500
    subset = sr.sample(vertices, faces, points=500, scan_only=True)
    assert np.array_equal(vertices[subset.indices], subset.vertices)
    # Samples can be remeshed.
    assert sr.remesh(sr.sample(vertices, faces, points=1500), points=500).verified


def test_a_cloud_is_reconstructed():
    made = sr.reconstruct(torus()[0], resolution=0.2)
    assert euler(made.faces) == 0 and made.report["resolution"] == 0.2


def test_any_mesh_is_measured():
    mesh = torus()
    remeshed = sr.remesh(*mesh, points=500)
    report = sr.quality(remeshed, against=mesh)
    assert report["output"]["shape"] == remeshed.report["output"]["shape"]
    assert 0 < report["distance"]["hausdorff"] < 2
    assert sr.quality(*mesh)["distance"] is None


def test_strict_raises_with_the_result():
    few = {"points": 200, "max_error": 1e-4}
    remeshed = sr.remesh(*torus(), **few)
    assert not remeshed.verified and remeshed.shortcomings
    with pytest.raises(sr.NotVerifiedError, match="to the input") as caught:
        sr.remesh(*torus(), **few, strict=True)
    assert np.array_equal(caught.value.remeshed.vertices, remeshed.vertices)


def test_levels_are_what_each_number_gives_alone():
    levels = sr.levels(*torus(), points=(600, 200), seed=3, report=False)
    for level, count in zip(levels, (600, 200), strict=True):
        alone = sr.remesh(*torus(), points=count, seed=3, report=False)
        assert np.array_equal(level.vertices, alone.vertices) and level.report is None
        assert np.array_equal(level.origin.faces, alone.origin.faces)
    for wrong in ({"points": (200, 600)}, {"points": ()}, {"points": (9, 4), "edge_length": 1}, {"points": (9, 4), "colour": 1}):
        with pytest.raises(sr.ArgumentError):
            sr.levels(*torus(), **wrong)
    with pytest.raises(sr.NotVerifiedError):
        sr.levels(*torus(), points=(800, 100), max_error=0.03, strict=True)


def test_meshes_can_be_pickled():
    remeshed = sr.remesh(*torus(), points=100)
    again = pickle.loads(pickle.dumps(remeshed))
    assert np.array_equal(again.vertices, remeshed.vertices) and again.report == remeshed.report
    error = pickle.loads(pickle.dumps(sr.ArgumentError("points", "too few")))
    assert str(error) == "points: too few"
