//! Reading of files by name, wherever their bytes are: determines the format, and reads the files that a file refers to.

use crate::base::error::{Error, Result};
use crate::io::address::{inside, not_inside, percent_decoded};
use crate::io::content::Resolve;
use crate::io::foreign::{self, Foreign};
use crate::io::format::Format;
use crate::io::gzip;
use crate::io::obj::mtl;
use crate::io::read::{Loaded, parse};
use crate::mesh::materials::{Image, Materials};
use std::borrow::Cow;
use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::Path;

/// Source of the files that a file refers to: its folder on a disk, or the files given together with it.
pub trait Folder {
    /// Reads a file in it. The error is the end of a sentence that begins with the name.
    fn read(&self, name: &Path) -> std::result::Result<Vec<u8>, String>;

    /// Returns the image of that name, and whether it exists. An image that does not exist keeps its name.
    fn image(&self, name: &str) -> (Image, bool);
}

/// Reads the mesh of a file with this name and content. Its format is `format`, else that of the extension, else that of the
/// content. External buffers and images of a glTF file, and libraries of an OBJ, are read from `folder`. Content compressed
/// by gzip is decompressed.
///
/// # Errors
/// [`Error::File`] if the format is unknown or differs from that of the extension; [`Error::Format`] for malformed content,
/// with the line, byte or part.
pub fn read_named(name: &str, bytes: &[u8], format: Option<Format>, folder: &dyn Folder) -> Result<Loaded> {
    let in_file = |error: Error| error.in_file(name);
    let bytes =
        if gzip::is_packed(bytes) { Cow::Owned(gzip::unpack(bytes).map_err(in_file)?) } else { Cow::Borrowed(bytes) };
    if bytes.is_empty() {
        return Err(refused(name, "the file is empty", "export it again"));
    }
    let format = input_format(name, &bytes, format)?;
    let resolve: Resolve = &|address| read_buffer(folder, address);
    let mut loaded = parse(&bytes, format, resolve).map_err(in_file)?;
    if let Some(materials) = &mut loaded.attributes.materials {
        read_libraries(folder, materials, &mut loaded.notes);
    }
    Ok(loaded)
}

/// Reads a buffer that a glTF file refers to by a relative address.
fn read_buffer(folder: &dyn Folder, address: &str) -> std::result::Result<Vec<u8>, String> {
    match percent_decoded(address) {
        Some(name) => read_inside(folder, &name),
        None => Err(not_inside(address)),
    }
}

/// Reads the file `name`, which must be in the folder or one of its subfolders.
fn read_inside(folder: &dyn Folder, name: &str) -> std::result::Result<Vec<u8>, String> {
    let relative = inside(name).ok_or_else(|| not_inside(name))?;
    folder.read(&relative).map_err(|cause| format!("the file '{}' {cause}", name.escape_debug()))
}

/// Reads the libraries that a file names, and finds the images that they name. Notes list the missing ones. Libraries that
/// cannot be read stay in the list.
fn read_libraries(folder: &dyn Folder, materials: &mut Materials, notes: &mut Vec<String>) {
    for name in std::mem::take(&mut materials.libraries) {
        match read_inside(folder, &with_slashes(&name)).map(|bytes| mtl::parse(&bytes)) {
            Ok(library) => define(folder, materials, library, notes),
            Err(cause) => {
                notes.push(format!("the material library cannot be read: {cause}"));
                materials.libraries.push(name);
            }
        }
    }
}

/// Sets the looks of the materials that `library` defines and that have no look yet.
fn define(folder: &dyn Folder, materials: &mut Materials, library: mtl::Library, notes: &mut Vec<String>) {
    let mtl::Library { looks, images, .. } = library;
    let mut looks: HashMap<String, _> = looks.into_iter().collect();
    let mut numbers: Vec<Option<u32>> = vec![None; images.len()];
    let Materials { list, images: all, .. } = materials;
    for material in list.iter_mut().filter(|material| material.look.is_none()) {
        let Some(mut look) = looks.remove(&material.name) else { continue };
        let used = look.statements.iter_mut().filter_map(|s| s.image.as_mut());
        for image in used.chain(look.textures.iter_mut().map(|t| &mut t.image)) {
            let name = &images[*image as usize];
            *image = *numbers[*image as usize].get_or_insert_with(|| {
                let (found, is_there) = folder.image(&with_slashes(name));
                if !is_there {
                    notes.push(format!("the image '{}' does not exist", name.escape_debug()));
                }
                all.push(found);
                all.len() as u32 - 1
            });
        }
        material.look = Some(look);
    }
}

/// Replaces backslashes, which some programs write in paths.
pub(super) fn with_slashes(name: &str) -> String {
    name.replace('\\', "/")
}

/// Returns the format for the extension of a path.
pub(super) fn by_ending(path: &Path) -> Option<Format> {
    Format::from_extension(ending(path)?)
}

/// Returns the extension of a path, ignoring `.gz`.
fn ending(path: &Path) -> Option<&str> {
    match path.extension()? {
        gz if is_gz(gz) => Path::new(path.file_stem()?).extension()?.to_str(),
        ending => ending.to_str(),
    }
}

pub(super) fn is_gz(ending: &OsStr) -> bool {
    ending.eq_ignore_ascii_case(gzip::ENDING)
}

pub(super) fn input_format(name: &str, bytes: &[u8], format: Option<Format>) -> Result<Format> {
    if let Some(format) = format {
        return Ok(format);
    }
    let path = Path::new(name);
    let by_content = Format::by_signature(bytes);
    if let (None, Some(foreign)) = (by_content, foreign_kind(path, bytes)) {
        let Foreign { name: kind, remedy, .. } = foreign;
        return Err(refused(name, format!("it is {kind}, which is not supported"), *remedy));
    }
    match (by_ending(path), by_content) {
        // The two forms of one format are read by one reader.
        (Some(Format::Gltf | Format::Glb), Some(content @ (Format::Gltf | Format::Glb))) => Ok(content),
        // A file with an extension for columns of numbers may hold anything.
        (Some(Format::Xyz), _) => Ok(Format::sniff(bytes).unwrap_or(Format::Xyz)),
        (Some(ending), Some(content)) if ending != content => {
            let cause = format!("the extension says {ending}, but the content is {content}");
            Err(refused(name, cause, format!("rename the file or give {} as its format", content.extension())))
        }
        (Some(ending), _) => Ok(ending),
        (None, _) => Format::sniff(bytes).ok_or_else(|| {
            let cause = "neither the extension nor the content tells its format";
            refused(name, cause, format!("give its format: one of {}", Format::list(&Format::ALL, "")))
        }),
    }
}

/// Returns the kind of a file that is not read, by its extension, else by its content: some kinds look like archives.
fn foreign_kind(path: &Path, bytes: &[u8]) -> Option<&'static Foreign> {
    ending(path).and_then(foreign::by_ending).or_else(|| foreign::by_content(bytes))
}

fn refused(name: &str, cause: impl Into<String>, remedy: impl Into<String>) -> Error {
    Error::File { file: name.into(), cause: cause.into(), remedy: remedy.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files that were given together.
    struct Given(&'static [(&'static str, &'static [u8])]);

    impl Folder for Given {
        fn read(&self, name: &Path) -> std::result::Result<Vec<u8>, String> {
            let found = self.0.iter().find(|(given, _)| Path::new(given) == name);
            found.map(|(_, bytes)| bytes.to_vec()).ok_or("is not among them".into())
        }

        fn image(&self, name: &str) -> (Image, bool) {
            match self.read(Path::new(name)) {
                Ok(bytes) => (Image::Bytes(bytes.into()), true),
                Err(_) => (Image::File(name.into()), false),
            }
        }
    }

    const OBJ: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";

    #[test]
    fn libraries_and_images_are_read_from_what_is_given() {
        let folder = Given(&[("a.mtl", b"newmtl red\nKd 1 0 0\nmap_Kd b\\c.png\n"), ("b/c.png", b"\x89PNG")]);
        let Loaded { attributes, notes, .. } = read_named("a.obj", OBJ, None, &folder).unwrap();
        assert_eq!(notes, [""; 0]);
        assert_eq!(attributes.materials.unwrap().images, [Image::Bytes(b"\x89PNG"[..].into())]);
    }

    #[test]
    fn what_is_not_given_is_told() {
        let Loaded { notes, .. } = read_named("a.obj", OBJ, None, &Given(&[])).unwrap();
        assert_eq!(notes, ["the material library cannot be read: the file 'a.mtl' is not among them"]);
        let outside = Given(&[("a.mtl", b"newmtl red\nmap_Kd c.png\n")]);
        let Loaded { notes, .. } = read_named("a.obj", OBJ, None, &outside).unwrap();
        assert_eq!(notes, ["the image 'c.png' does not exist"]);
    }

    #[test]
    fn buffers_stay_in_their_folder() {
        let folder = Given(&[("my a.bin", b"123")]);
        assert_eq!(read_buffer(&folder, "my%20a.bin"), Ok(b"123".to_vec()));
        assert!(read_buffer(&folder, "b.bin").unwrap_err().contains("'b.bin' is not among them"));
        assert!(read_buffer(&folder, "../b.bin").unwrap_err().contains("outside the folder"));
        assert!(read_buffer(&folder, "%FF").unwrap_err().contains("outside the folder"));
    }
}
