"""Remeshing by spectral sampling: exactly the requested number of vertices, well-shaped triangles, the input's topology.

    import spectral_remesh
    import trimesh

    mesh = trimesh.load_mesh("scan.ply")
    remeshed = spectral_remesh.remesh(mesh, points=20_000)
    remeshed.to_trimesh().show()

Lengths are in the units of the input, angles in degrees.
"""

from ._errors import ArgumentError, FileError, FormatError, MeshError, NotVerifiedError, SpectralRemeshError
from ._files import read, write
from ._jobs import levels, quality, reconstruct, remesh, sample
from ._mesh import Mesh, Origin, Reconstructed, Remeshed, Report, Sampled
from ._native import __version__

__all__ = [
    "ArgumentError",
    "FileError",
    "FormatError",
    "Mesh",
    "MeshError",
    "NotVerifiedError",
    "Origin",
    "Reconstructed",
    "Remeshed",
    "Report",
    "Sampled",
    "SpectralRemeshError",
    "__version__",
    "levels",
    "quality",
    "read",
    "reconstruct",
    "remesh",
    "sample",
    "write",
]
