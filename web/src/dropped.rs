//! Files dropped on the page together: a mesh, and the files that it refers to.

use spectral_remesh::Image;
use spectral_remesh::io::{Folder, Format};
use std::path::Path;

/// The name and the content of a file.
pub type File<'a> = (&'a str, &'a [u8]);

/// Dropped files. Their names have no folders.
pub struct Dropped<'a>(pub Vec<File<'a>>);

impl<'a> Dropped<'a> {
    /// Returns the mesh (the first file with a readable format's extension, otherwise the first file), and the names of the
    /// other meshes.
    pub fn mesh(&self) -> Option<(File<'a>, Vec<&'a str>)> {
        let mut meshes = self.0.iter().filter(|(name, _)| is_mesh(name));
        let first = meshes.next().or(self.0.first())?;
        Some((*first, meshes.map(|(name, _)| *name).collect()))
    }

    /// Returns the content of the file with the same file name. Folders in `name` are ignored, since dropped files have none.
    fn find(&self, name: &Path) -> Option<&'a [u8]> {
        let wanted = name.file_name()?.to_str()?;
        self.0.iter().find(|(name, _)| name.eq_ignore_ascii_case(wanted)).map(|(_, bytes)| *bytes)
    }
}

impl Folder for Dropped<'_> {
    fn read(&self, name: &Path) -> Result<Vec<u8>, String> {
        self.find(name).map(<[u8]>::to_vec).ok_or_else(|| "was not dropped: drop both files together".into())
    }

    fn image(&self, name: &str) -> (Image, bool) {
        match self.find(Path::new(name)) {
            Some(bytes) => (Image::Bytes(bytes.into()), true),
            None => (Image::File(name.into()), false),
        }
    }
}

/// Returns a name without the extension `.gz`.
fn unpacked(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((rest, ending)) if ending.eq_ignore_ascii_case("gz") => rest,
        _ => name,
    }
}

/// Returns a name without its extensions.
pub fn stem(name: &str) -> &str {
    let name = unpacked(name);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

fn is_mesh(name: &str) -> bool {
    unpacked(name).rsplit_once('.').is_some_and(|(_, ending)| Format::from_extension(ending).is_some())
}
