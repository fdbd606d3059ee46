//! Formats by name, by extension and by content.

use super::{e57, las, medit, off, pcd, ply, threemf, vtk, xyz};
use crate::base::error::{Error, Result, Setting};
use crate::mesh::attributes::{Attribute, Attributes, Lost, MATERIALS, PARTS, TEXTURE};
use crate::mesh::materials::{Image, Look, Materials, Texture, Use};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A file format of meshes or points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Wavefront OBJ, text.
    Obj,
    /// Stanford PLY, text or binary.
    Ply,
    /// STL, text or binary: separate triangles, single precision.
    Stl,
    /// Object file format of Geomview, text.
    Off,
    /// glTF 2.0 as JSON, its buffers embedded or in files beside it; single precision.
    Gltf,
    /// glTF 2.0 as one binary file; single precision.
    Glb,
    /// Columns of numbers in text: points with attributes, no triangles.
    Xyz,
    /// LAS or, compressed, LAZ: points of laser scanners; only read.
    Las,
    /// 3MF, a format for 3D printing.
    #[serde(rename = "3mf")]
    ThreeMf,
    /// Legacy VTK: polygons, or an unstructured grid with faces or volumes; only read.
    Vtk,
    /// VTK as XML: polygons; unstructured grids are only read.
    Vtp,
    /// PCD of the Point Cloud Library: points; single precision.
    Pcd,
    /// Gmsh's MSH, of which surface elements are read; only read.
    #[serde(rename = "msh")]
    Gmsh,
    /// Medit, text or binary, of which triangles and quadrilaterals are read; only read.
    #[serde(rename = "mesh")]
    Medit,
    /// E57: points of laser scanners; only read.
    E57,
}

/// Length of the head of a file in which a keyword must appear for the content to be recognised, if not at the very start.
pub(super) const HEAD: usize = 4096;

/// Size, in bytes, of the header and triangle count of a binary STL, and of each of its triangles.
const STL_BYTES: (usize, usize) = (84, 50);

/// Further extensions of files with columns of numbers.
const XYZ_ENDINGS: [&str; 4] = ["xyzn", "txt", "pts", "asc"];

/// Possible first statements of an OBJ.
const OBJ_STATEMENTS: [&[u8]; 12] =
    [b"v", b"vt", b"vn", b"vp", b"f", b"o", b"g", b"s", b"l", b"p", b"mtllib", b"usemtl"];

impl Format {
    /// All formats, in the order of the documentation.
    pub const ALL: [Format; 15] = [
        Format::Obj,
        Format::Ply,
        Format::Stl,
        Format::Off,
        Format::Gltf,
        Format::Glb,
        Format::ThreeMf,
        Format::Vtp,
        Format::Vtk,
        Format::Gmsh,
        Format::Medit,
        Format::Xyz,
        Format::Pcd,
        Format::Las,
        Format::E57,
    ];

    /// Formats that hold triangles and can be written.
    pub const OF_MESHES: [Format; 8] =
        [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Gltf, Format::Glb, Format::ThreeMf, Format::Vtp];

    /// Formats that hold points without triangles and can be written.
    pub const OF_POINTS: [Format; 8] =
        [Format::Obj, Format::Ply, Format::Off, Format::Gltf, Format::Glb, Format::Vtp, Format::Xyz, Format::Pcd];

    /// Returns the extension of its files, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Off => "off",
            Format::Gltf => "gltf",
            Format::Glb => "glb",
            Format::Xyz => "xyz",
            Format::Las => "las",
            Format::ThreeMf => "3mf",
            Format::Vtk => "vtk",
            Format::Vtp => "vtp",
            Format::Pcd => "pcd",
            Format::Gmsh => "msh",
            Format::Medit => "mesh",
            Format::E57 => "e57",
        }
    }

    /// Returns its name, as written in prose.
    pub fn name(self) -> &'static str {
        match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Stl => "STL",
            Format::Off => "OFF",
            Format::Gltf => "glTF",
            Format::Glb => "GLB",
            Format::Xyz => "XYZ",
            Format::Las => "LAS",
            Format::ThreeMf => "3MF",
            Format::Vtk => "VTK",
            Format::Vtp => "VTP",
            Format::Pcd => "PCD",
            Format::Gmsh => "MSH",
            Format::Medit => "MESH",
            Format::E57 => "E57",
        }
    }

    /// Returns the format with this file extension (without a dot, in upper or lower case).
    pub fn from_extension(extension: &str) -> Option<Format> {
        let is = |ending: &str| ending.eq_ignore_ascii_case(extension);
        let of_columns = || XYZ_ENDINGS.into_iter().any(is).then_some(Format::Xyz);
        let others = || [("laz", Format::Las), ("meshb", Format::Medit)].into_iter().find(|(ending, _)| is(ending));
        let known = Format::ALL.into_iter().find(|f| is(f.extension()));
        known.or_else(of_columns).or_else(|| others().map(|(_, format)| format))
    }

    /// Guesses the format of a file from its content: by its signature, or by a first statement that only one format has.
    pub fn sniff(bytes: &[u8]) -> Option<Format> {
        let by_statement = || is_obj(bytes).then_some(Format::Obj);
        Format::by_signature(bytes).or_else(by_statement).or_else(|| xyz::is_table(bytes).then_some(Format::Xyz))
    }

    /// Returns the format of `bytes` if it is certain, because no file of another format starts like this.
    pub fn by_signature(bytes: &[u8]) -> Option<Format> {
        let head = &bytes[..bytes.len().min(HEAD)];
        let has = |word: &str| head.windows(word.len()).any(|w| w == word.as_bytes());
        let starts = |word: &str| head.trim_ascii_start().starts_with(word.as_bytes());
        if bytes.starts_with(b"glTF") {
            Some(Format::Glb)
        } else if bytes.starts_with(las::MAGIC) {
            Some(Format::Las)
        } else if bytes.starts_with(e57::MAGIC) {
            Some(Format::E57)
        } else if threemf::has_signature(bytes) {
            Some(Format::ThreeMf)
        } else if head.trim_ascii_start().starts_with(b"# vtk DataFile") {
            Some(Format::Vtk)
        } else if has("<VTKFile") && (has("PolyData") || vtk::is_grid(head)) {
            Some(Format::Vtp)
        } else if pcd::has_signature(head) {
            Some(Format::Pcd)
        } else if starts("$MeshFormat") {
            Some(Format::Gmsh)
        } else if medit::has_signature(head) {
            Some(Format::Medit)
        } else if ply::has_signature(head) {
            Some(Format::Ply)
        } else if is_binary_stl(bytes) || (starts("solid") && (has("facet") || has("endsolid"))) {
            Some(Format::Stl)
        } else if starts("{") && has("\"asset\"") {
            Some(Format::Gltf)
        } else if off::has_keyword(head) {
            Some(Format::Off)
        } else {
            None
        }
    }
}

/// Whether the length fits the number of triangles in the header.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let (head, each) = STL_BYTES;
    let Some(&[a, b, c, d]) = bytes.get(head - 4..head) else { return false };
    let triangles = u32::from_le_bytes([a, b, c, d]) as usize;
    triangles > 0 && triangles.checked_mul(each).is_some_and(|size| size == bytes.len() - head)
}

fn is_obj(bytes: &[u8]) -> bool {
    super::text::Words::new(bytes)
        .with_comments()
        .with_continued_lines()
        .anywhere()
        .is_some_and(|word| OBJ_STATEMENTS.contains(&word))
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(name: &str) -> Result<Format> {
        Format::from_extension(name).ok_or_else(|| Error::Option {
            option: Setting::Format,
            cause: format!("{} is not a mesh format", super::text::quote(name.as_bytes())),
            remedy: format!("use one of {}", Format::list(&Format::ALL, "")),
        })
    }
}

impl Format {
    /// Lists the extensions of `formats`, each preceded by `before`, for messages.
    pub(crate) fn list(formats: &[Format], before: &str) -> String {
        formats.iter().map(|f| format!("{before}{}", f.extension())).collect::<Vec<_>>().join(", ")
    }

    /// Whether one file of this format can hold all levels of detail of a mesh.
    pub fn holds_levels(self) -> bool {
        matches!(self, Format::Gltf | Format::Glb)
    }

    /// Returns those of `attributes` that files of this format cannot hold.
    pub fn cannot_hold(self, attributes: &Attributes) -> Vec<Lost> {
        let lost = |name: &str| Lost { name: name.into(), cause: format!("{self} cannot store it") };
        let vertex = attributes.vertex.iter().filter(|a| !self.holds(a)).map(|a| lost(&a.name));
        let has_texture = matches!(self, Format::Obj | Format::Ply | Format::Gltf | Format::Glb);
        let texture = !attributes.texture.is_empty() && !has_texture;
        let has_materials = matches!(self, Format::Obj | Format::Gltf | Format::Glb);
        let materials = attributes.materials.is_some() && !has_materials;
        let parts = attributes.parts.is_some() && !has_materials;
        let opacity = self == Format::Obj && attributes.color().is_some_and(|color| color.components == 4);
        let others = [(texture, TEXTURE), (materials, MATERIALS), (parts, PARTS), (opacity, "opacity")];
        let looks = attributes.materials.iter().flat_map(|materials| self.cannot_show(materials));
        vertex
            .chain(others.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, name)| lost(name)))
            .chain(looks)
            .collect()
    }

    /// Returns what files of this format cannot hold of the looks of `materials`, if the format has materials at all.
    fn cannot_show(self, materials: &Materials) -> Option<Lost> {
        let looks = || materials.list.iter().filter_map(|material| material.look.as_ref());
        let is_left_out = |texture: &Texture| matches!(texture.of, Use::MetallicRoughness | Use::Occlusion);
        let no_obj = |look: &Look| look.statements.is_empty() && look.textures.iter().any(is_left_out);
        let is_known = |name: &str| [".png", ".jpg", ".jpeg"].iter().any(|e| name.to_ascii_lowercase().ends_with(e));
        let no_gltf = |image: &Image| matches!(image, Image::File(name) if !is_known(name));
        let (name, cause) = match self {
            Format::Obj if looks().any(no_obj) => {
                ("textures for roughness, metalness and occlusion", "OBJ cannot store them")
            }
            Format::Gltf | Format::Glb if materials.images.iter().any(no_gltf) => {
                ("images that are neither PNG nor JPEG", "glTF cannot store them")
            }
            _ => return None,
        };
        Some(Lost { name: name.into(), cause: cause.into() })
    }

    /// Whether files of this format can hold this vertex attribute.
    fn holds(self, attribute: &Attribute) -> bool {
        match self {
            Format::Ply | Format::Xyz | Format::Vtp | Format::Pcd => true,
            Format::Obj | Format::Off => attribute.is_color() || attribute.is_normal(),
            Format::Gltf | Format::Glb => attribute.components <= 4,
            Format::ThreeMf => attribute.is_color(),
            Format::Stl | Format::Las | Format::Vtk | Format::Gmsh | Format::Medit | Format::E57 => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_endings_lead_back() {
        for format in Format::ALL {
            assert_eq!(Format::from_extension(format.extension()), Some(format));
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(serde_json::to_value(format).unwrap(), format.extension());
        }
        assert_eq!(Format::from_extension("PLY"), Some(Format::Ply));
        assert_eq!(Format::from_extension("ply "), None);
        let message = "doc".parse::<Format>().unwrap_err().to_string();
        assert_eq!(
            message,
            "format: 'doc' is not a mesh format; use one of obj, ply, stl, off, gltf, glb, 3mf, vtp, vtk, msh, mesh, xyz, pcd, las, e57"
        );
        assert_eq!(["XYZN", "txt", "pts", "asc"].map(Format::from_extension), [Some(Format::Xyz); 4]);
    }

    #[test]
    fn contents_are_recognised() {
        let stl = |triangles: u32, bytes: usize| {
            let mut file = b"solid with a misleading header, facet".to_vec();
            file.resize(80, 0);
            file.extend(triangles.to_le_bytes());
            file.resize(84 + bytes, 0);
            file
        };
        for (bytes, format) in [
            (&b"ply\nformat ascii 1.0\n"[..], Some(Format::Ply)),
            (b"ply\r\nformat ascii 1.0\r\n", Some(Format::Ply)),
            (b"PLY\nformat ascii 1.0\n", Some(Format::Ply)),
            (b"glTF\x02\0\0\0", Some(Format::Glb)),
            (b" {\n \"asset\" : {\"version\": \"2.0\"}}", Some(Format::Gltf)),
            (b"{\"type\": 1}", None),
            (b"solid a\n facet normal 0 0 1\n", Some(Format::Stl)),
            (b"solid a\nendsolid\n", Some(Format::Stl)),
            (b"solid ground\n", None),
            (&stl(2, 100), Some(Format::Stl)),
            (b"# a\nCOFF\n1 0 0\n", Some(Format::Off)),
            (b"# a\n\nmtllib b.mtl\nv 0 0 0\n", Some(Format::Obj)),
            (b"v 0 0 0", Some(Format::Obj)),
            (b"# a\n1;2;3\n4;5;6\n", Some(Format::Xyz)),
            (b"2\n1 2 3\n4 5 6\n", Some(Format::Xyz)),
            (b"1 2\n3 4\n", None),
            (b"", None),
            (b"\x89PNG\r\n", None),
            (b"LASF\0\0", Some(Format::Las)),
            (b"ASTM-E57\x01", Some(Format::E57)),
            (b"PK\x03\x04 a zip with 3D/a.model in it", Some(Format::ThreeMf)),
            (b"PK\x03\x04 another zip", None),
            (b"# vtk DataFile Version 3.0\n", Some(Format::Vtk)),
            (b"<?xml?>\n<VTKFile type=\"PolyData\">", Some(Format::Vtp)),
            (b"<VTKFile type='UnstructuredGrid'>", Some(Format::Vtp)),
            (b"<VTKFile type=\"PUnstructuredGrid\">", None),
            (b"<VTKFile type=\"ImageData\">", None),
            (b"# .PCD v.7\n", Some(Format::Pcd)),
            (b"$MeshFormat\n", Some(Format::Gmsh)),
            (b"# a\nMeshVersionFormatted 2\n", Some(Format::Medit)),
            (b"\x01\0\0\0\x02\0\0\0\x03\0\0\0", Some(Format::Medit)),
            (b"hello world", None),
        ] {
            assert_eq!(Format::sniff(bytes), format, "{}", String::from_utf8_lossy(bytes));
        }
        assert_eq!(Format::sniff(&stl(u32::MAX, 100)[5..]), None);
    }
}
