"""Crossing faces: those that MeshLab selects as self-intersecting, if they pass through another selected face.

The selector alone also selects coplanar faces that share a corner, and faces that only touch: on flat sides of CAD
parts it finds hundreds that do not cross.
"""

import numpy as np

# Minimum depth by which crossing faces pass through each other, relative to the mesh's diagonal: less is contact.
CONTACT = 1e-6


def crossing_faces(mesh):
    """Returns the number of faces that cross another face."""
    import pymeshlab
    if not len(mesh.triangles):
        return 0
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.triangles.astype(np.int32)))
    meshes.apply_filter('compute_selection_by_self_intersections_per_face')
    corners = mesh.corners()[meshes.current_mesh().face_selection_array()]
    return int(np.sum(_crossed(corners, CONTACT * mesh.diagonal())))


def _crossed(corners, depth):
    """Returns which of the triangles (F, 3, 3) pass through another one."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    found = np.zeros(len(corners), bool)
    for face in range(len(corners)):
        near = np.all((low <= high[face]) & (high >= low[face]), axis=1)
        others = np.flatnonzero(near)
        through = others[_pierced(corners[face], corners[others], depth)]
        found[through] = True
        found[face] |= len(through) > 0
    return found


def _pierced(triangle, others, depth):
    """Returns which of the others a side of the triangle pierces, with both ends and the piercing point deeper than
    `depth`."""
    a = others[:, 0]
    normals = _unit(np.cross(others[:, 1] - a, others[:, 2] - a))
    heights = (triangle - a[:, None]) @ normals[:, :, None]
    found = np.zeros(len(others), bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        one, two = heights[:, i], heights[:, j]
        across = (np.minimum(one, two) < -depth) & (np.maximum(one, two) > depth)
        share = np.divide(one, one - two, out=np.zeros_like(one), where=across)
        place = triangle[i] + share * (triangle[j] - triangle[i])
        inside = across[:, 0]
        for k in range(3):
            side = others[:, (k + 1) % 3] - others[:, k]
            inside &= np.sum(_unit(np.cross(normals, side)) * (place - others[:, k]), axis=1) > depth
        found |= inside
    return found


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
