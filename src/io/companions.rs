//! Files that are written with an OBJ: its material library, and the images that the library names.

use crate::io::obj::mtl;
use crate::mesh::materials::{Image, Materials, image_type};

/// Materials whose looks are in files of their own.
pub struct Companions {
    /// Materials as the OBJ names them, with a reference to the new library.
    pub materials: Materials,
    /// Names of files in the folder of the OBJ, and their content.
    pub files: Vec<(String, Vec<u8>)>,
}

/// Returns the files that an OBJ named `stem` needs beside it: `stem.mtl`, and the images that are not files yet. There are
/// none if no material has a look.
pub fn companions(stem: &str, materials: &Materials) -> Companions {
    let (mut materials, mut files) = (materials.clone(), Vec::new());
    if materials.list.iter().all(|material| material.look.is_none()) {
        return Companions { materials, files };
    }
    for (i, image) in materials.images.iter_mut().enumerate() {
        if let Image::Bytes(bytes) = image {
            let name = format!("{stem}-{i}.{}", image_type(bytes).map_or("bin", |(_, ending)| ending));
            files.push((name.clone(), bytes.to_vec()));
            *image = Image::File(name);
        }
    }
    mtl::name_apart(&mut materials.list);
    let mut library = Vec::new();
    mtl::write(&materials, &mut library).expect("memory does not fail");
    files.push((format!("{stem}.mtl"), library));
    materials.libraries.push(format!("{stem}.mtl"));
    Companions { materials, files }
}
