//! Files beside the file of a mesh: the libraries and images of its materials.

use crate::base::error::Result;
use crate::io::address::read_inside;
use crate::io::disk::{folder_of, is_replaced, replace_file};
use crate::io::format::Format;
use crate::io::obj::mtl;
use crate::mesh::attributes::Attributes;
use crate::mesh::materials::{Image, Materials, image_type};
use std::borrow::Cow;
use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Reads the libraries that the file at `path` names, from its folder and those in it, and finds the images that they
/// name. Notes say which ones there are not; libraries that cannot be read stay named.
pub(super) fn read_libraries(path: &Path, materials: &mut Materials, notes: &mut Vec<String>) {
    for name in std::mem::take(&mut materials.libraries) {
        match library(path, &name) {
            Ok(library) => define(path, materials, library, notes),
            Err(cause) => {
                notes.push(format!("the library of materials is not read: {cause}"));
                materials.libraries.push(name);
            }
        }
    }
}

/// The library `name`, or all those whose names it is.
fn library(path: &Path, name: &str) -> std::result::Result<mtl::Library, String> {
    read_inside(path, &with_slashes(name)).map(|bytes| mtl::parse(&bytes))
}

/// Gives the materials that `library` defines, and that are not defined yet, their looks.
fn define(path: &Path, materials: &mut Materials, library: mtl::Library, notes: &mut Vec<String>) {
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
                let file = folder_of(path).join(with_slashes(name));
                if !file.is_file() {
                    notes.push(format!("the image '{}' does not exist", name.escape_debug()));
                }
                all.push(Image::File(file.to_string_lossy().into_owned()));
                all.len() as u32 - 1
            });
        }
        material.look = Some(look);
    }
}

/// Some programs write names with the backslashes of their system.
fn with_slashes(name: &str) -> String {
    name.replace('\\', "/")
}

/// The attributes as a file of `format` at `path` has to have them: for OBJ with a library and images beside it, which
/// are written here; for glTF with all images as bytes.
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

/// The images with the content of their files, as far as it is PNG or JPEG.
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

/// Writes the library `NAME.mtl` beside `NAME.obj`, and the images that are no files yet; the materials with that library.
/// What is not a file in a folder, such as standard output, has none.
fn with_library(path: &Path, materials: &Materials) -> Result<Materials> {
    let mut materials = materials.clone();
    let defines = materials.list.iter().any(|material| material.look.is_some());
    let Some(stem) = stem(path).filter(|_| defines && is_replaced(path)) else { return Ok(materials) };
    for (i, image) in materials.images.iter_mut().enumerate() {
        *image = Image::File(beside(path, &format!("{stem}-{i}"), image)?);
    }
    mtl::name_apart(&mut materials.list);
    let library = format!("{stem}.mtl");
    replace_file(&folder_of(path).join(&library), &mut |out| mtl::write(&materials, out))?;
    materials.libraries.push(library);
    Ok(materials)
}

/// The name of a file without its endings.
fn stem(path: &Path) -> Option<String> {
    let is_gz = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"));
    let name = if is_gz { Path::new(path.file_stem()?) } else { path };
    Some(name.file_stem()?.to_string_lossy().into_owned())
}

/// The path to an image from the folder of `path`. One that is no file is written there as `name`.
fn beside(path: &Path, name: &str, image: &Image) -> Result<String> {
    match image {
        Image::File(file) => Ok(relative(folder_of(path), Path::new(file))),
        Image::Bytes(bytes) => {
            let name = format!("{name}.{}", image_type(bytes).map_or("bin", |(_, ending)| ending));
            replace_file(&folder_of(path).join(&name), &mut |out| out.write_all(bytes))?;
            Ok(name)
        }
    }
}

/// The path to `file` from `folder`, with slashes; `file` as it is where there is none, or it does not exist.
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

/// The path of a file from the root, through no link but its own.
fn folder_and_name(file: &Path) -> Option<PathBuf> {
    Some(fs::canonicalize(folder_of(file)).ok()?.join(file.file_name()?))
}
