"""Topology of a mesh: counts, Euler characteristic, components, boundaries, faults.

Triangles with two equal corners are counted but otherwise ignored. A mesh is manifold if no edge has more than two
triangles and the triangles at each vertex form one fan. It is oriented if no two triangles traverse their common edge
in the same direction.
"""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components


def topology(mesh):
    """Returns the same counts of a mesh as `remesh quality`, computed in a different way."""
    proper = np.all(mesh.triangles != np.roll(mesh.triangles, 1, axis=1), axis=1)
    sides = _Sides(mesh.triangles[proper])
    vertices, edges, faces = len(np.unique(sides.faces)), len(sides.edges), len(sides.faces)
    inner, valence = _interior_valences(sides)
    return {
        'vertices': vertices,
        'edges': edges,
        'faces': faces,
        'degenerate_faces': int(np.sum(~proper)),
        'euler': vertices - edges + faces,
        'components': _pieces(sides.edges),
        'boundary_loops': _pieces(sides.edges[sides.uses == 1]),
        'nonmanifold_edges': int(np.sum(sides.uses > 2)),
        'nonmanifold_vertices': _nonmanifold_vertices(sides),
        'misoriented_edges': int(np.sum((sides.uses == 2) & (sides.direction != 0))),
        'percent_valence_6': float(100 * np.mean(valence == 6)) if inner else None,
    }


def is_manifold(found):
    """Returns whether counts of `topology` are those of an oriented manifold."""
    faults = ('degenerate_faces', 'nonmanifold_edges', 'nonmanifold_vertices', 'misoriented_edges')
    return not any(found[key] for key in faults)


class _Sides:
    """The sides of all faces, and the edge of each side."""

    def __init__(self, faces):
        self.faces = faces
        ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
        ordered = np.sort(ends, axis=1)
        stride = int(faces.max(initial=0)) + 1
        keys, self.edge = np.unique(ordered[:, 0] * stride + ordered[:, 1], return_inverse=True)
        self.edges = np.stack([keys // stride, keys % stride], axis=1)
        self.uses = np.bincount(self.edge, minlength=len(keys))
        ahead = np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0)
        self.direction = np.bincount(self.edge, weights=ahead, minlength=len(keys))


def _labels(pairs, size):
    """Returns the component of each of `size` nodes, which are joined in pairs."""
    graph = coo_matrix((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    return connected_components(graph, directed=False)[1]


def _pieces(edges):
    """Returns the number of connected components of edges that meet at vertices: of a surface if given all edges, of
    its boundary if given the edges with one face."""
    vertices, ends = np.unique(edges, return_inverse=True)
    return len(np.unique(_labels(ends.reshape(-1, 2), len(vertices)))) if len(vertices) else 0


def _nonmanifold_vertices(sides):
    """Returns the number of vertices whose face corners, joined where they share an edge, form several fans."""
    corners = 3 * len(sides.faces)
    # Corner i of a face is one end of its side i, and the other end of its side i - 1.
    here = sides.faces.ravel()
    after = sides.edge
    before = np.roll(sides.edge.reshape(-1, 3), 1, axis=1).ravel()

    def end(edge):
        return corners + 2 * edge + (sides.edges[edge, 1] == here)

    corner = np.arange(corners)
    pairs = np.concatenate([np.stack([corner, end(after)], axis=1), np.stack([corner, end(before)], axis=1)])
    fans = _labels(pairs, corners + 2 * len(sides.edges))[:corners]
    at = np.unique(np.stack([here, fans], axis=1), axis=0)[:, 0]
    return int(np.sum(np.bincount(at) > 1)) if len(at) else 0


def _interior_valences(sides):
    """Returns the number of vertices with two faces at each of their edges, and the valences of these vertices."""
    size = int(sides.faces.max(initial=-1)) + 1
    valence = np.bincount(sides.edges.ravel(), minlength=size)
    rim = np.zeros(size, bool)
    rim[sides.edges[sides.uses != 2]] = True
    inner = (valence > 0) & ~rim
    return int(np.sum(inner)), valence[inner]
