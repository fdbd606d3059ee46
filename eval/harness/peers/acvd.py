"""Approximated centroidal Voronoi diagrams (the paper's VR) by pyacvd."""

LABEL = 'pyacvd'
PACKAGE = 'pyacvd'
SETTINGS = 'subdivided until the input has ten vertices for each that is wanted, as its documentation advises for ' \
    'meshes that are not dense enough, then `cluster` and `create_mesh`'
COUNTS = True


def load(path):
    import pyvista
    from .. import mesh
    found = mesh.read_ply(path)
    return pyvista.PolyData.from_regular_faces(found.vertices, found.triangles)


def remesh(model, wanted, _sharp):
    import pyacvd
    clusters = pyacvd.Clustering(model)
    times, vertices = 0, model.n_points
    while vertices < 10 * wanted:
        times, vertices = times + 1, 4 * vertices
    if times:
        clusters.subdivide(times)
    clusters.cluster(wanted)
    return clusters.create_mesh()


def save(model, path):
    from .. import mesh
    mesh.write(path, mesh.Mesh(model.points, model.regular_faces))
