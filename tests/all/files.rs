//! Small, complete files of all formats, and checks of what is read from arbitrary bytes. The fuzzing in `fuzz/` also uses
//! them.

use glam::DVec3;
use spectral_remesh::io::{self, Format, Loaded, NO_BUFFERS};
use spectral_remesh::{Attribute, Attributes, Error, Mesh, Points, Scalar};

/// Returns an octahedron with coordinates that are exact in f32.
pub fn octahedron() -> Mesh {
    let positions =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.25], [0.0, 0.0, -3.0]];
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Mesh { positions: positions.map(DVec3::from).to_vec(), triangles: triangles.to_vec() }
}

pub fn written(mesh: &Mesh, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write(mesh, format, &mut bytes).unwrap();
    bytes
}

/// Returns valid files of every format and its variants.
pub fn valid_files() -> Vec<(Format, Vec<u8>)> {
    let mut files: Vec<_> = Format::OF_MESHES.map(|format| (format, written(&octahedron(), format))).to_vec();
    let texts = [
        (Format::Obj, "# a\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\ng b\nf 1/1 2/1/1 \\\n 3//1 -1\nl 1 2\n"),
        (
            Format::Obj,
            "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl b\nf 1/1/1 2/2/1 -1/-1/-1\n",
        ),
        (Format::Off, "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9 0 0\n1 0 0 0 0 1 9 9 9 0 1\n0 1 0 0 0 1 9 9 9 1 0\n3 0 1 2\n"),
        (Format::Off, "CNOFF\n4 2 0\n0 0 0 0 0 1 9 9 9 9\n1 0 0 1\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n2 0 1\n"),
        (
            Format::Stl,
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
        ),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n4 0 1 2 3\n5 0 1 2 -1 3\n",
        ),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty short label\nelement face 1\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 1 5\n1 0 0 0 0 1 6\n1 1 0 0 0 1 7\n6 0 0 1 0 0 1 3 0 1 2\n",
        ),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0\n1 1 0 0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nPOINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n1 2 3 4\nFIELD f 1\nwind 2 4 int\n1 2 3 4 5 6 7 8\n",
        ),
        (
            Format::Vtk,
            "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0 1 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n",
        ),
        (
            Format::Vtp,
            "<VTKFile type=\"PolyData\"><PolyData><Piece><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray><DataArray type=\"Int32\" Name=\"offsets\">3</DataArray></Polys></Piece></PolyData></VTKFile>",
        ),
        (
            Format::Gmsh,
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n2\n1 1 1 0 1 2\n2 2 2 0 1 1 2 3\n$EndElements\n",
        ),
        (
            Format::Medit,
            "MeshVersionFormatted 2\nDimension 3\nVertices 3\n0 0 0 1\n1 0 0 1\n0 1 0 1\nTriangles 1\n1 2 3 7\nEdges 1\n1 2 0\nEnd\n",
        ),
        (
            Format::Gltf,
            r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1],"scale":[1,2,3]},{"mesh":0,"translation":[1,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":1}],"buffers":[{"byteLength":37,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAQ=="}]}"#,
        ),
    ];
    files.extend(texts.map(|(format, text)| (format, text.as_bytes().to_vec())));
    let mut binary = b"OFF BINARY\n".to_vec();
    binary.extend([3, 1, 0].map(i32::to_be_bytes).as_flattened());
    binary.extend([0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_be_bytes).as_flattened());
    binary.extend([3, 0, 1, 2, 0].map(i32::to_be_bytes).as_flattened());
    files.push((Format::Off, binary));
    files.push((Format::Gmsh, gmsh_file()));
    files.push((Format::Medit, medit_file()));
    files
}

/// Returns a triangle in binary MSH 4.1.
fn gmsh_file() -> Vec<u8> {
    let (ints, sizes) =
        (|x: [i32; 3]| x.map(i32::to_le_bytes).concat(), |x: &[u64]| x.iter().flat_map(|x| x.to_le_bytes()).collect());
    let places = [0f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f64::to_le_bytes).concat();
    let parts: [Vec<u8>; 10] = [
        b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".to_vec(),
        sizes(&[1, 3, 1, 3]),
        ints([2, 1, 0]),
        sizes(&[3, 1, 2, 3]),
        places,
        b"\n$EndNodes\n$Elements\n".to_vec(),
        sizes(&[1, 1, 1, 1]),
        ints([2, 1, 2]),
        sizes(&[1, 1, 1, 2, 3]),
        b"\n$EndElements\n".to_vec(),
    ];
    parts.concat()
}

/// Returns a triangle in binary Medit.
fn medit_file() -> Vec<u8> {
    let head = [1i32, 2, 3, 20, 3, 4, 116, 3].map(i32::to_le_bytes).concat();
    let vertex = |place: [f64; 3]| [place.map(f64::to_le_bytes).concat(), 0i32.to_le_bytes().to_vec()].concat();
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(vertex).concat();
    let faces = [6i32, 144, 1, 1, 2, 3, 0, 54].map(i32::to_le_bytes).concat();
    [head, vertices, faces].concat()
}

/// Returns valid files of points without triangles.
pub fn cloud_files() -> Vec<(Format, Vec<u8>)> {
    let (points, attributes) = scan();
    let written = |format| {
        let mut bytes = Vec::new();
        io::write_points(&points, &attributes, format, &mut bytes).unwrap();
        (format, bytes)
    };
    let mut las = vec![0; 227 + 3 * 26];
    las[..4].copy_from_slice(b"LASF");
    (las[24], las[25], las[94], las[96], las[104], las[105], las[107]) = (1, 2, 227, 227, 2, 26, 3);
    las[131..155].copy_from_slice(&[1f64.to_le_bytes(); 3].concat());
    let text = b"// x;y;z;r;g;b\n3\n0;0;0;255;8;0\n1;0;0;7;8;9\n0;1;0;0;0;0\n".to_vec();
    let pcd = b"# .PCD v0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nDATA ";
    let ascii = [&pcd[..], b"ascii\n0 0 0 1\n1 0 0 4e6\n0 1 0 0\n"].concat();
    let compressed = [&pcd[..], b"binary_compressed\n\x05\0\0\0\x30\0\0\0\0\0\xE0\x26\0"].concat();
    let others = [(Format::Las, las), (Format::Xyz, text), (Format::Pcd, ascii), (Format::Pcd, compressed)];
    Format::OF_POINTS.into_iter().map(written).chain(others).collect()
}

/// Reads the bytes as every format, most of which do not match: each reader must give an error or a sound mesh.
pub fn read_as_anything(bytes: &[u8]) {
    let _ = Format::sniff(bytes);
    for format in Format::ALL {
        audit(io::parse(bytes, format, NO_BUFFERS).map_err(|error| error.in_file("name")));
    }
}

/// Checks what is promised for any bytes, given the result of reading them from a file called `name`.
pub fn audit(read: Result<Loaded, Error>) -> Option<Loaded> {
    match read {
        Ok(loaded) => {
            audit_mesh(&loaded.mesh);
            audit_attributes(&loaded.mesh, &loaded.attributes);
            Some(loaded)
        }
        Err(error) => {
            audit_error(&error);
            None
        }
    }
}

fn audit_mesh(mesh: &Mesh) {
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
}

fn audit_attributes(mesh: &Mesh, attributes: &Attributes) {
    let is_whole = |a: &Attribute| a.values.len() == a.components * mesh.positions.len();
    assert!(attributes.vertex.iter().all(is_whole));
    assert!(attributes.texture.is_empty() || attributes.texture.len() == mesh.triangles.len());
    assert!(attributes.materials.as_ref().is_none_or(|m| m.of_triangle.len() == mesh.triangles.len()));
}

fn audit_error(error: &Error) {
    assert!(matches!(error, Error::Format { .. }), "{error:?}");
    let message = error.to_string();
    assert!(message.starts_with("name") && message.contains("; "), "{message}");
    assert!(!message.contains(['\n', '\r']), "{message:?}");
}

/// Returns the vertices of an octahedron with the attributes that a scanner records.
pub fn scan() -> (Points, Attributes) {
    let positions = octahedron().positions;
    let normals: Vec<DVec3> = positions.iter().map(|p| p.normalize()).collect();
    let attribute = |name: &str, components, scalar| Attribute {
        name: name.into(),
        components,
        values: (0..6 * components).map(|i| f64::from(i as u8) * 3.0).collect(),
        scalar,
    };
    let vertex = vec![attribute("color", 3, Scalar::U8), attribute("_LABEL", 1, Scalar::U16)];
    (Points::new(positions, normals).unwrap(), Attributes { vertex, ..Attributes::default() })
}
