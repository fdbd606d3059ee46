"""Triangle meshes as arrays, and their files."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Mesh:
    """Vertices of shape (V, 3), float64, and triangles of shape (F, 3), int64 indices of vertices."""
    vertices: np.ndarray
    triangles: np.ndarray

    def corners(self):
        """Returns the positions of the corners of all triangles: (F, 3, 3)."""
        return self.vertices[self.triangles]

    def used(self):
        """Returns the same mesh without unused vertices."""
        kept, triangles = np.unique(self.triangles, return_inverse=True)
        return Mesh(self.vertices[kept], triangles.reshape(-1, 3))

    def welded(self):
        """Returns the mesh with coincident vertices merged, without the triangles that become degenerate by this."""
        places, index = np.unique(self.vertices, axis=0, return_inverse=True)
        triangles = index.ravel()[self.triangles]
        proper = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
        return Mesh(places, triangles[proper]).used()

    def diagonal(self):
        """Returns the diagonal of the bounding box of the used vertices."""
        places = self.used().vertices
        return float(np.linalg.norm(places.max(axis=0) - places.min(axis=0))) if len(places) else 0.0

    def areas(self):
        """Returns the areas of all triangles."""
        a, b, c = self.corners().transpose(1, 0, 2)
        return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)

    def volume(self):
        """Returns the volume enclosed by a closed mesh; negative if its triangles face inwards."""
        a, b, c = (self.corners() - self.vertices.mean(axis=0)).transpose(1, 0, 2)
        return float(np.sum(a * np.cross(b, c)) / 6)

    def outward(self):
        """Returns the same surface with triangles that face outwards, if it is closed (in scan files, they may face
        inwards)."""
        return Mesh(self.vertices, self.triangles[:, ::-1]) if self.volume() < 0 else self

    def split(self):
        """Returns the same surface with each triangle split into four at the midpoints of its sides."""
        sides = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        ends, index = np.unique(sides, axis=0, return_inverse=True)
        a, b, c = self.triangles.T
        ab, bc, ca = (len(self.vertices) + index.reshape(-1, 3)).T
        parts = [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        return Mesh(np.concatenate([self.vertices, self.vertices[ends].mean(axis=1)]),
                    np.concatenate([np.stack(part, axis=1) for part in parts]))

    def normals(self):
        """Returns unit normals of the vertices: means of the normals of adjacent triangles, weighted by area."""
        a, b, c = self.corners().transpose(1, 0, 2)
        sums = np.zeros_like(self.vertices)
        np.add.at(sums, self.triangles.ravel(), np.repeat(np.cross(b - a, c - a), 3, axis=0))
        return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)


def read(path):
    """Reads any file that MeshLab reads, without unused vertices. MeshLab's reader is used because it supports polygons
    and strips, keeps doubles, and merges coincident corners of STL facets."""
    import pymeshlab
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(path)
    found = meshes.current_mesh()
    return Mesh(found.vertex_matrix(), found.face_matrix().astype(np.int64)).used()


def read_ply(path):
    """Reads only files written by `write`, so that peers need no other program to read their input."""
    with open(path, 'rb') as f:
        header = [line.decode('ascii').split() for line in iter(f.readline, b'end_header\n')]
        counts = {words[1]: int(words[2]) for words in header if words[0] == 'element'}
        vertices = np.fromfile(f, '<f8', 3 * counts['vertex']).reshape(-1, 3)
        triangles = np.fromfile(f, _FACE, counts['face'])['corners'].astype(np.int64)
    return Mesh(vertices, triangles)


def write(path, mesh):
    """Writes binary little-endian PLY with doubles."""
    faces = np.empty(len(mesh.triangles), _FACE)
    faces['count'], faces['corners'] = 3, mesh.triangles
    with open(path, 'wb') as f:
        f.write(_HEADER % (len(mesh.vertices), len(faces)))
        f.write(np.ascontiguousarray(mesh.vertices, '<f8').tobytes())
        f.write(faces.tobytes())


_FACE = np.dtype([('count', 'u1'), ('corners', '<i4', 3)])
_HEADER = b'''ply
format binary_little_endian 1.0
element vertex %d
property double x
property double y
property double z
element face %d
property list uchar int vertex_indices
end_header
'''


def write_points(path, points, normals=None):
    """Writes points without triangles as binary PLY, with their unit normals if these are given."""
    names = 'x y z nx ny nz'.split()[:3 if normals is None else 6]
    lines = ['ply', 'format binary_little_endian 1.0', 'element vertex %d' % len(points)]
    lines += ['property double ' + name for name in names] + ['end_header', '']
    columns = points if normals is None else np.concatenate([points, normals], axis=1)
    with open(path, 'wb') as f:
        f.write('\n'.join(lines).encode('ascii'))
        f.write(np.ascontiguousarray(columns, '<f8').tobytes())
