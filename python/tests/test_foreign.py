"""Meshes of other packages, if these are installed."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from conftest import euler, torus

import spectral_remesh as sr

VERTICES, FACES = torus()
COLORS = np.column_stack([np.where(VERTICES[:, :1] > 0, 255, 0), np.full((len(VERTICES), 2), 9), np.full(len(VERTICES), 255)])
NORMALS = np.random.default_rng(1).normal(size=VERTICES.shape)


def test_nothing_is_imported_that_is_not_given():
    code = (
        "import spectral_remesh, sys; print([m for m in ('trimesh', 'pyvista', 'meshio', 'open3d', 'tqdm') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def assert_like_arrays(mesh, **options):
    """Asserts that a mesh of another package gives the same result as its arrays."""
    expected = sr.remesh(VERTICES, FACES, points=300, **options)
    found = sr.remesh(mesh, points=300)
    assert np.array_equal(found.vertices, expected.vertices)
    assert found.attributes.keys() == expected.attributes.keys()
    for name, array in expected.attributes.items():
        assert np.array_equal(found.attributes[name], array), name


def test_trimesh():
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(VERTICES, FACES, process=False, vertex_colors=COLORS, vertex_attributes={"h": VERTICES[:, 2]})
    assert_like_arrays(mesh, attributes={"color": COLORS.astype(np.uint8), "h": VERTICES[:, 2]})
    remeshed = sr.remesh(mesh, points=300)
    made = remeshed.to_trimesh()
    assert isinstance(made, trimesh.Trimesh) and made.is_watertight and made.euler_number == 0
    assert np.array_equal(made.vertices, remeshed.vertices) and np.array_equal(made.faces, remeshed.faces)
    assert np.array_equal(made.visual.vertex_colors, remeshed.attributes["color"])
    assert np.array_equal(made.vertex_attributes["h"], remeshed.attributes["h"])
    cloud = sr.sample(mesh, points=300).to_trimesh()
    assert isinstance(cloud, trimesh.PointCloud) and len(cloud.vertices) == 300
    assert len(sr.sample(trimesh.PointCloud(VERTICES, COLORS), points=100).vertices) == 100
    painted = trimesh.Trimesh(VERTICES, FACES, process=False, face_colors=COLORS[:1])
    assert sr.remesh(painted, points=100).notes == ["colours of faces are left out"]
    with pytest.raises(sr.ArgumentError, match="vertices: trimesh.*Scene is not a mesh.*one by one"):
        sr.remesh(trimesh.Scene([mesh]), points=100)


def test_trimesh_with_a_texture():
    trimesh = pytest.importorskip("trimesh")
    coordinates = VERTICES[:, :2] / 6 + 0.5
    mesh = trimesh.Trimesh(VERTICES, FACES, process=False, visual=trimesh.visual.TextureVisuals(uv=coordinates))
    remeshed = sr.remesh(mesh, points=600)
    expected = remeshed.vertices[remeshed.faces][:, :, :2] / 6 + 0.5
    assert np.allclose(remeshed.texture, expected, atol=0.01)
    assert np.array_equal(remeshed.to_trimesh().face_attributes["texture"], remeshed.texture)


def test_pyvista():
    pyvista = pytest.importorskip("pyvista")
    mesh = pyvista.PolyData.from_regular_faces(VERTICES, FACES)
    mesh.point_data["h"] = VERTICES[:, 2]
    mesh.point_data["Normals"] = NORMALS
    mesh.point_data.active_normals_name = "Normals"
    mesh.point_data["RGB"] = COLORS.astype(np.uint8)
    names = {"h": VERTICES[:, 2], "normal": NORMALS, "RGB": COLORS.astype(np.uint8)}
    assert_like_arrays(mesh, attributes={name: names[name] for name in ("h", "normal", "RGB")})
    mesh.cell_data["zone"] = np.arange(len(FACES))
    remeshed = sr.remesh(mesh, points=300)
    assert remeshed.notes == ["zone of faces is left out"]
    made = remeshed.to_pyvista()
    assert isinstance(made, pyvista.PolyData) and made.n_points == 300 and made.is_manifold
    assert np.array_equal(made.regular_faces, remeshed.faces)
    assert np.array_equal(made.point_data["h"], remeshed.attributes["h"])
    assert made.point_data.active_normals_name == "normal"
    cloud = sr.sample(mesh, points=300).to_pyvista()
    assert cloud.n_points == 300 and cloud.n_faces == 0
    assert sr.remesh(pyvista.PolyData(VERTICES), points=300).verified
    with pytest.raises(sr.ArgumentError, match=r"UnstructuredGrid is not a mesh.*extract_surface\(\)"):
        sr.remesh(mesh.cast_to_unstructured_grid(), points=100)


def test_pyvista_with_polygons():
    pyvista = pytest.importorskip("pyvista")
    # Quadrilaterals, and a pyramid with a quadrilateral and triangles.
    assert euler(sr.remesh(pyvista.Cube(clean=True).clean(), points=300).faces) == 2
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]]
    mixed = pyvista.PolyData(np.array(points), faces=[4, 3, 2, 1, 0, 3, 0, 1, 4, 3, 1, 2, 4, 3, 2, 3, 4, 3, 3, 0, 4])
    assert euler(sr.remesh(mixed, points=300).faces) == 2


def test_pyvista_has_an_accessor():
    pyvista = pytest.importorskip("pyvista")
    if not hasattr(pyvista, "register_dataset_accessor"):
        pytest.skip("this version has no accessors")
    mesh = pyvista.PolyData.from_regular_faces(VERTICES, FACES)
    made = mesh.spectral.remesh(points=300)
    assert np.array_equal(made.points, sr.remesh(VERTICES, FACES, points=300).vertices)
    assert mesh.spectral.sample(points=200).n_points == 200
    assert mesh.spectral.quality()["output"]["topology"]["vertices"] == len(VERTICES)


def test_meshio():
    meshio = pytest.importorskip("meshio")
    data = {"h": VERTICES[:, 2]}
    assert_like_arrays(meshio.Mesh(VERTICES, [("triangle", FACES)], point_data=data), attributes=data)
    squares = np.stack([FACES[:1800, 0], FACES[:1800, 1], FACES[:1800, 2], FACES[1800:, 2]], axis=1)
    mixed = meshio.Mesh(VERTICES, [("line", FACES[:5, :2]), ("quad", squares[:900]), ("quad", squares[900:])])
    remeshed = sr.remesh(mixed, points=300)
    assert euler(remeshed.faces) == 0 and remeshed.notes[0] == "line cells are left out"
    assert sr.remesh(meshio.Mesh(VERTICES, []), points=300).verified
    with pytest.raises(sr.ArgumentError, match="only tetra cells"):
        sr.remesh(meshio.Mesh(VERTICES, [("tetra", [[0, 1, 2, 3]])]), points=100)


def test_open3d():
    open3d = pytest.importorskip("open3d")
    of_vectors = open3d.utility.Vector3dVector
    mesh = open3d.geometry.TriangleMesh(of_vectors(VERTICES), open3d.utility.Vector3iVector(FACES))
    mesh.vertex_colors = of_vectors(COLORS[:, :3] / 255)
    assert_like_arrays(mesh, attributes={"color": COLORS[:, :3] / 255})
    tensors = open3d.t.geometry.TriangleMesh.from_legacy(mesh)
    assert len(sr.remesh(tensors, points=300).vertices) == 300
    cloud = open3d.geometry.PointCloud(of_vectors(VERTICES))
    expected = sr.remesh(VERTICES, points=300)
    assert np.array_equal(sr.remesh(cloud, points=300).vertices, expected.vertices)
    with pytest.raises(sr.ArgumentError, match="LineSet is not a mesh"):
        sr.remesh(open3d.geometry.LineSet(), points=100)
