"""MeshLib's remeshing with its final relaxation."""

from .. import mesh
from . import edge_length

LABEL = 'MeshLib'
PACKAGE = 'meshlib'
SETTINGS = '`remesh` with `finalRelaxIters=10`, `finalRelaxNoShrinkage` and `projectOnOriginalMesh`, edge length ' \
    'tuned to the count'
COUNTS = False


def load(path):
    import meshlib.mrmeshnumpy as arrays
    import meshlib.mrmeshpy  # noqa: F401
    found = mesh.read_ply(path)
    return found, arrays.meshFromFacesVerts(found.triangles, found.vertices)


def remesh(model, wanted, _sharp):
    import meshlib.mrmeshpy as mr
    given, own = model
    settings = mr.RemeshSettings()
    settings.targetEdgeLen = edge_length(given, wanted)
    # The default bounds the splits, and so the vertices.
    settings.maxEdgeSplits = 10_000_000
    settings.finalRelaxIters = 10
    settings.finalRelaxNoShrinkage = True
    settings.projectOnOriginalMesh = True
    settings.packMesh = True
    mr.remesh(own, settings)
    return own


def save(own, path):
    import meshlib.mrmeshnumpy as arrays
    mesh.write(path, mesh.Mesh(arrays.getNumpyVerts(own), arrays.getNumpyFaces(own.topology)).used())
