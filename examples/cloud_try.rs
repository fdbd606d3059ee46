use glam::DVec3;
use spectral_remesh::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let with_normals = a.get(3).is_some_and(|x| x == "n");
    let l = io::file::read_file(std::path::Path::new(&a[1]), None).unwrap();
    let mesh = surface::repair::repair(&l.mesh).0;
    let t0 = surface::topology::topology(mesh.positions.len(), &mesh.triangles);
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for (t, c) in mesh.triangles.iter().enumerate() {
        for &v in c {
            normals[v as usize] += mesh.area_vector(t);
        }
    }
    let normals: Vec<DVec3> = normals.iter().map(|n| n.normalize_or_zero()).collect();
    let pts =
        Points { positions: mesh.positions.clone(), normals: if with_normals { normals.clone() } else { vec![] } };
    let t = std::time::Instant::now();
    let made = remesh::mesh_of_points(&pts, &Default::default(), &()).unwrap();
    let m = made.mesh;
    eprintln!("{:?}", made.summary);
    println!("{:?}", t.elapsed());
    let t1 = surface::topology::topology(m.positions.len(), &m.triangles);
    println!(
        "T in χ{} L{} | V{}/{} χ{} C{} L{} nm{},{} {:?}",
        t0.euler,
        t0.boundary_loops,
        t1.vertices,
        t0.vertices,
        t1.euler,
        t1.components,
        t1.boundary_loops,
        t1.nonmanifold_edges,
        t1.nonmanifold_vertices,
        t.elapsed()
    );
    io::file::write_file(std::path::Path::new(&a[2]), &m, &Default::default(), None).unwrap();
}
