"""Faces that cross each other, by MeshLab's selector of self-intersecting faces."""

import numpy as np


def crossing_faces(mesh):
    """How many faces cross another one."""
    import pymeshlab
    if not len(mesh.triangles):
        return 0
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.triangles.astype(np.int32)))
    meshes.apply_filter('compute_selection_by_self_intersections_per_face')
    return int(meshes.current_mesh().selected_face_number())
