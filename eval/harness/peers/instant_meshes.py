"""Instant Meshes (Jakob and others, 2015) for triangles, through pynanoinstantmeshes."""

import numpy as np

from .. import mesh

LABEL = 'Instant Meshes'
PACKAGE = 'pynanoinstantmeshes'
SETTINGS = '`rosy=6, posy=3` (triangles), `deterministic`; CAD parts with `creaseAngle=30`'
COUNTS = True


def load(path):
    import pynanoinstantmeshes  # noqa: F401
    found = mesh.read_ply(path)
    return found.vertices.astype(np.float32), found.triangles.astype(np.uint32)


def remesh(model, wanted, sharp):
    import pynanoinstantmeshes
    return pynanoinstantmeshes.remesh(*model, vertex_count=wanted, rosy=6, posy=3, deterministic=True,
                                      creaseAngle=30.0 if sharp else 0.0)


def save(model, path):
    mesh.write(path, mesh.Mesh(*model).used())
