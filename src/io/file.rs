//! Reading and writing of mesh files on disk, by path.

use crate::base::error::{Error, Place, Result};
use crate::io::beside::{Beside, prepared, stem};
use crate::io::dense::read_thinned;
use crate::io::disk::{file_error, is_replaced, read_error, replace_files};
use crate::io::format::Format;
use crate::io::gzip;
use crate::io::named::{by_ending, is_gz, read_named};
use crate::io::read::Loaded;
use crate::io::tileset::Tileset;
use crate::io::write::{write_levels, write_points, write_with_attributes};
use crate::mesh::attributes::Attributes;
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::thin::Wanted;
use std::fs::{self, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub(crate) use crate::io::disk::UNFINISHED;
pub use crate::io::disk::{check_target, replace_file};
pub use crate::io::tileset::Level;

/// Reads the mesh file at `path` by [`read_named`]. Files that it names are read from its folder and the subfolders.
///
/// # Errors
/// [`Error::File`] if there is no such file or it cannot be read; those of [`read_named`].
pub fn read_file(path: &Path, format: Option<Format>) -> Result<Loaded> {
    read_named(&path.display().to_string(), &read_bytes(path)?, format, &Beside(path))
}

/// Reads a mesh file like [`read_file`], but of a cloud only the wanted points. [`Loaded::thinned`] then says which.
/// Binary PLY, LAS, XYZ and E57 are thinned without holding all points in memory. Files that cannot be thinned are read by
/// [`read_file`].
///
/// # Errors
/// Those of [`read_file`].
pub fn read_wanted(path: &Path, format: Option<Format>, wanted: Wanted) -> Result<Loaded> {
    let thinned = if wanted == Wanted::default() { None } else { read_thinned(path, format, wanted)? };
    thinned.map_or_else(|| read_file(path, format), Ok)
}

/// Reads a list of numbers from the JSON file at `path`.
///
/// # Errors
/// [`Error::File`] if it cannot be read; [`Error::Format`] with the line if it is not a list of numbers.
pub fn read_numbers(path: &Path) -> Result<Vec<f64>> {
    serde_json::from_slice(&read_bytes(path)?).map_err(|e| Error::Format {
        file: path.display().to_string(),
        place: Place::Line(e.line()),
        cause: format!("not a JSON list of numbers: {e}"),
        remedy: "write it as [0.5, 0.25, 0.5]".into(),
    })
}

/// Writes `mesh`, and those of its `attributes` that the format can hold, to `path` by [`replace_file`], in the format of
/// [`output_format`]. An OBJ with materials gets their library beside it, `NAME.mtl`, with the images that are not files
/// yet.
///
/// # Errors
/// [`Error::File`] if the format is unknown or the file cannot be written.
pub fn write_file(path: &Path, mesh: &Mesh, attributes: &Attributes, format: Option<Format>) -> Result<()> {
    let format = output_format(path, format)?;
    check_target(path)?;
    let attributes = &*prepared(path, format, attributes)?;
    replace_packed(path, &mut |out| write_with_attributes(mesh, attributes, format, out))
}

/// Writes the levels of detail of a mesh to one file at `path` by [`replace_file`], as [`write_levels`] does.
///
/// # Errors
/// Those of [`write_file`], also for a format that holds only one mesh.
pub fn write_levels_file(path: &Path, levels: &[(&Mesh, &Attributes)], format: Option<Format>) -> Result<()> {
    let format = output_format(path, format)?;
    check_target(path)?;
    let attributes: Vec<_> = levels.iter().map(|level| prepared(path, format, level.1)).collect::<Result<_>>()?;
    let levels: Vec<(&Mesh, &Attributes)> =
        levels.iter().zip(&attributes).map(|(level, own)| (level.0, &**own)).collect();
    replace_packed(path, &mut |out| write_levels(&levels, format, out))
}

/// Whether the name of an output denotes a tileset of 3D Tiles, which it does if it ends with `.json`.
pub fn is_tileset(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

/// Writes a mesh, or its levels of detail from fine to coarse, as 3D Tiles: the tileset at `path`, and beside it the files
/// of its tiles, `NAME-1-0.glb` and so on, where the first number is the level. No file is replaced before all are complete.
///
/// # Errors
/// [`Error::File`] if one of them cannot be written.
pub fn write_tileset(path: &Path, levels: &[Level]) -> Result<()> {
    let attributes: Vec<_> =
        levels.iter().map(|level| prepared(path, Format::Glb, level.attributes)).collect::<Result<_>>()?;
    let levels: Vec<Level> =
        levels.iter().zip(&attributes).map(|(level, own)| Level { attributes: own, ..*level }).collect();
    let tileset = Tileset::new(&levels);
    let files = tileset.files(&stem(path).unwrap_or_default());
    let mut paths: Vec<PathBuf> = files.iter().map(|(name, _)| path.with_file_name(name)).collect();
    // Last, so that it never names a missing file.
    paths.push(path.into());
    replace_files(&paths, &mut |i, out| match files.get(i) {
        Some((_, tile)) => tileset.write_tile(*tile, out),
        None => out.write_all(tileset.json(&files).to_string().as_bytes()),
    })
}

/// Returns the path of the file of one of several levels of detail, numbered from 1: `NAME-1.obj` for `NAME.obj`.
///
/// # Errors
/// [`Error::File`] if `path` is a stream or does not name a file.
pub fn level_path(path: &Path, number: usize) -> Result<PathBuf> {
    let stem = stem(path).filter(|_| is_replaced(path)).ok_or_else(|| {
        let remedy =
            "give a file name, from which the names of the levels are made, or write GLB, which holds all levels";
        file_error(path, "it is a single stream, but each level needs a file of its own", remedy)
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok(path.with_file_name(format!("{stem}-{number}{}", &name[stem.len()..])))
}

/// Writes `points`, and those of their `attributes` that the format can hold, to `path` by [`replace_file`], in the format
/// of [`points_format`].
///
/// # Errors
/// [`Error::File`] if the format is unknown or the file cannot be written.
pub fn write_points_file(path: &Path, points: &Points, attributes: &Attributes, format: Option<Format>) -> Result<()> {
    let format = points_format(path, format)?;
    replace_packed(path, &mut |out| write_points(points, attributes, format, out))
}

/// Writes what `fill` writes by [`replace_file`], compressed by gzip if the name ends with `.gz`.
fn replace_packed(path: &Path, fill: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    if path.extension().is_some_and(is_gz) {
        return replace_file(path, &mut |out| gzip::pack(out, fill));
    }
    replace_file(path, fill)
}

/// Returns the format in which a mesh is written to `path`: `format`, else that of the file's extension.
///
/// # Errors
/// [`Error::File`] if neither gives a format, or if the format has no triangles.
pub fn output_format(path: &Path, format: Option<Format>) -> Result<Format> {
    format_among(&Format::OF_MESHES, "triangles", path, format)
}

/// Returns the format in which points are written to `path`: `format`, else that of the file's extension.
///
/// # Errors
/// [`Error::File`] if neither gives a format, or if the format has no points without triangles.
pub fn points_format(path: &Path, format: Option<Format>) -> Result<Format> {
    format_among(&Format::OF_POINTS, "points without triangles", path, format)
}

fn format_among(known: &[Format], content: &str, path: &Path, format: Option<Format>) -> Result<Format> {
    let cause = match (format.or_else(|| by_ending(path)), path.extension()) {
        (Some(format), _) if known.contains(&format) => return Ok(format),
        (Some(format), _) => format!("{format} cannot hold {content}"),
        (None, Some(ending)) => format!("no format with the extension '.{}' can be written", ending.display()),
        (None, None) => "the name has no extension that tells the format".into(),
    };
    Err(file_error(path, cause, format!("use one of {}, or give the format", Format::list(known, "."))))
}

/// Reads a whole file, which must be neither a folder nor a device.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let found = fs::metadata(path).map_err(|error| read_error(path, &error))?;
    if found.is_dir() {
        return Err(file_error(path, "it is a folder, not a file", "name a mesh file in it"));
    }
    if is_device(&found) {
        return Err(file_error(path, "it is a device, not a file", "name a mesh file"));
    }
    fs::read(path).map_err(|error| read_error(path, &error))
}

/// Devices may have no end; pipes are read until they close.
#[cfg(unix)]
fn is_device(found: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_char_device() || found.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::disk::BUFFER;
    use glam::DVec3;
    use std::io::ErrorKind;

    fn triangle() -> Mesh {
        Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] }
    }

    fn write(path: &Path, format: Option<Format>) -> Result<()> {
        write_file(path, &triangle(), &Attributes::default(), format)
    }

    /// Creates a file with this content in a temporary folder. Returns the folder and the path of the file.
    fn file(name: &str, content: &[u8]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        (folder, path)
    }

    fn names_in(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[track_caller]
    fn fails<T: std::fmt::Debug>(result: Result<T>, path: &Path, words: &str) {
        let message = result.unwrap_err().to_string();
        let rest = message.strip_prefix(&*path.display().to_string()).expect(&message);
        assert!(rest.contains(words), "{message}");
        assert!(rest.contains("; ") && !message.contains('\n'), "{message}");
    }

    const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const OFF: &[u8] = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    #[test]
    fn the_format_comes_from_the_option_the_ending_or_the_content() {
        for (name, content, option, expected) in [
            ("a.obj", OBJ, None, Format::Obj),
            ("a.OFF", OFF, None, Format::Off),
            ("a", OFF, None, Format::Off),
            ("a.txt", OBJ, None, Format::Obj),
            ("a.obj", OFF, Some(Format::Off), Format::Off),
            ("a.dae", OFF, None, Format::Off),
        ] {
            let (_folder, path) = file(name, content);
            let loaded = read_file(&path, option).unwrap();
            assert_eq!((loaded.mesh, loaded.format), (triangle(), expected));
        }
    }

    #[test]
    fn wrong_files_are_named_with_the_remedy() {
        let (folder, path) = file("a.obj", OFF);
        fails(
            read_file(&path, None),
            &path,
            "extension says OBJ, but the content is OFF; rename the file or give off as its format",
        );
        fails(read_file(folder.path(), None), folder.path(), "folder");
        let missing = folder.path().join("b.obj");
        fails(read_file(&missing, None), &missing, "no such file");
        let below = path.join("b.obj");
        fails(read_file(&below, None), &below, "");
        for (name, content, words) in [
            ("a.obj", &b""[..], "empty"),
            ("a.doc", b"\x89PNG", "give its format: one of obj,"),
            ("a.xyz", b"\x89PNG", "no numbers"),
            ("a.dae", b"<COLLADA>", "it is a COLLADA file, which is not supported; convert it with Blender"),
            ("a.pts", b"ISO-10303-21;\n1 2 3\n", "it is a STEP file"),
            ("a.usdz", b"PK\x03\x04", "it is a USD file"),
            ("a", b"PK\x03\x04", "it is an archive, which is not supported; unpack it"),
            ("a.fbx", b"1 2 3\n1 2 3\n", "it is an FBX file"),
            ("a.drc", b"DRACO\x02", "draco_decoder -i IN.drc -o OUT.ply"),
            ("a.pts", b"\0\0\x80\x3f\0\0\x80\x3f", "binary, not text with columns of numbers; export"),
            ("a.dat", b"a text\n1 2 3\n4 5 6\n", "give its format: one of"),
            ("a.ply.gz", b"\x1f\x8b\x08\0\0", "cannot be unpacked"),
            ("a.obj", b"v 0 0 nan", ":1: the coordinate 'nan' is not finite"),
            ("a.obj", b"\x89PNG", "no vertices"),
        ] {
            let (_folder, path) = file(name, content);
            fails(read_file(&path, None), &path, words);
        }
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_not_read() {
        let zero = Path::new("/dev/zero");
        fails(read_file(zero, Some(Format::Obj)), zero, "device");
    }

    #[cfg(unix)]
    #[test]
    fn protected_files_are_neither_read_nor_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let (_folder, path) = file("a.obj", OBJ);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).unwrap();
        // Users who may read everything (root) can read this file, too.
        if fs::read(&path).is_err() {
            fails(read_file(&path, None), &path, "permission");
        }
        fails(write(&path, None), &path, "write-protected");
    }

    #[test]
    fn written_files_read_as_the_same_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        for format in Format::OF_MESHES {
            let path = folder.path().join("a").with_extension(format.extension());
            for _ in 0..2 {
                write(&path, None).unwrap();
                let loaded = read_file(&path, None).unwrap();
                assert_eq!((loaded.mesh, loaded.format), (triangle(), format));
            }
        }
        assert_eq!(names_in(folder.path()).len(), Format::OF_MESHES.len());
    }

    #[test]
    fn files_are_packed_as_the_name_says_and_unpacked_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.ply.gz", "a.OBJ.GZ", "a.off.gz"] {
            let path = folder.path().join(name);
            write(&path, None).unwrap();
            assert!(gzip::is_packed(&fs::read(&path).unwrap()));
            assert_eq!(read_file(&path, None).unwrap().mesh, triangle());
            let renamed = folder.path().join("b");
            fs::rename(&path, &renamed).unwrap();
            assert_eq!(read_file(&renamed, None).unwrap().mesh, triangle());
        }
        let orphan = folder.path().join("a.gz");
        fails(write(&orphan, None), &orphan, "use one of .obj, .ply");
    }

    #[test]
    fn levels_have_names_of_their_own() {
        let named = |path: &str| level_path(Path::new(path), 3).map(|path| path.display().to_string());
        assert_eq!(named("a.obj").unwrap(), "a-3.obj");
        assert_eq!(named("b/a.1.ply.gz").unwrap(), "b/a.1-3.ply.gz");
        assert_eq!(named("a").unwrap(), "a-3");
        fails(named("/dev/stdout"), Path::new("/dev/stdout"), "or write GLB");
    }

    #[test]
    fn a_failure_leaves_what_was_there() {
        let (folder, path) = file("a.obj", b"old");
        let full = || Err(io::Error::from(ErrorKind::StorageFull));
        let result = replace_file(&path, &mut |out| out.write_all(&[b'x'; 2 * BUFFER]).and_then(|()| full()));
        fails(result, &path, "no space is left");
        let new = folder.path().join("b.obj");
        fails(replace_file(&new, &mut |_| Err(io::Error::other("a\nb"))), &new, "a b");
        let panicked = std::panic::catch_unwind(|| replace_file(&new, &mut |_| panic!("on purpose")));
        assert!(panicked.is_err());
        assert_eq!(names_in(folder.path()), ["a.obj"]);
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn targets_that_cannot_be() {
        let (folder, path) = file("a.obj", OBJ);
        fails(write(folder.path(), Some(Format::Obj)), folder.path(), "folder");
        let orphan = folder.path().join("none").join("b.obj");
        fails(write(&orphan, None), &orphan, "none' does not exist");
        let below = path.join("b.obj");
        fails(write(&below, None), &below, "is not a folder");
        for name in ["b", "b.doc", "b.xyz"] {
            let unknown = folder.path().join(name);
            fails(write(&unknown, None), &unknown, "use one of .obj, .ply");
        }
        assert_eq!(names_in(folder.path()), ["a.obj"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let (folder, path) = file("a.obj", b"old");
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let usual = mode(&path);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        let link = folder.path().join("link.obj");
        std::os::unix::fs::symlink("a.obj", &link).unwrap();
        write(&link, None).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!((fs::read(&path).unwrap(), mode(&path)), (OBJ.to_vec(), 0o640));
        let new = folder.path().join("new.obj");
        write(&new, None).unwrap();
        assert_eq!(mode(&new), usual);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_not_a_file_is_written_directly() {
        let full = Path::new("/dev/full");
        fails(write(full, Some(Format::Obj)), full, "no space is left");
        write(Path::new("/dev/null"), Some(Format::Obj)).unwrap();
        assert!(is_device(&fs::metadata("/dev/null").unwrap()));
    }
}
