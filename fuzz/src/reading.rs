//! Checks reading: any bytes give a valid mesh, or an error in a line; and what was read can be written, and read
//! again.

use crate::files::audit;
use spectral_remesh::io::{self, Folder, Format, read_named};
use spectral_remesh::{Error, Image};
use std::io::Write;
use std::path::Path;

/// What bytes are taken for.
#[derive(Clone, Copy)]
pub enum Kind {
    /// A file without a name, as the program reads it: of any format, perhaps packed.
    Any,
    Of(Format),
    /// An E57 file whose check sums are set right, so that changes get past them.
    SealedE57,
    /// The library of materials of an OBJ.
    Library,
    /// The model in a 3MF, whose archive is put around it.
    Model,
}

impl Kind {
    /// The one that the variable FORMAT names.
    pub fn from_environment() -> Kind {
        match std::env::var("FORMAT").as_deref() {
            Err(_) => Kind::Any,
            Ok("mtl") => Kind::Library,
            Ok("model") => Kind::Model,
            Ok("e57") => Kind::SealedE57,
            Ok(name) => Kind::Of(name.parse().unwrap_or_else(|e| panic!("{e}, mtl, model"))),
        }
    }

    /// Lets those crates panic whose panics are caught by the reader that calls them: the fuzzer's hook would end it there.
    /// Any other panic ends it as well without that hook.
    pub fn allow_caught_panics(self) {
        if matches!(self, Kind::Any | Kind::Of(Format::Las) | Kind::SealedE57) {
            std::panic::set_hook(Box::new(|_| ()));
        }
    }
}

/// Each file that a file names has the same bytes.
struct Same<'a>(&'a [u8]);

impl Folder for Same<'_> {
    fn read(&self, _: &Path) -> Result<Vec<u8>, String> {
        Ok(self.0.to_vec())
    }

    fn image(&self, name: &str) -> (Image, bool) {
        (Image::File(name.into()), true)
    }
}

/// Reads them, and checks what is promised of the result.
pub fn read(kind: Kind, bytes: &[u8]) {
    let (bytes, format) = match kind {
        Kind::Any => (bytes.to_vec(), None),
        Kind::Of(format) => (bytes.to_vec(), Some(format)),
        Kind::SealedE57 => (sealed(bytes), Some(Format::E57)),
        Kind::Model => (archive(bytes), Some(Format::ThreeMf)),
        Kind::Library => {
            let obj = b"mtllib a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n";
            let loaded = read_named("name", obj, Some(Format::Obj), &Same(bytes)).expect("the OBJ is whole");
            return written_is_read(&loaded);
        }
    };
    match read_named("name", &bytes, format, &Same(&bytes)) {
        // Nothing at all, or nothing that looks like a format.
        Err(Error::File { .. }) => {}
        read => {
            if let Some(loaded) = audit(read) {
                written_is_read(&loaded);
            }
        }
    }
}

/// Whatever was read can be written in any format, but for what it has no numbers for, and read again.
fn written_is_read(loaded: &io::Loaded) {
    let triangles = loaded.mesh.triangles.len();
    for format in Format::OF_MESHES.into_iter().filter(|_| triangles > 0) {
        let mut bytes = Vec::new();
        if io::write_with_attributes(&loaded.mesh, &loaded.attributes, format, &mut bytes).is_ok() {
            let back = io::parse(&bytes, format, io::NO_BUFFERS);
            let back = back.unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(&bytes)));
            assert!([0, triangles].contains(&back.mesh.triangles.len()), "{format}");
        }
    }
}

/// An archive with one file, the model.
fn archive(model: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    archive.start_file("3D/3dmodel.model", stored).expect("memory does not fail");
    archive.write_all(model).expect("memory does not fail");
    archive.finish().expect("memory does not fail").into_inner()
}

/// The bytes of an E57 file with the right check sum at the end of each page.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    const SUM: usize = 4;
    let mut bytes = bytes.to_vec();
    let size = bytes.get(40..48).and_then(|size| u64::from_le_bytes(size.try_into().ok()?).try_into().ok());
    if let Some(size) = size.filter(|size| (SUM + 1..=bytes.len()).contains(size)) {
        for page in bytes.chunks_exact_mut(size) {
            let (content, sum) = page.split_at_mut(size - SUM);
            sum.copy_from_slice(&check_sum(content).to_be_bytes());
        }
    }
    bytes
}

/// CRC-32C, bit by bit.
fn check_sum(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0x82F6_3B78;
    let step = |sum: u32| if sum & 1 == 1 { sum >> 1 ^ POLYNOMIAL } else { sum >> 1 };
    !bytes.iter().fold(!0, |sum, &byte| (0..8).fold(sum ^ u32::from(byte), |sum, _| step(sum)))
}
