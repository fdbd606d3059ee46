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
    let mtl::Library { looks, images } = library;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::file::{read_file, write_file};
    use crate::mesh::materials::{Alpha, Look};

    const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
                       usemtl wood\nf 1/1 2/2 3/3\nusemtl glass\nf 3/3 2/2 1/1\n";
    const MTL: &str = "newmtl wood\nNs 100\nmap_Kd -s 2 2 2 images\\my wood.png\nnewmtl glass\nd 0.5\n";
    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n1234";

    /// A folder with an OBJ, its library, its image, and a folder to write to.
    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in ["in/images", "out/deep"] {
            fs::create_dir_all(folder.path().join(name)).unwrap();
        }
        for (name, content) in
            [("in/a.obj", OBJ.as_bytes()), ("in/a.mtl", MTL.as_bytes()), ("in/images/my wood.png", PNG)]
        {
            fs::write(folder.path().join(name), content).unwrap();
        }
        folder
    }

    /// Reads one file and writes what it is to the other; the attributes and notes of the first.
    fn converted(folder: &Path, from: &str, to: &str) -> (Attributes, Vec<String>) {
        let loaded = read_file(&folder.join(from), None).unwrap();
        write_file(&folder.join(to), &loaded.mesh, &loaded.attributes, None).unwrap();
        (loaded.attributes, loaded.notes)
    }

    fn look(attributes: &Attributes, material: usize) -> &Look {
        attributes.materials.as_ref().unwrap().list[material].look.as_ref().unwrap()
    }

    #[test]
    fn a_library_goes_with_its_mesh_and_images_are_still_found() {
        let folder = folder();
        let (attributes, notes) = converted(folder.path(), "in/a.obj", "out/deep/b.obj");
        assert!(notes.is_empty(), "{notes:?}");
        assert_eq!((look(&attributes, 0).textures.len(), look(&attributes, 1).alpha), (1, Alpha::Blend));
        let text = |name: &str| fs::read_to_string(folder.path().join("out/deep").join(name)).unwrap();
        assert!(text("b.obj").starts_with("mtllib b.mtl\n"));
        assert_eq!(
            text("b.mtl"),
            "newmtl wood\nNs 100\nmap_Kd -s 2 2 2 ../../in/images/my wood.png\n\nnewmtl glass\nd 0.5\n\n"
        );
        let again = read_file(&folder.path().join("out/deep/b.obj"), None).unwrap();
        assert_eq!((again.notes, look(&again.attributes, 0)), (vec![], look(&attributes, 0)));
    }

    #[test]
    fn images_get_into_glb_and_out_of_it() {
        let folder = folder();
        converted(folder.path(), "in/a.obj", "out/b.glb");
        let (attributes, _) = converted(folder.path(), "out/b.glb", "out/c.obj.gz");
        assert_eq!(attributes.materials.unwrap().images, [Image::Bytes(PNG.into())]);
        assert_eq!(fs::read(folder.path().join("out/c-0.png")).unwrap(), PNG);
        assert!(fs::read_to_string(folder.path().join("out/c.mtl")).unwrap().contains("map_Kd c-0.png\n"));
        let last = read_file(&folder.path().join("out/c.obj.gz"), None).unwrap();
        assert_eq!((last.notes, look(&last.attributes, 0).textures.len()), (vec![], 1));
    }

    #[test]
    fn what_is_not_there_is_said_and_stays_named() {
        let folder = folder();
        fs::remove_file(folder.path().join("in/images/my wood.png")).unwrap();
        let (_, notes) = converted(folder.path(), "in/a.obj", "in/b.glb");
        assert_eq!(notes, ["the image 'images\\\\my wood.png' does not exist"]);
        fs::remove_file(folder.path().join("in/a.mtl")).unwrap();
        let (_, notes) = converted(folder.path(), "in/a.obj", "in/b.obj");
        assert_eq!(
            notes,
            ["the library of materials is not read: the file 'a.mtl' cannot be read: there is no such file"]
        );
        assert!(fs::read_to_string(folder.path().join("in/b.obj")).unwrap().starts_with("mtllib a.mtl\n"));
        assert!(!folder.path().join("in/b.mtl").exists());
        fs::write(folder.path().join("in/a.obj"), OBJ.replace("a.mtl", "../a.mtl")).unwrap();
        let (_, notes) = converted(folder.path(), "in/a.obj", "in/b.obj");
        assert!(notes[0].contains("'../a.mtl' is not in the folder"), "{notes:?}");
    }
}
