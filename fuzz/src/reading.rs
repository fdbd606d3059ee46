//! Checks reading: any bytes give a valid mesh or a one-line error, and what was read can be written and read again.

use crate::files::audit;
use spectral_remesh::io::{self, Folder, Format, read_named};
use spectral_remesh::{Error, Image};
use std::io::Write;
use std::path::Path;

/// How bytes are interpreted.
#[derive(Clone, Copy)]
pub enum Kind {
    /// A file without a name, as the program reads it: of any format, possibly compressed.
    Any,
    Of(Format),
    /// An E57 file whose checksums are corrected, so that mutations get past them.
    SealedE57,
    /// The material library of an OBJ.
    Library,
    /// The model in a 3MF; the archive around it is added here.
    Model,
}

impl Kind {
    /// Returns the kind named by the variable FORMAT.
    pub fn from_environment() -> Kind {
        match std::env::var("FORMAT").as_deref() {
            Err(_) => Kind::Any,
            Ok("mtl") => Kind::Library,
            Ok("model") => Kind::Model,
            Ok("e57") => Kind::SealedE57,
            Ok(name) => Kind::Of(name.parse().unwrap_or_else(|e| panic!("{e}, mtl, model"))),
        }
    }

    /// Removes the fuzzer's panic hook, which would end the run, for formats whose crates may panic: the readers that call
    /// these crates catch their panics. Any other panic ends the run even without the hook.
    pub fn allow_caught_panics(self) {
        if matches!(self, Kind::Any | Kind::Of(Format::Las) | Kind::SealedE57) {
            std::panic::set_hook(Box::new(|_| ()));
        }
    }
}

/// A folder in which every referenced file has the same bytes.
struct Same<'a>(&'a [u8]);

impl Folder for Same<'_> {
    fn read(&self, _: &Path) -> Result<Vec<u8>, String> {
        Ok(self.0.to_vec())
    }

    fn image(&self, name: &str) -> (Image, bool) {
        (Image::File(name.into()), true)
    }
}

/// Reads the bytes, and checks what is promised for the result.
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
        // The bytes are empty, or look like no known format.
        Err(Error::File { .. }) => {}
        read => {
            if let Some(loaded) = audit(read) {
                written_is_read(&loaded);
            }
        }
    }
}

/// Checks that what was read can be written in any format and read again, except for values that the format cannot represent.
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

/// Returns an archive with the model as its only file.
fn archive(model: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    archive.start_file("3D/3dmodel.model", stored).expect("memory does not fail");
    archive.write_all(model).expect("memory does not fail");
    archive.finish().expect("memory does not fail").into_inner()
}

/// Returns the bytes of an E57 file with the correct checksum at the end of each page.
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

/// Computes the CRC-32C bit by bit.
fn check_sum(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0x82F6_3B78;
    let step = |sum: u32| if sum & 1 == 1 { sum >> 1 ^ POLYNOMIAL } else { sum >> 1 };
    !bytes.iter().fold(!0, |sum, &byte| (0..8).fold(sum ^ u32::from(byte), |sum, _| step(sum)))
}
