"""Checks `remesh quality` and MeshLab's own measures against the code of this harness on the models of data/."""

import json
import os
import subprocess
import tempfile
import unittest

import numpy as np
import pymeshlab

from harness import mesh
from harness.context import ROOT, Context
from harness.measures import crossings, distance, shape, sharp_edges, topology

DATA = os.path.join(ROOT, 'data')
MODELS = ['blob.obj', 'bracket.stl', 'noisy.ply', 'shell.off', 'terrain.ply']
SIX_DIGITS = 1e-6

# Models compared with each other, and the directions in which the farthest point is a vertex.
PAIRS = [('blob.obj', 'noisy.ply'), ('terrain.ply', 'shell.off'), ('bracket.stl', 'blob.obj')]
FARTHEST_VERTEX = [('blob.obj', 'out_to_in'), ('terrain.ply', 'out_to_in'), ('terrain.ply', 'in_to_out'),
                   ('bracket.stl', 'out_to_in'), ('bracket.stl', 'in_to_out')]


def data(name):
    return os.path.join(DATA, name)


def quality(path, against=None):
    """Returns the output of `remesh quality --json`."""
    command = [Context.binary, 'quality', path, '--json'] + (['--against', against] if against else [])
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def loaded(name):
    """Loads a model in MeshLab."""
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(data(name))
    return meshes


class RemeshQuality(unittest.TestCase):
    def close(self, got, wanted, what, share=SIX_DIGITS):
        self.assertLessEqual(abs(got - wanted), share * abs(wanted), '%s: %r and %r' % (what, got, wanted))

    def test_shape_to_six_digits(self):
        for name in MODELS:
            said, own = quality(data(name))['output']['shape'], shape.shape(mesh.read(data(name)))
            for key, value in own.items():
                self.close(said[key], value, '%s %s' % (name, key))

    def test_topology(self):
        for name in MODELS:
            said, own = quality(data(name))['output'], topology.topology(mesh.read(data(name)))
            for key in set(own) - {'degenerate_faces', 'percent_valence_6'}:
                self.assertEqual(said['topology'][key], own[key], '%s %s' % (name, key))
            self.close(said['shape']['percent_valence_6'], own['percent_valence_6'], name)

    def test_faulty_topology(self):
        """Two fans at a vertex, an edge with three faces, a flipped face, and two components."""
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [1, 1, 0.5]], float)
        faulty = {
            'two fans': [[0, 1, 2], [0, 4, 5]],
            'three faces': [[0, 1, 2], [1, 0, 3], [0, 1, 5]],
            'turned over': [[0, 1, 2], [1, 2, 6]],
            'two pieces': [[0, 1, 2], [3, 4, 5]],
        }
        with scratch() as folder:
            for what, faces in faulty.items():
                path = os.path.join(folder, 'faulty.ply')
                mesh.write(path, mesh.Mesh(corners, np.array(faces)).used())
                said, own = quality(path)['output']['topology'], topology.topology(mesh.read(path))
                for key in set(own) - {'degenerate_faces', 'percent_valence_6'}:
                    self.assertEqual(said[key], own[key], '%s: %s' % (what, key))

    def test_distance_of_lifted_plane_to_six_digits(self):
        """All points of a square are equally far from the same square lifted by h, so samples make no difference."""
        places = np.stack(np.meshgrid(np.linspace(0, 1, 8), np.linspace(0, 1, 8)), axis=-1).reshape(-1, 2)
        row = np.arange(7)[:, None] * 8 + np.arange(7)
        halves = [np.stack([row, row + 1, row + 9], -1), np.stack([row, row + 9, row + 8], -1)]
        faces = np.concatenate(halves).reshape(-1, 3)
        flat, lifted = (mesh.Mesh(np.column_stack([places, np.full(64, h)]), faces) for h in (0.0, 0.0123))
        with scratch() as folder:
            paths = [os.path.join(folder, name) for name in ('flat.ply', 'lifted.ply')]
            for path, one in zip(paths, (flat, lifted)):
                mesh.write(path, one)
            said = quality(paths[1], paths[0])['distance']
        own = distance.distances(lifted, flat, 1000)
        for key in set(own) - {'samples'}:
            self.close(own[key], 100 * 0.0123 / 2 ** 0.5, key)
            self.close(said[key], own[key], key)

    def test_rms_as_far_as_samples_go(self):
        """Both programs use different random points. With n of them, the relative error of the root mean square of d is
        about sd(d^2) / (2 rms^2 sqrt(n)); five times that, for both together, is allowed."""
        for name, other in PAIRS:
            said, own, ways = self.distances_of(name, other)
            for way, source, target in ways:
                random = distance.scattered(source, 20_000, np.random.default_rng(1))
                squares = distance.to_surface(distance.blended(source, source.vertices, random), target) ** 2
                noise = np.std(squares) / (2 * np.mean(squares)) * (1 / said['samples'] + 1 / own['samples']) ** 0.5
                self.close(said['rms_' + way], own['rms_' + way], '%s %s' % (name, way), 5 * noise)

    def test_hausdorff_distance(self):
        """If the farthest point is a vertex, nothing is random, and six digits agree. Otherwise, both distances depend
        on the samples, and are never less than that of the vertices."""
        exact = 0
        for name, other in PAIRS:
            said, own, ways = self.distances_of(name, other)
            for way, source, target in ways:
                what, key = '%s %s' % (name, way), 'hausdorff_' + way
                vertex = 100 * distance.to_surface(source.vertices, target).max() / mesh.read(data(other)).diagonal()
                self.assertGreaterEqual(min(own[key], said[key]), vertex * (1 - SIX_DIGITS), what)
                at_vertex = (name, way) in FARTHEST_VERTEX
                self.close(said[key], own[key], what, SIX_DIGITS if at_vertex else 0.02)
                exact += at_vertex
        self.assertEqual(exact, len(FARTHEST_VERTEX))

    def distances_of(self, name, other):
        """Returns the distances by the tool and by the harness, and both directions with their source and target."""
        one, two = mesh.read(data(name)), mesh.read(data(other))
        ways = [('out_to_in', one, two), ('in_to_out', two, one)]
        return quality(data(name), data(other))['distance'], distance.distances(one, two, 100_000), ways

    def test_exact_distance_to_a_triangle(self):
        """Points above the inside, beside an edge, and beyond a corner."""
        one = mesh.Mesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), np.array([[0, 1, 2]]))
        points = np.array([[0.2, 0.2, 0.5], [0.5, -2, 0], [-3, -4, 0], [1, 1, 0]], float)
        found = distance.to_surface(points, one)
        np.testing.assert_allclose(found, [0.5, 2, 5, 0.5 ** 0.5], rtol=1e-14)


class MeshLab(unittest.TestCase):
    """Compares with MeshLab's measures where it has them."""

    def test_counts(self):
        names = {'vertices_number': 'vertices', 'edges_number': 'edges', 'faces_number': 'faces',
                 'connected_components_number': 'components', 'number_holes': 'boundary_loops',
                 'non_two_manifold_edges': 'nonmanifold_edges', 'non_two_manifold_vertices': 'nonmanifold_vertices'}
        for name in MODELS:
            said, own = loaded(name).get_topological_measures(), topology.topology(mesh.read(data(name)))
            for theirs, ours in names.items():
                self.assertEqual(said[theirs], own[ours], '%s %s' % (name, ours))

    def test_genus_of_closed_models(self):
        for name in MODELS:
            said, own = loaded(name).get_topological_measures(), topology.topology(mesh.read(data(name)))
            if not own['boundary_loops']:
                self.assertEqual(own['euler'], 2 * own['components'] - 2 * said['genus'], name)

    def test_area_and_edges(self):
        for name in MODELS:
            said, read = loaded(name).get_geometric_measures(), mesh.read(data(name))
            np.testing.assert_allclose(read.areas().sum(), said['surface_area'], rtol=SIX_DIGITS, err_msg=name)
            if not topology.topology(read)['boundary_loops']:
                # On a closed mesh each edge has two sides, so the mean over edges equals the mean over sides.
                own = shape.shape(read)['edge_mean']
                np.testing.assert_allclose(own, said['avg_edge_length'], rtol=SIX_DIGITS, err_msg=name)

    def test_quality_by_the_radii(self):
        """MeshLab gives 2 r / R, with the inradius r = S / p and the circumradius R = abc / 4S. With it and the sides,
        Q = 6 S / (sqrt 3 p h) = 6 r / (sqrt 3 h). MeshLab stores floats, so thin triangles lose digits."""
        for name in MODELS:
            meshes, read = loaded(name), mesh.read(data(name))
            meshes.compute_scalar_by_aspect_ratio_per_face(metric='inradius/circumradius')
            sides, areas = shape.side_lengths(read), read.areas()
            outer = sides.prod(axis=1) / (4 * areas)
            inner = meshes.current_mesh().face_scalar_array() * outer / 2
            own = shape.qualities(sides, areas)
            np.testing.assert_allclose(own, 6 * inner / (3 ** 0.5 * sides.max(axis=1)), rtol=1e-4, err_msg=name)

    def test_crossing_faces(self):
        """MeshLab's selector, as used here, agrees with the tool's exact test on a model and a moved copy of it."""
        one = mesh.read(data('noisy.ply'))
        moved = one.vertices + np.array([0.31, 0.17, 0.05])
        both = mesh.Mesh(np.concatenate([one.vertices, moved]),
                         np.concatenate([one.triangles, one.triangles + len(moved)]))
        with scratch() as folder:
            path = os.path.join(folder, 'both.ply')
            mesh.write(path, both)
            said = len(quality(path)['crossings']['faces'])
        self.assertGreater(said, 100)
        self.assertEqual(said, crossings.crossing_faces(both))
        self.assertEqual(crossings.crossing_faces(one), 0)

    def test_distance_of_vertices(self):
        """MeshLab's filter uses the vertices as samples, which are the same for both programs."""
        for name, other in (('blob.obj', 'noisy.ply'), ('bracket.stl', 'blob.obj')):
            meshes = loaded(name)
            meshes.load_new_mesh(data(other))
            pair = [mesh.read(data(name)), mesh.read(data(other))]
            said = meshes.get_hausdorff_distance(sampledmesh=0, targetmesh=1, samplevert=True,
                                                 samplenum=len(pair[0].vertices), maxdist=pymeshlab.PureValue(1000))
            found = distance.to_surface(pair[0].vertices, pair[1])
            np.testing.assert_allclose(np.sqrt(np.mean(found ** 2)), said['RMS'], rtol=SIX_DIGITS, err_msg=name)
            np.testing.assert_allclose(found.max(), said['max'], rtol=SIX_DIGITS, err_msg=name)


class Crossings(unittest.TestCase):
    def faces(self, *corners):
        """Returns how many of these triangles cross, with coincident corners merged."""
        apart = mesh.Mesh(np.array(corners, float).reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
        return crossings.crossing_faces(apart.welded())

    def test_contact_is_not_crossing(self):
        """A triangle stands on another, passes through it by less than a millionth, and by more."""
        floor = [[0, 0, 0], [9, 0, 0], [0, 9, 0]]
        for foot, crossed in ((0, 0), (-1e-7, 0), (-1e-3, 2)):
            self.assertEqual(self.faces(floor, [[2, 2, foot], [3, 2, 4], [2, 3, 4]]), crossed, foot)

    def test_faces_beside_each_other_on_a_plane_do_not_cross(self):
        """Two faces of a flat side of the bracket, coplanar up to rounding, which only MeshLab's selector selects."""
        off = 6.000000000000011
        self.assertEqual(self.faces(
            [[6, 37.6329634874261, 70.9047726800772], [off, 36.54973154598351, 69.22048670252103],
             [6, 38.45054062863814, 69.30018740557034]],
            [[off, 34.78907304012136, 72.26638484772796], [off, 35.70922117187931, 70.76938233437825],
             [6, 36.809729611014355, 72.5204599210478]]), 0)


class SharpEdges(unittest.TestCase):
    def test_those_of_a_cube(self):
        """The twelve edges are sharp, the diagonals of the sides are not."""
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
        sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        cube = mesh.Mesh(corners, np.array([t for a, b, c, d in sides for t in ([a, b, c], [a, c, d])]))
        ends = corners[sharp_edges.sharp_edges(cube)]
        self.assertEqual(len(ends), 12)
        np.testing.assert_array_equal(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), 1)
        self.assertIsNone(sharp_edges.distances(cube, mesh.read(data('blob.obj')), 10))

    def test_an_edge_that_is_cut_off_is_as_far_as_the_cut(self):
        """Two squares at a right angle, and the same with their edge cut off by a flat strip at 0.1 from it."""
        def strip(profile):
            places = np.array([[x, y, z] for x, z in profile for y in (0, 1)], float)
            return mesh.Mesh(places, np.array([t for k in range(0, len(places) - 2, 2)
                                               for t in ([k, k + 2, k + 1], [k + 1, k + 2, k + 3])]))

        whole, cut = strip([(1, 0), (0, 0), (0, 1)]), strip([(1, 0), (0.1, 0), (0, 0.1), (0, 1)])
        for result, far in ((whole, 0), (cut, 0.1 / 2 ** 0.5)):
            found = sharp_edges.distances(result, whole, 100)
            for key in ('rms', 'largest'):
                self.assertAlmostEqual(found[key], 100 * far / 3 ** 0.5, places=12)


class Meshes(unittest.TestCase):
    def test_a_split_mesh_is_the_same_surface(self):
        whole = mesh.read(data('blob.obj'))
        split = whole.split()
        found, wanted = topology.topology(split), topology.topology(whole)
        self.assertEqual(len(split.triangles), 4 * len(whole.triangles))
        self.assertTrue(topology.is_manifold(found))
        self.assertEqual(found['euler'], wanted['euler'])
        self.assertAlmostEqual(split.areas().sum() / whole.areas().sum(), 1, places=12)
        self.assertAlmostEqual(split.volume() / whole.volume(), 1, places=12)


class Files(unittest.TestCase):
    def test_what_is_written_is_read(self):
        given = mesh.read(data('terrain.ply'))
        with scratch() as folder:
            path = os.path.join(folder, 'written.ply')
            mesh.write(path, given)
            for found in (mesh.read(path), mesh.read_ply(path)):
                np.testing.assert_array_equal(found.vertices, given.vertices)
                np.testing.assert_array_equal(found.triangles, given.triangles)


def scratch():
    return tempfile.TemporaryDirectory()


if __name__ == '__main__':
    unittest.main()
