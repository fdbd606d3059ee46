"""Quality of triangles, by the measures of the paper's Table 1 and a few more.

With area S, half perimeter p and longest edge h of a triangle,

    Q = 6 S / (√3 p h)

is 1 if the triangle is equilateral and 0 if it has no area. θmin is the smallest angle. A triangle without area has the
angles 0, 0 and 180.
"""

import numpy as np


def shape(mesh):
    """Returns the measures over all triangles; angles in degrees, lengths in the units of the mesh."""
    if not len(mesh.triangles):
        return None
    sides, areas = side_lengths(mesh), mesh.areas()
    smallest, largest = extreme_angles(mesh)
    quality = qualities(sides, areas)
    return {
        'theta_min': float(smallest.min()),
        'theta_min_mean': float(smallest.mean()),
        'theta_max': float(largest.max()),
        'q_min': float(quality.min()),
        'q_mean': float(quality.mean()),
        'percent_below_30': float(100 * np.mean(smallest < 30)),
        'percent_above_90': float(100 * np.mean(largest > 90)),
        'edge_mean': float(sides.mean()),
        'edge_cv': float(sides.std() / sides.mean()),
    }


def side_lengths(mesh):
    """Returns the lengths of the three sides of each triangle, (F, 3); side i is opposite corner i."""
    corners = mesh.corners()
    return np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)


def extreme_angles(mesh):
    """Returns the smallest and the largest angle of each triangle in degrees."""
    corners, doubled = mesh.corners(), 2 * mesh.areas()
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    # By the tangent, because sine or cosine alone loses half of its digits near 90 or 0 degrees.
    angles = np.degrees(np.arctan2(doubled[:, None], np.sum(ahead * behind, axis=2)))
    flat = doubled == 0
    return np.where(flat, 0.0, angles.min(axis=1)), np.where(flat, 180.0, angles.max(axis=1))


def qualities(sides, areas):
    """Returns Q of each triangle."""
    bound = 3 ** 0.5 * (sides.sum(axis=1) / 2) * sides.max(axis=1)
    return np.divide(6 * areas, bound, out=np.zeros(len(areas)), where=bound > 0)
