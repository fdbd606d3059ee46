"""MeshLab's Poisson-disk samples, triangulated by ball pivoting."""

from .meshlab import PACKAGE, load, save  # noqa: F401

LABEL = 'Poisson + ball pivoting'
SETTINGS = 'MeshLab, `generate_sampling_poisson_disk` with `exactnumflag`, then ' \
    '`generate_surface_reconstruction_ball_pivoting` with the radius that it finds itself'
COUNTS = True


def remesh(meshes, wanted, _sharp):
    meshes.generate_sampling_poisson_disk(samplenum=wanted, exactnumflag=True)
    meshes.generate_surface_reconstruction_ball_pivoting()
    return meshes
