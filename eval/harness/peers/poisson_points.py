"""MeshLab on a point cloud: a Poisson-disk subset of the points, triangulated by ball pivoting."""

from .meshlab import PACKAGE, load, save  # noqa: F401

LABEL = 'Poisson disks of the points + ball pivoting'
SETTINGS = 'MeshLab, `generate_sampling_poisson_disk` with `subsample` and `exactnumflag`, then ball pivoting with ' \
    'the radius that it finds itself; normals that are not given by `compute_normal_for_point_clouds`'
COUNTS = True


def remesh(meshes, wanted, _sharp):
    if not meshes.current_mesh().vertex_normal_matrix().any():
        meshes.compute_normal_for_point_clouds()
    meshes.generate_sampling_poisson_disk(samplenum=wanted, exactnumflag=True, subsample=True)
    meshes.generate_surface_reconstruction_ball_pivoting()
    return meshes
