"""MeshLab's isotropic explicit remeshing."""

from .. import mesh
from . import edge_length

LABEL = 'MeshLab'
PACKAGE = 'pymeshlab'
SETTINGS = '`meshing_isotropic_explicit_remeshing`, 10 iterations (its default), edge length tuned to the count; it ' \
    'keeps creases of 30 degrees by default'
COUNTS = False


def load(path):
    import pymeshlab
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(path)
    return meshes


def remesh(meshes, wanted, _sharp):
    import pymeshlab
    found = meshes.current_mesh()
    length = edge_length(mesh.Mesh(found.vertex_matrix(), found.face_matrix()), wanted)
    meshes.meshing_isotropic_explicit_remeshing(iterations=10, targetlen=pymeshlab.PureValue(length))
    return meshes


def save(meshes, path):
    found = meshes.current_mesh()
    mesh.write(path, mesh.Mesh(found.vertex_matrix(), found.face_matrix()))
