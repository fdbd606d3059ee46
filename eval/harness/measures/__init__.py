"""Measures of meshes, written for this harness: they share no code with the programs that are measured."""

from . import crossings, distance, shape, sharp_edges, topology

SAMPLES = 100_000


def measure(mesh, reference, seed=0, sharp=False):
    """Returns all measures of a remeshing of `reference`, as JSON-compatible values; with `sharp`, also those of the
    sharp edges."""
    found, wanted = topology.topology(mesh), topology.topology(reference)
    closed = found['boundary_loops'] == wanted['boundary_loops'] == 0
    kind = ('euler', 'components', 'boundary_loops')
    measures = {
        'topology': found,
        'reference': {key: wanted[key] for key in kind} | {'manifold': topology.is_manifold(wanted)},
        'same_topology': all(found[key] == wanted[key] for key in kind),
        'inside_out': closed and mesh.volume() * reference.volume() < 0,
        'shape': shape.shape(mesh),
        'crossing_faces': crossings.crossing_faces(mesh),
        'distance': distance.distances(mesh, reference, SAMPLES, seed),
    }
    if sharp:
        measures['sharp_edges'] = sharp_edges.distances(mesh, reference, SAMPLES, seed)
    return measures
