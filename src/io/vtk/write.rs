//! Writing of VTP: elements, followed by the raw numbers of all arrays, least significant byte first.

use crate::io::content::Content;
use crate::mesh::attributes::{Attribute, Scalar};
use quick_xml::escape::escape;
use std::io::{self, Write};

type Fill<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + 'a>;

/// An array that is appended.
struct Appended<'a> {
    /// Start of its element, without the offset of its numbers.
    element: String,
    /// Size of its numbers, in bytes.
    length: u64,
    write: Fill<'a>,
}

/// Size of the length that precedes the numbers of an array, in bytes.
const HEADER: u64 = 8;

/// Writes points, polygons, and all attributes of the points. If there are no polygons, each point becomes a cell, so that
/// programs show it.
pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let (points, triangles) = (content.positions.len(), content.triangles.len());
    let is_cloud = triangles == 0;
    let vertices = if is_cloud { points } else { 0 };
    let attributes = &content.attributes.vertex;
    let mut arrays = vec![positions(content)];
    arrays.extend(attributes.iter().map(of_points));
    let cells = if is_cloud {
        [integers("connectivity", vertices, |i| i as i64), integers("offsets", vertices, |i| i as i64 + 1)]
    } else {
        [corners(content), integers("offsets", triangles, |i| 3 * (i as i64 + 1))]
    };
    arrays.extend(cells);
    let mut offset = 0;
    let mut elements = arrays.iter().map(|array| {
        let element = format!("{} offset=\"{offset}\"/>\n", array.element);
        offset += HEADER + array.length;
        element
    });
    let mut next = |count: usize| elements.by_ref().take(count).collect::<Vec<_>>().concat();
    let (positions, point_data, cells) = (next(1), next(attributes.len()), next(2));
    let name = |is: fn(&Attribute) -> bool| attributes.iter().find(|a| is(a)).map(|a| a.name.as_str());
    let role = |key: &str, name: Option<&str>| name.map_or(String::new(), |name| format!(" {key}=\"{name}\""));
    let roles = role("Normals", name(Attribute::is_normal)) + &role("Scalars", name(Attribute::is_color));
    let kind = if is_cloud { "Verts" } else { "Polys" };
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"{vertices}\" \
         NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{triangles}\">\n<PointData{roles}>\n{point_data}\
         </PointData>\n<Points>\n{positions}</Points>\n<{kind}>\n{cells}</{kind}>\n</Piece>\n</PolyData>\n\
         <AppendedData encoding=\"raw\">\n_"
    )?;
    for array in &arrays {
        out.write_all(&array.length.to_le_bytes())?;
        (array.write)(out)?;
    }
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}

fn element(kind: &str, name: &str, components: usize) -> String {
    format!(
        "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\"",
        escape(name)
    )
}

fn positions<'a>(content: &Content<'a>) -> Appended<'a> {
    let positions = content.positions;
    Appended {
        element: element("Float64", "Points", 3),
        length: 24 * positions.len() as u64,
        write: Box::new(|out| {
            positions.iter().flat_map(|p| p.to_array()).try_for_each(|x| out.write_all(&x.to_le_bytes()))
        }),
    }
}

fn corners<'a>(content: &Content<'a>) -> Appended<'a> {
    let triangles = content.triangles;
    Appended {
        element: element("Int64", "connectivity", 1),
        length: 24 * triangles.len() as u64,
        write: Box::new(|out| triangles.iter().flatten().try_for_each(|&v| out.write_all(&i64::from(v).to_le_bytes()))),
    }
}

fn integers<'a>(name: &str, count: usize, number: impl Fn(usize) -> i64 + 'a) -> Appended<'a> {
    Appended {
        element: element("Int64", name, 1),
        length: 8 * count as u64,
        write: Box::new(move |out| (0..count).try_for_each(|i| out.write_all(&number(i).to_le_bytes()))),
    }
}

fn of_points(attribute: &Attribute) -> Appended<'_> {
    Appended {
        element: element(number_type(attribute.scalar), &attribute.name, attribute.components),
        length: (attribute.values.len() * attribute.scalar.size()) as u64,
        write: Box::new(|out| {
            attribute.values.iter().try_for_each(|&x| {
                let (bytes, size) = attribute.scalar.bytes(x);
                out.write_all(&bytes[..size])
            })
        }),
    }
}

fn number_type(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::I8 => "Int8",
        Scalar::U8 => "UInt8",
        Scalar::I16 => "Int16",
        Scalar::U16 => "UInt16",
        Scalar::I32 => "Int32",
        Scalar::U32 => "UInt32",
        Scalar::F32 => "Float32",
        Scalar::F64 => "Float64",
    }
}
