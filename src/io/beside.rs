//! Files beside a mesh file on disk: those that it names, and the material library and images written with it.

use crate::base::error::Result;
use crate::io::companions::{Companions, companions};
use crate::io::disk::{folder_of, is_replaced, read_cause, replace_file};
use crate::io::format::Format;
use crate::io::named::{Folder, with_slashes};
use crate::mesh::attributes::Attributes;
use crate::mesh::materials::{Image, Materials, image_type};
use std::borrow::Cow;
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path, PathBuf};

/// The folder of the file at a path, with its subfolders.
pub(super) struct Beside<'a>(pub &'a Path);

impl Folder for Beside<'_> {
    fn read(&self, name: &Path) -> std::result::Result<Vec<u8>, String> {
        let cannot = |error: io::Error| format!("cannot be read: {}", read_cause(&error));
        let found = folder_of(self.0).join(name);
        let file = File::open(&found).map_err(cannot)?;
        if !file.metadata().map_err(cannot)?.is_file() {
            return Err("is not a file".into());
        }
        fs::read(found).map_err(cannot)
    }

    fn image(&self, name: &str) -> (Image, bool) {
        let file = folder_of(self.0).join(name);
        (Image::File(file.to_string_lossy().into_owned()), file.is_file())
    }
}

/// Returns the attributes as a file of `format` at `path` needs them. For OBJ, writes the material library and the images
/// beside the file; for glTF, replaces image files by their bytes.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if the library or an image cannot be written.
pub(super) fn prepared<'a>(path: &Path, format: Format, attributes: &'a Attributes) -> Result<Cow<'a, Attributes>> {
    let Some(materials) = &attributes.materials else { return Ok(Cow::Borrowed(attributes)) };
    let materials = match format {
        Format::Obj => with_library(path, materials)?,
        Format::Gltf | Format::Glb => Materials { images: embedded(&materials.images), ..materials.clone() },
        _ => return Ok(Cow::Borrowed(attributes)),
    };
    Ok(Cow::Owned(Attributes { materials: Some(materials), ..attributes.clone() }))
}

/// Returns the images, with files replaced by their content if that is PNG or JPEG.
fn embedded(images: &[Image]) -> Vec<Image> {
    let embed = |image: &Image| match image {
        Image::File(name) if Path::new(name).is_file() => {
            let bytes = fs::read(name).ok().filter(|bytes| image_type(bytes).is_some());
            bytes.map_or_else(|| image.clone(), |bytes| Image::Bytes(bytes.into()))
        }
        _ => image.clone(),
    };
    images.iter().map(embed).collect()
}

/// Writes the library `NAME.mtl` beside `NAME.obj`, and the images that are not files yet. Returns the materials, referring
/// to that library. Writes nothing if `path` is standard output or another stream.
fn with_library(path: &Path, materials: &Materials) -> Result<Materials> {
    let Some(stem) = stem(path).filter(|_| is_replaced(path)) else { return Ok(materials.clone()) };
    let folder = folder_of(path);
    let seen_from_there = |image: &Image| match image {
        Image::File(file) => Image::File(relative(folder, Path::new(file))),
        Image::Bytes(_) => image.clone(),
    };
    let images = materials.images.iter().map(seen_from_there).collect();
    let Companions { materials, files } = companions(&stem, &Materials { images, ..materials.clone() });
    for (name, bytes) in files {
        replace_file(&folder.join(name), &mut |out| out.write_all(&bytes))?;
    }
    Ok(materials)
}

/// Returns a file's name without its extensions.
pub(super) fn stem(path: &Path) -> Option<String> {
    let is_gz = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"));
    let name = if is_gz { Path::new(path.file_stem()?) } else { path };
    Some(name.file_stem()?.to_string_lossy().into_owned())
}

/// Returns the path from `folder` to `file`, with slashes; or `file` unchanged if there is no such path or the file does not
/// exist.
fn relative(folder: &Path, file: &Path) -> String {
    let known = fs::canonicalize(folder).ok().zip(folder_and_name(file));
    let from_folder = known.and_then(|(folder, file)| {
        let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
        let up = folder.components().skip(common).map(|_| Component::ParentDir);
        let path: PathBuf = up.chain(file.components().skip(common)).collect();
        (common > 0).then_some(path)
    });
    let path = from_folder.unwrap_or_else(|| file.to_path_buf());
    with_slashes(&path.to_string_lossy())
}

/// Returns the absolute path of a file. All links are resolved, except the file itself if it is one.
fn folder_and_name(file: &Path) -> Option<PathBuf> {
    Some(fs::canonicalize(folder_of(file)).ok()?.join(file.file_name()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_beside_the_one_that_names_them() {
        let folder = tempfile::tempdir().unwrap();
        let beside = Beside(&folder.path().join("a.gltf"));
        fs::write(folder.path().join("a.bin"), b"123").unwrap();
        fs::create_dir(folder.path().join("c")).unwrap();
        assert_eq!(beside.read(Path::new("a.bin")), Ok(b"123".to_vec()));
        assert!(beside.read(Path::new("b.bin")).unwrap_err().contains("cannot be read: there is no such file"));
        assert!(beside.read(Path::new("c")).unwrap_err().contains("not a file"));
    }
}
