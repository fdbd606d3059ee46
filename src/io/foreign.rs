//! Files of formats that are often met but not read: what they are, and what to do about them.

use super::format::HEAD;
use super::vtk;

/// A kind of file that is not read.
pub(super) struct Foreign {
    /// Name of the kind, to follow the words `it is`.
    pub name: &'static str,
    /// How to convert it to a file that can be read.
    pub remedy: &'static str,
    /// Extensions of its files.
    endings: &'static [&'static str],
    /// Whether a file that starts with these bytes is certainly of this kind.
    has_signature: fn(&[u8]) -> bool,
}

const BLENDER: &str = "open it in Blender and export it as PLY, OBJ or glTF";
const ASSIMP: &str = "convert it with Blender or `assimp export IN OUT.glb`";
const GMSH: &str = "it has exact surfaces: mesh it in a CAD program or with `gmsh IN -2 -o OUT.stl`";
const UNPACK: &str = "unpack it and give the file in it";

const KINDS: [Foreign; 22] = [
    Foreign { name: "a COLLADA file", endings: &["dae"], remedy: ASSIMP, has_signature: |head| has(head, "<COLLADA") },
    Foreign {
        name: "an FBX file",
        endings: &["fbx"],
        remedy: ASSIMP,
        has_signature: |head| head.starts_with(b"Kaydara FBX Binary") || head.starts_with(b"; FBX"),
    },
    Foreign {
        name: "a USD file",
        endings: &["usd", "usda", "usdc", "usdz"],
        remedy: BLENDER,
        has_signature: |head| head.starts_with(b"PXR-USDC") || head.starts_with(b"#usda"),
    },
    Foreign {
        name: "a STEP file",
        endings: &["step", "stp"],
        remedy: GMSH,
        has_signature: |head| head.trim_ascii_start().starts_with(b"ISO-10303-21"),
    },
    Foreign { name: "an IGES file", endings: &["iges", "igs"], remedy: GMSH, has_signature: is_iges },
    Foreign {
        name: "a BREP file",
        endings: &["brep"],
        remedy: GMSH,
        has_signature: |head| has(&head[..head.len().min(64)], "CASCADE Topology"),
    },
    Foreign {
        name: "a Blender file",
        endings: &["blend"],
        remedy: BLENDER,
        has_signature: |head| head.starts_with(b"BLENDER"),
    },
    Foreign {
        name: "an X3D or VRML file",
        endings: &["x3d", "x3dv", "wrl", "vrml"],
        remedy: "open it in MeshLab and export it as PLY, or convert it with `assimp export IN OUT.glb`",
        has_signature: |head| head.starts_with(b"#VRML") || head.starts_with(b"#X3D") || has(head, "<X3D"),
    },
    Foreign {
        name: "compressed with Draco",
        endings: &["drc"],
        remedy: "decompress it with `draco_decoder -i IN.drc -o OUT.ply`",
        has_signature: |head| head.starts_with(b"DRACO"),
    },
    Foreign { name: "a 3DS file", endings: &["3ds"], remedy: ASSIMP, has_signature: |_| false },
    Foreign { name: "a DXF file", endings: &["dxf"], remedy: ASSIMP, has_signature: |_| false },
    Foreign {
        name: "an AMF file",
        endings: &["amf"],
        remedy: "open it in a slicer and export it as 3MF or STL",
        has_signature: |head| has(head, "<amf"),
    },
    Foreign {
        name: "a GIFTI file",
        endings: &["gii"],
        remedy: "convert it with `mris_convert IN OUT.stl`",
        has_signature: |head| has(head, "<GIFTI"),
    },
    Foreign {
        name: "a VTK grid",
        endings: &["vts", "vtr", "vti", "pvtu", "pvd", "vtm", "vtkhdf"],
        remedy: "open it in ParaView, extract its surface and save that as VTP",
        has_signature: |head| has(head, "<VTKFile") && !has(head, "PolyData") && !vtk::is_grid(head),
    },
    Foreign {
        name: "an Abaqus or Nastran file",
        endings: &["inp", "bdf", "nas"],
        remedy: "convert it with `meshio convert IN OUT.vtk`",
        has_signature: |head| starts_without_case(head, b"*heading") || starts_without_case(head, b"*node"),
    },
    Foreign {
        name: "an HDF5 file",
        endings: &["h5", "hdf5", "xdmf"],
        remedy: "export its surface as VTP or PLY with the program that made it",
        has_signature: |head| head.starts_with(b"\x89HDF\r\n"),
    },
    Foreign {
        name: "a Git LFS pointer",
        endings: &[],
        remedy: "get the file itself with `git lfs pull`",
        has_signature: |head| head.starts_with(b"version https://git-lfs"),
    },
    Foreign {
        name: "a web page",
        endings: &["html", "htm"],
        remedy: "download the file itself",
        has_signature: |head| starts_without_case(head, b"<!doctype html") || starts_without_case(head, b"<html"),
    },
    Foreign {
        name: "a 7-Zip archive",
        endings: &["7z"],
        remedy: UNPACK,
        has_signature: |head| head.starts_with(b"7z\xBC\xAF\x27\x1C"),
    },
    Foreign {
        name: "an archive",
        endings: &["zip", "rar", "tar", "tgz"],
        remedy: UNPACK,
        has_signature: |head| head.starts_with(b"PK\x03\x04") || head.starts_with(b"Rar!"),
    },
    Foreign {
        name: "compressed by a program other than gzip",
        endings: &["xz", "zst", "bz2", "lz4"],
        remedy: UNPACK,
        has_signature: |head| {
            [&b"\xFD7zXZ\0"[..], b"\x28\xB5\x2F\xFD", b"BZh"].iter().any(|magic| head.starts_with(magic))
        },
    },
    Foreign {
        name: "UTF-16 text",
        endings: &[],
        remedy: "save it as UTF-8",
        has_signature: |head| head.starts_with(b"\xFF\xFE") || head.starts_with(b"\xFE\xFF"),
    },
];

/// Returns the kind of a file, by its content.
pub(super) fn by_content(bytes: &[u8]) -> Option<&'static Foreign> {
    let head = &bytes[..bytes.len().min(HEAD)];
    KINDS.iter().find(|kind| (kind.has_signature)(head))
}

/// Returns the kind with this file extension (without a dot, in upper or lower case).
pub(super) fn by_ending(ending: &str) -> Option<&'static Foreign> {
    KINDS.iter().find(|kind| kind.endings.iter().any(|known| known.eq_ignore_ascii_case(ending)))
}

fn has(head: &[u8], word: &str) -> bool {
    head.windows(word.len()).any(|w| w == word.as_bytes())
}

fn starts_without_case(head: &[u8], word: &[u8]) -> bool {
    head.trim_ascii_start().get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
}

/// Checks for lines of 80 characters, the last eight of which are the letter of a section and the number of the line in it.
fn is_iges(head: &[u8]) -> bool {
    let is_first = |number: &[u8]| number.trim_ascii() == b"1" || number == b"0000001";
    head.get(..80).is_some_and(|line| line.is_ascii() && line[72] == b'S' && is_first(&line[73..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_known_by_content_and_by_ending() {
        let iges = [&[b' '; 72][..], b"S      1\n"].concat();
        for (ending, content) in [
            ("dae", &b"<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"\">"[..]),
            ("fbx", b"Kaydara FBX Binary  \0"),
            ("USDA", b"#usda 1.0\n"),
            ("stp", b"ISO-10303-21;\n"),
            ("igs", &iges),
            ("blend", b"BLENDER-v280"),
            ("wrl", b"#VRML V2.0 utf8"),
            ("x3d", b"<?xml version='1.0'?><X3D>"),
            ("drc", b"DRACO\x02\x02"),
            ("html", b"\n<!DOCTYPE html>"),
            ("vts", b"<VTKFile type=\"StructuredGrid\">"),
            ("gii", b"<?xml version=\"1.0\"?>\n<GIFTI Version=\"1\">"),
            ("inp", b"*Node\n      1,  60.,  0.\n"),
            ("pvtu", b"<VTKFile type=\"PUnstructuredGrid\">"),
            ("zip", b"PK\x03\x04"),
        ] {
            let name = by_content(content).unwrap().name;
            assert_eq!(by_ending(ending).unwrap().name, name, "{ending}");
        }
        assert!(by_content(b"version https://git-lfs.github.com/spec/v1\n").is_some());
    }

    #[test]
    fn what_is_read_is_not_foreign() {
        for content in [
            &b""[..],
            b"ply\n",
            b"v 0 0 0\n",
            b"0 0 0\n1 1 1\n",
            b"<VTKFile type=\"PolyData\">",
            b"<VTKFile type=\"UnstructuredGrid\">",
        ] {
            assert!(by_content(content).is_none());
        }
    }
}
