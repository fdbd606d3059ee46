"""The operator remeshes objects without an interface."""

import bpy
import numpy as np
import pytest
from mathutils.bvhtree import BVHTree
from objects import corners, imported, lengths, numbers, places, set_weights, state, suzanne, weights

import spectral_remesh


def remesh(obj, **settings):
    """Runs the operator on an object, and returns the result, which is then the active object."""
    for name, value in settings.items():
        setattr(bpy.context.scene.spectral_remesh, name, value)
    bpy.context.view_layer.objects.active = obj
    before = state(obj)
    assert bpy.ops.object.spectral_remesh() == {"FINISHED"}
    assert state(obj) == before
    made = bpy.context.object
    assert made is not obj and made.name.startswith(f"{obj.name}.remeshed")
    return made


def measured(obj):
    return spectral_remesh.quality(places(obj.data), corners(obj.data))


def test_suzanne_has_exactly_as_many_vertices_and_good_triangles(capfd):
    original = suzanne()
    made = remesh(original, points=4000)
    assert len(made.data.vertices) == 4000
    report = measured(made)
    smallest = report["output"]["shape"]["theta_min"]
    assert smallest > 35
    assert f"4,000 vertices, smallest angle {smallest:.0f}°, verified" in capfd.readouterr().out
    assert not made.data.validate()
    # The head and the eyes, as before.
    topology = report["output"]["topology"]
    before = spectral_remesh.quality(*triangulated(original))["output"]["topology"]
    for member in ("euler", "components", "boundary_loops"):
        assert topology[member] == before[member]
    assert not any(topology[fault] for fault in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges"))
    assert report["output"]["shape"]["theta_min_mean"] > 53
    far = [BVHTree.FromObject(original, bpy.context.evaluated_depsgraph_get()).find_nearest(v.co)[3] for v in made.data.vertices]
    assert max(far) < 0.03


def triangulated(obj):
    obj.data.calc_loop_triangles()
    return places(obj.data), numbers(obj.data.loop_triangles, "vertices", 3, np.int32)


def test_what_suzanne_has_arrives():
    made = remesh(suzanne(), points=4000)
    mesh = made.data
    at = places(mesh)
    colors = numbers(mesh.attributes["Places"].data, "color", 4)
    assert mesh.attributes["Places"].data_type == "FLOAT_COLOR" and mesh.attributes["Places"].domain == "POINT"
    assert np.abs(4 * (colors[:, :3] - 0.5) - at).max() < 0.05 and (colors[:, 3] > 0.999).all()
    paint = numbers(mesh.attributes["Paint"].data, "color", 4)
    assert mesh.attributes["Paint"].data_type == "BYTE_COLOR"
    assert np.abs(4 * (paint[:, :3] - 0.5) - at).max() < 0.1
    assert np.abs(numbers(mesh.attributes["Depth"].data, "value") - at[:, 1]).max() < 0.05
    numbered = numbers(mesh.attributes["Number"].data, "value", 1, np.int32)
    assert set(numbered) == {3, 7} and ((numbered == 7) == (at[:, 2] > 0)).mean() > 0.98
    assert np.abs(weights(made, "high") - np.clip((at[:, 2] + 1) / 2, 0, 1)).max() < 0.03
    assert [material.name for material in mesh.materials] == ["left", "right"]
    middles = numbers(mesh.polygons, "center", 3)
    chosen = numbers(mesh.polygons, "material_index", 1, np.int32)
    assert ((chosen == 1) == (middles[:, 0] > 0)).mean() > 0.97
    assert numbers(mesh.polygons, "use_smooth", 1, bool).all()
    assert [layer.name for layer in mesh.uv_layers] == ["UVMap"]


def test_uv_maps_are_where_they_were(data):
    original = imported(data / "terrain.ply")
    at = places(original.data)
    low, high = at.min(axis=0), at.max(axis=0)
    layer = original.data.uv_layers.new(name="Map")
    spread = ((at - low) / (high - low))[:, :2]
    layer.uv.foreach_set("vector", spread[numbers(original.data.loops, "vertex_index", 1, np.int32)].ravel())
    made = remesh(original, points=2500)
    assert len(made.data.vertices) == 2500
    there = ((places(made.data) - low) / (high - low))[:, :2][corners(made.data)].reshape(-1, 2)
    found = numbers(made.data.uv_layers["Map"].uv, "vector", 2)
    assert np.abs(found - there).max() < 0.01


def test_sharp_edges_of_a_part_stay_and_are_marked(data):
    bpy.ops.mesh.primitive_cube_add(size=1)
    cube = remesh(bpy.context.object, points=600)
    sharp = numbers(cube.data.edges, "use_edge_sharp", 1, bool)
    assert lengths(cube)[sharp].sum() == pytest.approx(12, abs=1e-4)
    bracket = remesh(imported(data / "bracket.stl"), points=2000)
    sharp = numbers(bracket.data.edges, "use_edge_sharp", 1, bool)
    assert measured(bracket)["output"]["shape"]["theta_min"] > 15 and sharp.sum() > 200
    bpy.ops.mesh.primitive_cube_add(size=1)
    rounded = remesh(bpy.context.object, points=600, features="NONE")
    assert not numbers(rounded.data.edges, "use_edge_sharp", 1, bool).any()
    by_angle = remesh(imported(data / "bracket.stl"), points=2000, features="ANGLE", angle=np.radians(60))
    assert numbers(by_angle.data.edges, "use_edge_sharp", 1, bool).sum() > 100


def test_edges_marked_sharp_are_kept_and_no_others():
    bpy.ops.mesh.primitive_cube_add(size=1)
    cube = bpy.context.object
    at = places(cube.data)
    ends = numbers(cube.data.edges, "vertices", 2, np.int32)
    cube.data.edges.foreach_set("use_edge_sharp", (at[ends][:, :, 2] > 0).all(axis=1))
    made = remesh(cube, points=600, features="MARKED")
    sharp = numbers(made.data.edges, "use_edge_sharp", 1, bool)
    kept = places(made.data)[numbers(made.data.edges, "vertices", 2, np.int32)[sharp]]
    assert lengths(made)[sharp].sum() == pytest.approx(4, abs=1e-4) and np.allclose(kept[:, :, 2], 0.5)


def test_outside_of_a_mask_nothing_changes(data):
    original = imported(data / "blob.obj")
    at = places(original.data)
    set_weights(original, "part", at[:, 0] > 0.5)
    made = remesh(original, points=800, mask_group="part")
    outside = {tuple(p) for p in at[at[:, 0] <= 0.5]}
    assert outside <= {tuple(p) for p in places(made.data)}


def test_a_group_makes_edges_shorter(data):
    original = imported(data / "blob.obj")
    set_weights(original, "fine", places(original.data)[:, 0] > 0)
    made = remesh(original, points=4000, grading="GROUP", sizing_group="fine", finer=3)
    assert len(made.data.vertices) == 4000
    ends = places(made.data)[numbers(made.data.edges, "vertices", 2, np.int32)]
    x = ends.mean(axis=1)[:, 0]
    coarse, fine = (np.median(lengths(made)[side]) for side in (x < -0.5, x > 0.3))
    assert 2.5 < coarse / fine < 3.5


def test_lengths_follow_the_shape():
    even = remesh(suzanne(), points=3000)
    graded = remesh(suzanne(), points=3000, grading="SHAPE")
    spread = [np.std(lengths(obj)) / np.mean(lengths(obj)) for obj in (even, graded)]
    assert spread[1] > 1.5 * spread[0]


def test_edge_lengths_are_those_of_the_scene():
    original = suzanne()
    original.scale = (2, 3, 1.5)
    bpy.context.view_layer.update()
    made = remesh(original, density="LENGTH", edge_length=0.1)
    assert np.mean(lengths(made)) == pytest.approx(0.1, rel=0.03)
    assert tuple(made.scale) == (2, 3, 1.5)


def test_the_original_is_hidden_if_that_is_wanted():
    original = suzanne()
    made = remesh(original, points=1000)
    assert original.hide_get() and not made.hide_get() and made.select_get() and not original.select_get()
    original.hide_set(False)
    remesh(original, points=1000, hide_original=False)
    assert not original.hide_get()


def test_modifiers_and_parents_stay_with_the_copy():
    original = suzanne()
    original.modifiers.new("Smoother", "SUBSURF")
    original.parent = bpy.data.objects.new("parent", None)
    made = remesh(original, points=1000)
    assert [m.name for m in made.modifiers] == ["Smoother"] and made.parent is original.parent
    assert len(made.data.vertices) == 1000


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"mask_group": "none"}, "no vertex group 'none'"),
        ({"grading": "GROUP"}, "no vertex group ''"),
        ({"mask_group": "nothing"}, "no triangle"),
    ],
)
def test_errors_are_plain(settings, said):
    obj = suzanne()
    obj.vertex_groups.new(name="nothing")
    for name, value in settings.items():
        setattr(bpy.context.scene.spectral_remesh, name, value)
    count = len(bpy.data.objects), len(bpy.data.meshes)
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.object.spectral_remesh()
    assert (len(bpy.data.objects), len(bpy.data.meshes)) == count


def test_no_faces_and_no_mesh_are_refused():
    bpy.context.collection.objects.link(obj := bpy.data.objects.new("empty", bpy.data.meshes.new("empty")))
    bpy.context.view_layer.objects.active = obj
    with pytest.raises(RuntimeError, match="has no faces"):
        bpy.ops.object.spectral_remesh()
    bpy.context.collection.objects.link(obj := bpy.data.objects.new("light", bpy.data.lights.new("light", "POINT")))
    bpy.context.view_layer.objects.active = obj
    with pytest.raises(RuntimeError, match="Select a mesh"):
        bpy.ops.object.spectral_remesh()
