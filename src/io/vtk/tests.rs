use super::*;
use crate::io::base64;
use crate::io::bytes::samples::{fails_at, fault};
use crate::io::content::Content;
use crate::mesh::attributes::Scalar;
use crate::mesh::topology::topology;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// A square as a polygon and as a strip, and a line.
const LEGACY: &str = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0\n1 1 0 0 1 0\n\
                      LINES 1 3\n2 0 1\nPOLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nCELL_DATA 3\n\
                      SCALARS cell int\nLOOKUP_TABLE default\n7 8 9\nPOINT_DATA 4\nSCALARS heat double 1\nLOOKUP_TABLE default\n\
                      1 2 3 4\nNORMALS n float\n0 0 1 0 0 1\n0 0 1 0 0 1\nCOLOR_SCALARS c 3\n1 0 0 0 1 0 0 0 1 0 0 0\n\
                      TEXTURE_COORDINATES t 2 float\n0 0 1 0 1 1 0 1\nFIELD FieldData 1\nwind 2 4 short\n1 2 3 4 5 6 7 8\n";

fn check(read: &Read) {
    assert_eq!(read.mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y]);
    assert_eq!(read.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [3, 1, 2]]);
    assert_eq!(read.attributes.get("heat").unwrap().values, [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(read.attributes.normals(), [DVec3::Z; 4]);
}

#[test]
fn legacy_text() {
    let read = parse_legacy(LEGACY.as_bytes()).unwrap();
    check(&read);
    assert_eq!(read.attributes.names(), ["heat", "normal", "color", "wind", "texture coordinates"]);
    assert_eq!(read.attributes.color().unwrap().color(1), [0.0, 1.0, 0.0]);
    assert_eq!(read.attributes.texture[1][1], DVec2::ONE);
    assert_eq!(read.notes, ["1 line is left out"]);
}

#[test]
fn legacy_binary_of_both_versions() {
    let ints = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
    let longs = |numbers: &[i64]| numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
    let head = |version: &str| {
        let text = format!("# vtk DataFile Version {version}\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n");
        [text.as_bytes(), &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0])].concat()
    };
    let tail = [
        &b"\nPOINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n"[..],
        &floats(&[1.0, 2.0, 3.0, 4.0]),
        b"\nMETADATA\nINFORMATION 0\n\nNORMALS n float\n",
        &floats(&[0.0, 0.0, 1.0].repeat(4)),
    ]
    .concat();
    let old = [&b"\nPOLYGONS 1 5\n"[..], &ints(&[4, 0, 1, 2, 3]), b"\nTRIANGLE_STRIPS 1 5\n", &ints(&[4, 0, 1, 3, 2])];
    let new = [
        &b"\nPOLYGONS 2 4\nOFFSETS vtktypeint64\n"[..],
        &longs(&[0, 4]),
        b"\nCONNECTIVITY vtktypeint64\n",
        &longs(&[0, 1, 2, 3]),
        b"\nTRIANGLE_STRIPS 2 4\nOFFSETS vtktypeint64\n",
        &longs(&[0, 4]),
        b"\nCONNECTIVITY vtktypeint64\n",
        &longs(&[0, 1, 3, 2]),
    ];
    for (version, cells) in [("3.0", old.concat()), ("5.1", new.concat())] {
        let bytes = [head(version), cells, tail.clone()].concat();
        check(&parse_legacy(&bytes).unwrap());
        assert!(parse_legacy(&bytes[..bytes.len() - 1]).is_err());
    }
}

#[test]
fn faces_of_grids_are_read() {
    let grid = |cells: &str| {
        let text = format!(
            "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
             0 0 0 1 0 0 0 1 0 1 1 0\n{cells}"
        );
        parse_legacy(text.as_bytes())
    };
    let read = grid("CELLS 3 14\n4 0 1 2 3\n3 0 1 3\n4 0 1 2 3\nCELL_TYPES 3\n8 5 10\n").unwrap();
    assert_eq!(read.mesh.triangles, [[0, 1, 3], [0, 3, 2], [0, 1, 3]]);
    assert_eq!(read.notes, ["1 volume cell is left out"]);
    let unknown = fault(grid("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n41\n")).1;
    assert!(unknown.contains("1 of them of unknown types, and no faces"), "{unknown}");
    assert!(fault(grid("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n5 5\n")).1.contains("1 cells, but 2 cell types"));
}

#[test]
fn the_outside_of_a_volume_is_read() {
    // Two stacked voxels, and the same as hexahedra, one of which is of second order.
    let points: Vec<String> = (0..12).map(|i| format!("{} {} {}", i % 2, i / 2 % 2, i / 4)).collect();
    let head = format!(
        "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n{}\n",
        points.join("\n")
    );
    let voxels = "CELLS 2 18\n8 0 1 2 3 4 5 6 7\n8 4 5 6 7 8 9 10 11\nCELL_TYPES 2\n11 11\n";
    let curved = format!("20 4 5 7 6 8 9 11 10{}", " 0".repeat(12));
    let hexahedra = format!("CELLS 2 30\n8 0 1 3 2 4 5 7 6\n{curved}\nCELL_TYPES 2\n12 25\n");
    for cells in [voxels, &hexahedra] {
        let Read { mesh, notes, .. } = parse_legacy(format!("{head}{cells}").as_bytes()).unwrap();
        let found = topology(mesh.positions.len(), &mesh.triangles);
        assert!(found.is_manifold() && found.is_oriented() && (found.euler, found.boundary_loops) == (2, 0));
        assert_eq!(
            (mesh.triangles.len(), notes),
            (20, vec!["2 cells fill a volume: only its outer surface is used".to_string()])
        );
    }
}

#[test]
fn unstructured_grids_are_read_as_xml() {
    // A tetrahedron, with or without a triangle beside it.
    let grid = |types: &str, ends: &str| {
        let array = |name: &str, numbers: &str| {
            format!("<DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">{numbers}</DataArray>")
        };
        let cells = ["connectivity", "offsets", "types"].into_iter().zip(["0 1 2 3 1 2 4", ends, types]);
        let cells: String = cells.map(|(name, numbers)| array(name, numbers)).collect();
        let points = "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\
                      0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray>";
        let heat = array("heat", "1 2 3 4 5");
        let piece = format!("<Points>{points}</Points><Cells>{cells}</Cells><PointData>{heat}</PointData>");
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece>{piece}</Piece></UnstructuredGrid></VTKFile>"
        );
        parse_xml(text.as_bytes())
    };
    let Read { mesh, attributes, notes } = grid("10", "4").unwrap();
    assert_eq!(mesh.triangles, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    assert_eq!(notes, ["1 cell fills a volume: only its outer surface is used"]);
    assert_eq!(attributes.numbers("heat"), Ok(vec![1.0, 2.0, 3.0, 4.0, 5.0]));
    let Read { mesh, notes, .. } = grid("10 5", "4 7").unwrap();
    assert_eq!((mesh.triangles, notes), (vec![[1, 2, 4]], vec!["1 volume cell is left out".to_string()]));
    assert!(fault(grid("10", "4 7")).1.contains("2 cells, but 1 cell types"));
    assert!(fault(grid("42", "7")).1.contains("1 of them of unknown types, and no faces"));
}

#[test]
fn errors_in_legacy_files_have_a_line() {
    for (from, to, line, words) in [
        ("POLYDATA", "STRUCTURED_POINTS", 4, "'STRUCTURED_POINTS', which has no faces"),
        ("ASCII", "ROMAN", 3, "'ROMAN', neither ASCII nor BINARY"),
        ("POINTS 4 float", "POINTS 4 quad", 5, "type 'quad' is not supported"),
        ("POINTS 4 float", "POINTS 44444444 float", 5, "entries are declared"),
        ("1 1 0 0 1 0", "1 1 0 x 1 0", 7, "'x' is not a number"),
        ("4 0 1 2 3", "5 0 1 2 3", 11, "5 numbers are too few"),
        ("# vtk", "# vkt", 1, "the first line"),
    ] {
        fails_at(parse_legacy(LEGACY.replace(from, to).as_bytes()), line, words);
    }
    let (place, cause) = fault(parse_legacy(LEGACY.replace("4 0 1 2 3", "4 0 1 2 4").as_bytes()));
    assert_eq!(
        (place, cause.as_str()),
        (Place::Part("face 0".into()), "a cell uses point 4, but points go from 0 to 3")
    );
    let lines = &LEGACY[..LEGACY.find("POLYGONS").unwrap()];
    assert!(fault(parse_legacy(lines.as_bytes())).1.contains("it has lines but no faces"));
    let unknown = LEGACY.replace("FIELD", "FEELD");
    assert!(parse_legacy(unknown.as_bytes()).unwrap().notes[0].starts_with("everything from 'FEELD':"));
}

/// How arrays of a file are written.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Inline,
    Appended,
    Raw,
}

/// The square as XML.
fn xml(form: Form, compressed: bool) -> Vec<u8> {
    let pack = |bytes: Vec<u8>| -> Vec<Vec<u8>> {
        if !compressed {
            return vec![[&(bytes.len() as u32).to_le_bytes()[..], &bytes].concat()];
        }
        let blocks: Vec<&[u8]> = bytes.chunks(16).collect();
        let squeeze = |block: &&[u8]| {
            let mut out = ZlibEncoder::new(Vec::new(), Compression::default());
            out.write_all(block).unwrap();
            out.finish().unwrap()
        };
        let squeezed: Vec<Vec<u8>> = blocks.iter().map(squeeze).collect();
        let sizes = [blocks.len(), 16, bytes.len() % 16].into_iter().chain(squeezed.iter().map(Vec::len));
        // The lengths are a separate piece of base64.
        vec![sizes.flat_map(|n| (n as u32).to_le_bytes()).collect(), squeezed.concat()]
    };
    let mut appended = Vec::new();
    let mut array = |kind: &str, name: &str, components: usize, numbers: &[f64]| {
        let bytes = |x: &f64| if kind == "Float32" { (*x as f32).to_le_bytes() } else { (*x as i32).to_le_bytes() };
        let pieces = pack(numbers.iter().flat_map(bytes).collect());
        let spelled: String = pieces.iter().map(|piece| base64::encode(piece)).collect();
        let offset = appended.len();
        let (format, text) = match form {
            Form::Text => ("ascii".into(), numbers.iter().map(|x| format!(" {x}")).collect()),
            Form::Inline => ("binary".into(), format!("\n  {spelled}\n")),
            Form::Appended | Form::Raw => (format!("appended\" offset=\"{offset}"), String::new()),
        };
        appended.extend(if form == Form::Raw { pieces.concat() } else { spelled.into_bytes() });
        format!(
            "<DataArray type='{kind}' Name='{name}' NumberOfComponents='{components}' format=\"{format}\">{text}<Key>7</Key></DataArray>"
        )
    };
    let points = array("Float32", "Points", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let heat = array("Float32", "heat", 1, &[1.0, 2.0, 3.0, 4.0]);
    let normals = array("Float32", "n", 3, &[0.0, 0.0, 1.0].repeat(4));
    let square = array("Int32", "connectivity", 1, &[0.0, 1.0, 2.0, 3.0]);
    let strip = array("Int32", "connectivity", 1, &[0.0, 1.0, 3.0, 2.0]);
    let ends = array("Int32", "offsets", 1, &[4.0]);
    let compressor = if compressed { " compressor='vtkZLibDataCompressor'" } else { "" };
    let encoding = if form == Form::Raw { "raw" } else { "base64" };
    let head = format!(
        "<?xml version='1.0'?>\n<VTKFile type=\"PolyData\" byte_order='LittleEndian'{compressor}><PolyData>\
         <Piece NumberOfPoints='4' NumberOfPolys='1'><PointData Scalars='heat' Normals='n'>{heat}{normals}</PointData>\
         <CellData>{heat}</CellData><Points>{points}</Points><Verts></Verts><Strips>{strip}{ends}</Strips>\
         <Polys>{square}{ends}</Polys></Piece></PolyData><AppendedData encoding=\"{encoding}\">\n_"
    );
    [head.as_bytes(), &appended, b"</AppendedData></VTKFile>"].concat()
}

#[test]
fn xml_of_all_forms() {
    for form in [Form::Text, Form::Inline, Form::Appended, Form::Raw] {
        for compressed in [false, true] {
            let mut read = parse_xml(&xml(form, compressed)).unwrap();
            read.mesh.triangles.rotate_left(2);
            check(&read);
            assert!(read.notes.is_empty(), "{:?}", read.notes);
        }
    }
}

#[test]
fn pieces_are_put_together() {
    let text = String::from_utf8(xml(Form::Text, false)).unwrap();
    let (start, end) = (text.find("<Piece").unwrap(), text.find("</PolyData>").unwrap());
    let twice = format!("{}{}", &text[..end], &text[start..]);
    let read = parse_xml(twice.as_bytes()).unwrap();
    assert_eq!((read.mesh.positions.len(), read.mesh.triangles.len()), (8, 8));
    assert_eq!(read.mesh.triangles[4], [4, 5, 7]);
    assert_eq!(read.attributes.names(), ["heat", "normal"]);
    let without = twice.replacen("Name='heat'", "Name='cold'", 1);
    let notes = parse_xml(without.as_bytes()).unwrap().notes;
    assert_eq!(notes.len(), 2, "{notes:?}");
}

#[test]
fn errors_in_xml_say_what_is_wrong() {
    let text = |from: &str, to: &str| String::from_utf8(xml(Form::Text, false)).unwrap().replace(from, to).into_bytes();
    for (bytes, words) in [
        (text("\"PolyData\"", "\"ImageData\""), "of type 'ImageData'"),
        (text("byte_order", "compressor='vtkLZ4DataCompressor' byte_order"), "compressed with 'vtkLZ4DataCompressor'"),
        (text(" 1 2 3 4<", " 1 2 x 4<"), "'x' in an array is not a number"),
        (text(" 0 1 2 3<", " 0 1 2 4<"), "uses point 4"),
        (text(" 4<", " 5<"), "corners 0 to 5 of 4"),
        (text("<PolyData>", "<!-- "), "not XML"),
        (text("format=\"ascii\"", "format=\"appended\""), "not in the appended data"),
        (text("format=\"ascii\"", "format=\"binary\""), "missing or damaged"),
    ] {
        let cause = fault(parse_xml(&bytes)).1;
        assert!(cause.contains(words), "{cause}");
    }
    for compressed in [false, true] {
        let bytes = xml(Form::Raw, compressed);
        let start = bytes.windows(2).position(|w| w == b"\n_").unwrap();
        // The last array is used twice, so all appended data is needed.
        for end in start..bytes.len() - "</AppendedData></VTKFile>".len() {
            assert!(parse_xml(&bytes[..end]).is_err(), "{end}");
        }
    }
}

#[test]
fn arrays_may_not_fill_the_memory() {
    let mut squeezed = ZlibEncoder::new(Vec::new(), Compression::best());
    squeezed.write_all(&vec![0; 8 << 20]).unwrap();
    let squeezed = squeezed.finish().unwrap();
    let sizes = [1, 8 << 20, 0, squeezed.len()].iter().flat_map(|&n| (n as u32).to_le_bytes()).collect::<Vec<_>>();
    let text = base64::encode(&sizes) + &base64::encode(&squeezed);
    let file = format!(
        "<VTKFile type=\"PolyData\" compressor='vtkZLibDataCompressor'><Piece><Points><DataArray type='Float32' \
         format='binary'>{text}<Key>7</Key></DataArray></Points></Piece></VTKFile>"
    );
    assert!(fault(parse_xml(file.as_bytes())).1.contains("more than 256 times"));
}

#[test]
fn names_and_types_of_attributes_come_back() {
    let attribute = |name: &str, components, values: &[f64], scalar| Attribute {
        name: name.into(),
        components,
        values: values.to_vec(),
        scalar,
    };
    let vertex = vec![
        attribute("color", 3, &[0.0, 0.5, 1.0], Scalar::F32),
        attribute("a < \"b\" & OFFSET", 2, &[0.1, -0.2], Scalar::F64),
        attribute("label", 1, &[-3.0], Scalar::I16),
    ];
    let attributes = Attributes { vertex, ..Attributes::default() };
    let mut bytes = Vec::new();
    write(&Content { positions: &[DVec3::ONE], triangles: &[], attributes: &attributes }, &mut bytes).unwrap();
    assert_eq!(parse_xml(&bytes).unwrap().attributes, attributes);
}
