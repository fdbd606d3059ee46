//! The folder in which tiles are sampled: its files and their contents.
//!
//! | file | content |
//! |---|---|
//! | `plan.json` | the [`Plan`], written last |
//! | `head` | the beginning of the input, which describes its rows |
//! | `points` | number and row of each point, sorted by place |
//! | `outline.ply` | a few points with normals on a common side |
//! | `made-of` | what the plan was made from |
//! | `tile-N` | the samples of tile N, written when the tile is complete |
//! | `piece-N` | the base mesh (0), nodes, or triangles of the mesh, written when they are complete |

use crate::base::error::{Error, Result};
use crate::io::file::{UNFINISHED, read_bytes, read_file, replace_file, write_points_file};
use crate::io::spill::Chunk;
use crate::io::table::Table;
use crate::io::{dense, spill};
use crate::mesh::attributes::Attributes;
use crate::mesh::points::Points;
use crate::pipeline::{Outline, TilePoint};
use crate::tiles::made::MadePiece;
use crate::tiles::plan::{Plan, PlanOptions};
use glam::DVec3;
use std::fs;
use std::path::{Path, PathBuf};

/// Bytes of a sample: its number, its position, its normal.
const SAMPLE: usize = 4 + 2 * 24;

/// A folder in which tiles are sampled.
#[derive(Debug, Clone)]
pub struct TileFolder {
    path: PathBuf,
}

impl TileFolder {
    /// Opens the folder at `path`, which must exist.
    ///
    /// # Errors
    /// [`Error::File`] if it does not exist or is not a folder.
    pub fn at(path: &Path) -> Result<TileFolder> {
        let folder = TileFolder { path: path.into() };
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Ok(folder),
            Ok(_) => Err(folder.error("it is not a folder", "choose another one")),
            Err(_) => Err(folder.error("there is no such folder", "create it or choose another one")),
        }
    }

    /// Opens the folder at `path`, and creates it if it does not exist.
    ///
    /// # Errors
    /// [`Error::File`] if that fails.
    pub fn make(path: &Path) -> Result<TileFolder> {
        let failed = |error: std::io::Error| Error::File {
            file: path.display().to_string(),
            cause: format!("the folder cannot be created: {error}"),
            remedy: "choose another one".into(),
        };
        fs::create_dir_all(path).map_err(failed)?;
        TileFolder::at(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    fn tile(&self, number: usize) -> PathBuf {
        self.file(&format!("tile-{number}"))
    }

    pub(super) fn points(&self) -> PathBuf {
        self.file("points")
    }

    pub(super) fn error(&self, cause: impl Into<String>, remedy: &str) -> Error {
        Error::File { file: self.path.display().to_string(), cause: cause.into(), remedy: remedy.into() }
    }

    /// Returns whether there is a plan.
    pub fn has_plan(&self) -> bool {
        self.file("plan.json").is_file()
    }

    /// Reads the plan.
    ///
    /// # Errors
    /// [`Error::File`] if there is none, or none that this version can read.
    pub fn plan(&self) -> Result<Plan> {
        if !self.has_plan() {
            return Err(self.error("there is no plan in it", "run 'remesh tiles plan' first"));
        }
        let text = read_bytes(&self.file("plan.json"))?;
        let unreadable =
            |e| self.error(format!("its plan cannot be read: {e}"), "make it again with 'remesh tiles plan'");
        serde_json::from_slice(&text).map_err(unreadable)
    }

    /// Writes what each tile needs besides the plan.
    pub(super) fn write_context(&self, head: &[u8], outline: &Points) -> Result<()> {
        replace_file(&self.file("head"), &mut |out| out.write_all(head))?;
        write_points_file(&self.file("outline.ply"), outline, &Attributes::default(), None)
    }

    /// Writes the plan, once everything else is there.
    pub(super) fn write_plan(&self, plan: &Plan) -> Result<()> {
        let text = serde_json::to_vec(plan).map_err(|e| self.error(e.to_string(), "give finite numbers"))?;
        replace_file(&self.file("plan.json"), &mut |out| out.write_all(&text))
    }

    /// Removes plan and samples, so that nothing seems complete while a new plan is made.
    pub(super) fn forget(&self) -> Result<()> {
        self.remove(&self.file("plan.json"))?;
        self.remove(&self.file("made-of"))?;
        self.forget_samples()
    }

    /// Records what the plan was made from.
    ///
    /// # Errors
    /// [`Error::File`] if that cannot be written.
    pub fn note(&self, input: &Path, options: &PlanOptions) -> Result<()> {
        let made_of = made_of(input, options);
        replace_file(&self.file("made-of"), &mut |out| out.write_all(made_of.as_bytes()))
    }

    /// Returns whether there is a plan that was made from this file, in its current state, with these options.
    pub fn is_of(&self, input: &Path, options: &PlanOptions) -> bool {
        let noted = fs::read_to_string(self.file("made-of")).unwrap_or_default();
        self.has_plan() && noted == made_of(input, options)
    }

    /// Removes all samples, what was made of them, and the leftovers of killed processes.
    fn forget_samples(&self) -> Result<()> {
        let entries = fs::read_dir(&self.path).map_err(|e| self.error(e.to_string(), "check its permissions"))?;
        let is_made = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            ["tile-", "piece-", UNFINISHED].iter().any(|kind| name.starts_with(kind))
        };
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_made).try_for_each(|path| self.remove(&path))
    }

    fn remove(&self, path: &Path) -> Result<()> {
        match fs::remove_file(path) {
            Err(e) if path.exists() => Err(self.error(e.to_string(), "check its permissions")),
            _ => Ok(()),
        }
    }

    /// Returns the table that describes the rows of points.
    pub(super) fn table(&self, plan: &Plan) -> Result<Table> {
        let head = read_bytes(&self.file("head"))?;
        let broken = || self.error("its file 'head' is damaged", "make the plan again");
        dense::table(plan.format, &head, plan.length).ok_or_else(broken)
    }

    /// Reads the rows of some chunks.
    pub(super) fn rows(&self, chunks: &[Chunk]) -> Result<Vec<u8>> {
        spill::read_chunks(&self.points(), chunks)
    }

    /// Reads the outline.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read.
    pub fn outline(&self) -> Result<Outline> {
        let loaded = read_file(&self.file("outline.ply"), None)?;
        Ok(Outline::new(Points::new(loaded.mesh.positions, loaded.attributes.normals())?))
    }

    /// Returns whether a tile is sampled.
    pub fn has_samples(&self, number: usize) -> bool {
        self.tile(number).is_file()
    }

    pub(super) fn write_samples(&self, number: usize, mut samples: Vec<TilePoint>) -> Result<()> {
        samples.sort_unstable_by_key(|sample| sample.number);
        write_rows(&self.tile(number), &samples)
    }

    /// Returns the number of samples of a tile.
    pub(super) fn count_samples(&self, number: usize) -> Result<usize> {
        self.check_sampled(number)?;
        self.count_rows(&self.tile(number))
    }

    fn check_sampled(&self, number: usize) -> Result<()> {
        if self.has_samples(number) {
            return Ok(());
        }
        Err(self.error(format!("tile {number} is not sampled yet"), "run 'remesh tiles sample' for it"))
    }

    pub(super) fn read_samples(&self, number: usize) -> Result<Vec<TilePoint>> {
        self.check_sampled(number)?;
        self.read_rows(&self.tile(number))
    }

    /// Reads the rows of a file of samples or nodes.
    fn read_rows(&self, path: &Path) -> Result<Vec<TilePoint>> {
        self.count_rows(path)?;
        Ok(read_bytes(path)?.chunks_exact(SAMPLE).map(sample_of).collect())
    }

    /// Returns the number of rows of a file of samples or nodes.
    fn count_rows(&self, path: &Path) -> Result<usize> {
        let length = fs::metadata(path).map_err(|e| self.error(e.to_string(), "check its permissions"))?.len();
        if length % SAMPLE as u64 == 0 { Ok(length as usize / SAMPLE) } else { Err(self.damaged(path)) }
    }

    fn damaged(&self, path: &Path) -> Error {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.error(format!("its file '{name}' is damaged"), "remove that file and make it again")
    }

    fn piece(&self, number: usize) -> PathBuf {
        self.file(&format!("piece-{number}"))
    }

    /// Returns whether that piece of the mesh is made.
    pub fn has_piece(&self, number: usize) -> bool {
        self.piece(number).is_file()
    }

    pub(super) fn write_piece(&self, number: usize, piece: &MadePiece) -> Result<()> {
        replace_file(&self.piece(number), &mut |out| out.write_all(&piece.to_bytes()))
    }

    pub(super) fn read_piece(&self, number: usize) -> Result<MadePiece> {
        self.check_made(number)?;
        let path = self.piece(number);
        MadePiece::from_bytes(&read_bytes(&path)?).ok_or_else(|| self.damaged(&path))
    }

    fn check_made(&self, number: usize) -> Result<()> {
        if self.has_piece(number) {
            return Ok(());
        }
        Err(self.error(format!("piece {number} of the mesh is not made yet"), "run 'remesh tiles mesh' for it"))
    }

    pub(super) fn write_nodes(&self, number: usize, nodes: &[TilePoint]) -> Result<()> {
        write_rows(&self.piece(number), nodes)
    }

    pub(super) fn read_nodes(&self, number: usize) -> Result<Vec<TilePoint>> {
        self.check_made(number)?;
        self.read_rows(&self.piece(number))
    }

    /// Returns the number of nodes of a piece.
    pub(super) fn count_nodes(&self, number: usize) -> Result<usize> {
        self.check_made(number)?;
        self.count_rows(&self.piece(number))
    }
}

fn write_rows(path: &Path, rows: &[TilePoint]) -> Result<()> {
    replace_file(path, &mut |out| {
        rows.iter().try_for_each(|TilePoint { number, position, normal }| {
            out.write_all(&number.to_le_bytes())?;
            [position, normal].iter().try_for_each(|v| out.write_all(v.to_array().map(f64::to_le_bytes).as_flattened()))
        })
    })
}

/// Returns what identifies the input and the options of a plan.
fn made_of(input: &Path, PlanOptions { sample, sharp_edges, .. }: &PlanOptions) -> String {
    let path = fs::canonicalize(input).unwrap_or_else(|_| input.into());
    let found = fs::metadata(input).ok().map(|found| (found.len(), found.modified().ok()));
    format!("{} {path:?} {found:?} {sample:?} {sharp_edges}\n", env!("CARGO_PKG_VERSION"))
}

fn sample_of(row: &[u8]) -> TilePoint {
    let float = |at: usize| f64::from_le_bytes(row[at..at + 8].try_into().expect("eight bytes"));
    let vector = |at: usize| DVec3::new(float(at), float(at + 8), float(at + 16));
    let number = u32::from_le_bytes(row[..4].try_into().expect("four bytes"));
    TilePoint { number, position: vector(4), normal: vector(28) }
}
