"""MeshLib's remeshing with its final relaxation."""

import math

from .. import mesh
from . import edge_length

LABEL = 'MeshLib'
PACKAGE = 'meshlib'
SETTINGS = '`remesh` with `finalRelaxIters=10`, `finalRelaxNoShrinkage` and `projectOnOriginalMesh`, edge length ' \
    'tuned to the count; CAD parts with creases of 45 degrees (`findCreaseEdges`) as `notFlippable`'
COUNTS = False


def load(path):
    import meshlib.mrmeshnumpy as arrays
    import meshlib.mrmeshpy  # noqa: F401
    found = mesh.read_ply(path)
    return found, arrays.meshFromFacesVerts(found.triangles, found.vertices)


def remesh(model, wanted, sharp):
    import meshlib.mrmeshpy as mr
    given, own = model
    settings = mr.RemeshSettings()
    settings.targetEdgeLen = edge_length(given, wanted)
    # The default limits the number of splits, and so the number of vertices.
    settings.maxEdgeSplits = 10_000_000
    settings.finalRelaxIters = 10
    settings.finalRelaxNoShrinkage = True
    settings.projectOnOriginalMesh = True
    settings.packMesh = True
    if sharp:
        settings.notFlippable = own.findCreaseEdges(math.radians(45))
    mr.remesh(own, settings)
    return own


def save(own, path):
    import meshlib.mrmeshnumpy as arrays
    mesh.write(path, mesh.Mesh(arrays.getNumpyVerts(own), arrays.getNumpyFaces(own.topology)).used())
