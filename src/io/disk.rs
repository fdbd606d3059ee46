//! Files on a disk: replaced only by complete ones, with errors that say what to do.

use crate::base::error::{Error, Result};
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Number of bytes gathered before each write to a file.
pub(super) const BUFFER: usize = 1 << 18;

/// Prefix of the names of incomplete files. A process that is killed leaves them behind.
pub(crate) const UNFINISHED: &str = ".remesh-";

/// Checks that [`replace_file`] can write to `path`, as far as can be told without trying. Meant for use before a long
/// computation.
///
/// # Errors
/// [`Error::File`] if `path` is a folder or a file that must not be written, or its folder does not exist.
pub fn check_target(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(file_error(path, "it is a folder, not a file", "add a file name")),
        Ok(found) if found.permissions().readonly() => {
            Err(file_error(path, "the file is write-protected", "change its permissions or choose another name"))
        }
        Ok(_) => Ok(()),
        Err(_) => check_folder(path),
    }
}

fn check_folder(path: &Path) -> Result<()> {
    let folder = folder_of(path);
    if path.file_name().is_none() || path.as_os_str().as_encoded_bytes().ends_with(b"/") {
        return Err(file_error(path, "it names a folder, not a file", "add a file name"));
    }
    match fs::metadata(folder) {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => Err(file_error(path, format!("'{}' is not a folder", folder.display()), "choose another folder")),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let cause = format!("the folder '{}' does not exist", folder.display());
            Err(file_error(path, cause, "create it or choose another one"))
        }
        Err(error) => Err(write_error(path, &error)),
    }
}

/// Writes what `fill` writes to a new file beside `path`, and renames it to `path` once it is complete and on disk. A
/// failure leaves the old file as it was. A link is followed. Permissions are those of the replaced file, or the defaults of
/// a new file. A path that is not a regular file (`/dev/stdout`, a pipe, a device) is written to directly.
///
/// # Errors
/// [`Error::File`] with the cause, also for an error of `fill`.
pub fn replace_file(path: &Path, fill: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    check_target(path)?;
    let result = match direct(path) {
        Some(target) => target.and_then(|mut target| fill_buffered(&mut target, fill)),
        None => replace(path, fill),
    };
    result.map_err(|error| write_error(path, &error))
}

/// Opens `path` for direct writing if it is a target that is not replaced.
pub(super) fn direct(path: &Path) -> Option<io::Result<Box<dyn Write>>> {
    // If standard output is a file, opening it anew would start at its beginning instead of its current position.
    if path == Path::new("/dev/stdout") {
        return Some(Ok(Box::new(io::stdout())));
    }
    if path == Path::new("/dev/stderr") {
        return Some(Ok(Box::new(io::stderr())));
    }
    let open = || OpenOptions::new().write(true).open(path);
    (!is_replaced(path)).then(|| open().map(|file| Box::new(file) as Box<dyn Write>))
}

/// Whether `path` is, or will become, a regular file, which is replaced as a whole.
pub(super) fn is_replaced(path: &Path) -> bool {
    let is_stream = ["/dev/stdout", "/dev/stderr"].iter().any(|stream| path == Path::new(stream));
    !is_stream && fs::metadata(path).map_or(true, |found| found.is_file()) && !path.starts_with("/dev/fd")
}

fn replace(path: &Path, fill: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    Complete::new(path, fill)?.take_place()
}

/// Writes several files as [`replace_file`] does, but renames none before all are complete, and then renames them in the
/// order of `paths`. `fill` writes the file of a given index.
///
/// # Errors
/// Those of [`replace_file`]. None of the files is left then, unless one of the renames fails: those before it are in place.
pub(super) fn replace_files(
    paths: &[PathBuf],
    fill: &mut dyn FnMut(usize, &mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    let complete = |(i, path): (usize, &PathBuf)| {
        check_target(path)?;
        Complete::new(path, &mut |out| fill(i, out)).map_err(|error| write_error(path, &error))
    };
    let files: Vec<Complete> = paths.iter().enumerate().map(complete).collect::<Result<_>>()?;
    paths.iter().zip(files).try_for_each(|(path, file)| file.take_place().map_err(|error| write_error(path, &error)))
}

/// A complete file that does not have its final name yet. It is deleted if it never gets it.
struct Complete {
    file: tempfile::TempPath,
    target: PathBuf,
}

impl Complete {
    fn new(path: &Path, fill: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<Complete> {
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let mut temporary = temporary_in(folder_of(&target))?;
        fill_buffered(temporary.as_file_mut(), fill)?;
        if let Ok(replaced) = fs::metadata(&target) {
            temporary.as_file().set_permissions(replaced.permissions())?;
        }
        temporary.as_file().sync_all()?;
        Ok(Complete { file: temporary.into_temp_path(), target })
    }

    fn take_place(self) -> io::Result<()> {
        self.file.persist(&self.target).map_err(|failed| failed.error)
    }
}

fn fill_buffered(out: &mut dyn Write, fill: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut buffered = BufWriter::with_capacity(BUFFER, out);
    fill(&mut buffered)?;
    buffered.flush()
}

/// Creates a file that is deleted unless it is kept, with the default permissions of a new file.
fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED);
    #[cfg(unix)]
    let all: fs::Permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(all);
    builder.tempfile_in(folder)
}

pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

pub(super) fn file_error(path: &Path, cause: impl Into<String>, remedy: impl Into<String>) -> Error {
    Error::File { file: path.display().to_string(), cause: cause.into(), remedy: remedy.into() }
}

pub(super) fn read_error(path: &Path, error: &io::Error) -> Error {
    let remedy = match error.kind() {
        ErrorKind::NotFound => "check the name and the folder",
        ErrorKind::PermissionDenied => "change its permissions",
        ErrorKind::OutOfMemory => "reduce the mesh first",
        _ => "check the file and the disk that it is on",
    };
    file_error(path, read_cause(error), remedy)
}

pub(super) fn read_cause(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".into(),
        ErrorKind::PermissionDenied => "permission to read it is denied".into(),
        ErrorKind::OutOfMemory => "the file does not fit in memory".into(),
        _ => one_line(error),
    }
}

pub(super) fn write_error(path: &Path, error: &io::Error) -> Error {
    let (cause, remedy) = match error.kind() {
        ErrorKind::NotFound => ("its folder does not exist".into(), "create it or choose another one"),
        ErrorKind::PermissionDenied => ("permission to write it is denied".into(), "choose another folder"),
        ErrorKind::ReadOnlyFilesystem => ("the disk is read-only".into(), "choose another folder"),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            ("no space is left for it".into(), "free some space or choose another folder")
        }
        ErrorKind::BrokenPipe => ("the reader of the pipe has closed it".into(), "check the command that reads it"),
        ErrorKind::InvalidData => (one_line(error), "choose another format or repair the mesh"),
        _ => (one_line(error), "check the folder and the disk that it is on"),
    };
    file_error(path, cause, remedy)
}

fn one_line(error: &io::Error) -> String {
    error.to_string().replace(['\n', '\r'], " ")
}
