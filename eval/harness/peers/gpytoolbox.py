"""Botsch and Kobbelt's remeshing (2004) by gpytoolbox."""

from .. import mesh
from . import edge_length

LABEL = 'gpytoolbox'
PACKAGE = 'gpytoolbox'
SETTINGS = '`remesh_botsch`, 10 iterations (its default) with projection, edge length tuned to the count; CAD parts ' \
    'with `detect_feature_edges`'
COUNTS = False


def load(path):
    # Imported here, so that the import does not count as remeshing.
    import gpytoolbox  # noqa: F401
    return mesh.read_ply(path)


def remesh(model, wanted, sharp):
    import gpytoolbox
    length = edge_length(model, wanted)
    found = gpytoolbox.remesh_botsch(model.vertices, model.triangles, 10, length, True, detect_feature_edges=sharp)
    return mesh.Mesh(*found[:2])


def save(model, path):
    mesh.write(path, model)
