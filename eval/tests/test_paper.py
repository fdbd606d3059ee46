"""Checks the computations of the paper's experiments against known facts."""

import unittest

import numpy as np

from harness import kernel, points, subsampling, torus


class Kernel(unittest.TestCase):
    def test_one_neighbour_leaves_one_minus_the_square_of_its_kernel(self):
        s = kernel.measure(kernel.gaussian, np.array([[0.3, 0.4]]), np.zeros((1, 2)))
        self.assertAlmostEqual(s[0], 1 - np.exp(-0.5), places=12)

    def test_the_measure_is_the_distance_to_the_span(self):
        """In a finite-dimensional feature space, s is the part of a vector orthogonal to the others (appendix B)."""
        rng = np.random.default_rng(1)
        points, x = rng.normal(size=(3, 6)), rng.normal(size=(1, 6))
        across = x[0] - points.T @ np.linalg.lstsq(points.T, x[0], rcond=None)[0]
        expected = across @ across / (x[0] @ x[0])
        self.assertAlmostEqual(kernel.measure(lambda a, b: a @ b.T, points, x)[0], expected, places=12)

    def test_no_neighbour_raises_it(self):
        rng = np.random.default_rng(2)
        values = kernel.measure_by_neighbours(kernel.gaussian, rng.random((12, 3)), rng.random(3))
        self.assertTrue(np.all(np.diff(values) < 1e-10))

    def test_heat_on_a_sphere_is_conserved_and_nearly_that_of_the_plane_at_once(self):
        rng = np.random.default_rng(3)
        places = rng.normal(size=(20_000, 3))
        places /= np.linalg.norm(places, axis=1, keepdims=True)
        pole = np.array([[0.0, 0.0, 1.0]])
        self.assertAlmostEqual(4 * np.pi * kernel.heat_kernel_of_sphere(pole, places, 0.5).mean(), 1, places=1)
        of_plane = kernel.heat_kernel_of_plane(np.zeros((1, 2)), np.zeros((1, 2)), 0.01)[0, 0]
        self.assertLess(abs(kernel.heat_kernel_of_sphere(pole, pole, 0.01)[0, 0] / of_plane - 1), 0.01)


class Subsets(unittest.TestCase):
    def setUp(self):
        """A plane with one bump, at the last point."""
        rng = np.random.default_rng(4)
        self.plane = np.concatenate([10 * rng.random((900, 2)), np.zeros((900, 1))], axis=1)
        self.up = np.tile([0.0, 0.0, 1.0], (900, 1))
        self.bump = np.concatenate([self.plane, [[5.0, 5.0, 0.5]]])

    def test_a_plane_stays_one_and_the_point_off_it_stays(self):
        for remove in (subsampling.remove_nearest_to_surface, subsampling.remove_least_of_kernels):
            kept = remove(self.plane, self.up, 300, 0.7)
            self.assertEqual(len(np.unique(kept)), 300)
            with self.subTest(remove.__name__):
                kept = remove(self.bump, np.concatenate([self.up, self.up[:1]]), 300, 0.7)
                self.assertIn(900, kept)

    def test_contributions_on_a_plane_are_zero(self):
        """On a plane with noise in one half, points of the other half are removed first."""
        plane = self.plane.copy()
        left = plane[:, 0] < 5
        plane[left, 2] += 0.1 * np.random.default_rng(5).normal(size=left.sum())
        kept = subsampling.remove_nearest_to_surface(plane, self.up, 600, 0.7)
        self.assertLess(left.mean() + 0.15, left[kept].mean())

    def test_changes_that_are_kept_up_are_those_worked_out_anew(self):
        """After removals, AS has the same contributions as a fresh start: the same points are removed next."""
        rng = np.random.default_rng(6)
        points = self.plane + 0.1 * rng.normal(size=self.plane.shape) * [0, 0, 1]
        remove = subsampling.remove_nearest_to_surface
        half = remove(points, self.up, 700, 0.7)
        at_once = remove(points, self.up, 600, 0.7)
        again = half[remove(points[half], self.up[half], 600, 0.7)]
        np.testing.assert_array_equal(at_once, again)

    def test_voxels_and_random_points_are_as_many_as_wanted(self):
        self.assertLess(abs(len(subsampling.voxel_subset(self.plane, 200)) / 200 - 1), 0.1)
        self.assertEqual(len(np.unique(subsampling.random_subset(900, 200, 0))), 200)


class Torus(unittest.TestCase):
    def test_lloyds_method_lowers_the_energy(self):
        points = np.random.default_rng(7).random((300, 2))
        energies = []
        for _ in range(6):
            points, energy = torus.centroids(points)
            energies.append(energy)
        self.assertTrue(np.all(np.diff(energies) < 0))

    def test_a_square_lattice_is_its_own_centroids_and_has_its_energy(self):
        lattice = (np.stack(np.meshgrid(*2 * [np.arange(16)]), axis=2).reshape(-1, 2) + 0.5) / 16
        moved, energy = torus.centroids(lattice)
        np.testing.assert_allclose(moved, lattice, atol=1e-12)
        self.assertAlmostEqual(energy, 1 / 6 / 16 ** 2, places=12)
        # Half the spacing, relative to that of hexagonal packing.
        self.assertAlmostEqual(torus.radius(lattice), 0.5 / 16 * (2 * 3 ** 0.5 * 256) ** 0.5, places=12)

    def test_white_noise_has_power_one_everywhere(self):
        rng = np.random.default_rng(8)
        power = np.mean([torus.periodogram(rng.random((200, 2)), 20) for _ in range(20)], axis=0)
        mean, anisotropy = torus.rings(power)
        self.assertLess(np.abs(mean[3:] - 1).max(), 0.25)
        self.assertLess(np.abs(anisotropy[6:] + 10 * np.log10(20)).max(), 3)


class Points(unittest.TestCase):
    def test_noise_goes_along_normals_and_as_far_as_is_said(self):
        flat, up = np.zeros((4000, 3)), np.tile([0.0, 0.0, 1.0], (4000, 1))
        moved = points.noisy(flat, up, 0.2, seed=3)
        np.testing.assert_array_equal(moved[:, :2], 0)
        self.assertAlmostEqual(moved[:, 2].std(), 0.2, places=2)
        np.testing.assert_allclose(points.noisy(flat, up, 0.4, seed=3), 2 * moved)


if __name__ == '__main__':
    unittest.main()
