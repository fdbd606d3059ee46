// CGAL's isotropic remeshing as a program: cgal SOURCE.ply TARGET.ply VERTICES [sharp]
//
// The edge length is that with which so many vertices at hexagonal packing fill the area. With `sharp`, edges of more
// than 60 degrees stay: they are split to the edge length first and then protected, as the manual asks. Prints the
// seconds of remeshing alone as JSON.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace PMP = CGAL::Polygon_mesh_processing;

static void remesh(Mesh& mesh, double length, bool sharp) {
    if (!sharp) {
        PMP::isotropic_remeshing(faces(mesh), length, mesh, CGAL::parameters::number_of_iterations(10));
        return;
    }
    auto kept = mesh.add_property_map<Mesh::Edge_index, bool>("e:kept", false).first;
    PMP::detect_sharp_edges(mesh, 60, kept);
    std::vector<Mesh::Edge_index> edges;
    for (auto edge : mesh.edges())
        if (kept[edge]) edges.push_back(edge);
    PMP::split_long_edges(edges, length, mesh, CGAL::parameters::edge_is_constrained_map(kept));
    PMP::isotropic_remeshing(faces(mesh), length, mesh,
                             CGAL::parameters::number_of_iterations(10)
                                 .edge_is_constrained_map(kept)
                                 .protect_constraints(true));
}

int main(int count, char** words) {
    if (count == 2 && std::string(words[1]) == "--version") {
        std::cout << CGAL_VERSION_STR << "\n";
        return 0;
    }
    Mesh mesh;
    if (count < 4 || !PMP::IO::read_polygon_mesh(words[1], mesh)) {
        std::cerr << "cgal: no oriented manifold can be read\n";
        return 1;
    }
    const double length = std::sqrt(2 * PMP::area(mesh) / (std::sqrt(3.0) * std::atof(words[3])));
    const auto start = std::chrono::steady_clock::now();
    remesh(mesh, length, count > 4);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    mesh.collect_garbage();
    std::ofstream file(words[2], std::ios::binary);
    CGAL::IO::set_binary_mode(file);
    CGAL::IO::write_PLY(file, mesh);
    std::cout << "{\"seconds\": " << taken.count() << "}\n";
    return file ? 0 : 1;
}
