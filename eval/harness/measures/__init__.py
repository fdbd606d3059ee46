"""Measures of meshes, written for this harness alone: none of it is the code of a program that is measured."""

from .crossings import crossing_faces
from .distance import distances
from .shape import shape
from .topology import inside_out, topology

SAMPLES = 100_000


def measure(mesh, reference, seed=0):
    """All measures of a mesh that is to be `reference` with other triangles, as what JSON can hold."""
    found, wanted = topology(mesh), topology(reference)
    kind = ('euler', 'components', 'boundary_loops')
    return {
        'topology': found,
        'reference': {key: wanted[key] for key in kind},
        'same_topology': all(found[key] == wanted[key] for key in kind),
        'inside_out': inside_out(mesh, reference),
        'shape': shape(mesh),
        'crossing_faces': crossing_faces(mesh),
        'distance': distances(mesh, reference, SAMPLES, seed),
    }
