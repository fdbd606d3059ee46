"""Triangle meshes as arrays, and their files."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Mesh:
    """Vertices of shape (V, 3), float64, and triangles of shape (F, 3), int64: indices of vertices."""
    vertices: np.ndarray
    triangles: np.ndarray

    def corners(self):
        """The places of the corners of all triangles: (F, 3, 3)."""
        return self.vertices[self.triangles]

    def used(self):
        """The same mesh without vertices that no triangle has."""
        kept, triangles = np.unique(self.triangles, return_inverse=True)
        return Mesh(self.vertices[kept], triangles.reshape(-1, 3))

    def welded(self):
        """The same mesh with vertices at exactly the same place as one, without triangles that vanish by that."""
        places, index = np.unique(self.vertices, axis=0, return_inverse=True)
        triangles = index.ravel()[self.triangles]
        proper = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
        return Mesh(places, triangles[proper]).used()

    def diagonal(self):
        """Diagonal of the bounding box of the vertices in use."""
        places = self.used().vertices
        return float(np.linalg.norm(places.max(axis=0) - places.min(axis=0))) if len(places) else 0.0

    def areas(self):
        """Areas of all triangles."""
        a, b, c = self.corners().transpose(1, 0, 2)
        return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)

    def volume(self):
        """What a closed mesh encloses; negative if its triangles look inwards."""
        a, b, c = (self.corners() - self.vertices.mean(axis=0)).transpose(1, 0, 2)
        return float(np.sum(a * np.cross(b, c)) / 6)

    def outward(self):
        """The same surface with triangles that look outwards, if it is closed and they do not (in files of scans they
        may look inwards)."""
        return Mesh(self.vertices, self.triangles[:, ::-1]) if self.volume() < 0 else self

    def split(self):
        """The same surface with each triangle split in four at the middles of its sides."""
        sides = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        ends, index = np.unique(sides, axis=0, return_inverse=True)
        a, b, c = self.triangles.T
        ab, bc, ca = (len(self.vertices) + index.reshape(-1, 3)).T
        parts = [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        return Mesh(np.concatenate([self.vertices, self.vertices[ends].mean(axis=1)]),
                    np.concatenate([np.stack(part, axis=1) for part in parts]))

    def normals(self):
        """Unit normals of the vertices: those of the triangles at each, weighted by area."""
        a, b, c = self.corners().transpose(1, 0, 2)
        sums = np.zeros_like(self.vertices)
        np.add.at(sums, self.triangles.ravel(), np.repeat(np.cross(b - a, c - a), 3, axis=0))
        return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)


def read(path):
    """Any file that MeshLab reads, without the vertices that no triangle uses. MeshLab's reader, because it knows
    polygons and strips, keeps doubles, and makes one vertex of the corners of STL facets at one place."""
    import pymeshlab
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(path)
    found = meshes.current_mesh()
    return Mesh(found.vertex_matrix(), found.face_matrix().astype(np.int64)).used()


def read_ply(path):
    """Reads what `write` wrote, and nothing else, so that peers need no other program to read their input."""
    with open(path, 'rb') as f:
        header = [line.decode('ascii').split() for line in iter(f.readline, b'end_header\n')]
        counts = {words[1]: int(words[2]) for words in header if words[0] == 'element'}
        vertices = np.fromfile(f, '<f8', 3 * counts['vertex']).reshape(-1, 3)
        triangles = np.fromfile(f, _FACE, counts['face'])['corners'].astype(np.int64)
    return Mesh(vertices, triangles)


def write(path, mesh):
    """Binary PLY, little endian, of doubles."""
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
    """Binary PLY of points without triangles, with their unit normals where they are given."""
    names = 'x y z nx ny nz'.split()[:3 if normals is None else 6]
    lines = ['ply', 'format binary_little_endian 1.0', 'element vertex %d' % len(points)]
    lines += ['property double ' + name for name in names] + ['end_header', '']
    columns = points if normals is None else np.concatenate([points, normals], axis=1)
    with open(path, 'wb') as f:
        f.write('\n'.join(lines).encode('ascii'))
        f.write(np.ascontiguousarray(columns, '<f8').tobytes())
