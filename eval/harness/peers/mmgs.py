"""mmgs of Mmg, the surface remesher of Dapogny, Dobrzynski and Frey (2014), through mmgpy."""

from .. import mesh
from . import edge_length

LABEL = 'mmgs'
PACKAGE = 'mmgpy'
SETTINGS = '`hsiz` tuned to the count; `hausd`, which its documentation wants scaled to the model, 1 % of the ' \
    'diagonal, as smaller bounds take more vertices than wanted; ridges of 45 degrees stay by default'
COUNTS = False


def load(path):
    import mmgpy  # noqa: F401
    return mesh.read_ply(path)


def remesh(model, wanted, _sharp):
    import mmgpy
    found = mmgpy.MmgMeshS(model.vertices, model.triangles)
    found.remesh(hsiz=edge_length(model, wanted), hausd=0.01 * model.diagonal(), verbose=-1)
    return found


def save(model, path):
    mesh.write(path, mesh.Mesh(model.get_vertices(), model.get_triangles()))
