//! Makes the mesh of a plan's samples piece by piece.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Piece, TilePoint, optimize_piece, triangulate_samples};
use crate::spatial::kdtree::Neighbors;
use crate::spectral::lattice::{BlockBox, place_of};
use crate::tiles::folder::{Counts, TileFolder};
use crate::tiles::joined::Joined;
use crate::tiles::made::{MadePiece, new_key};
use crate::tiles::pieces::{Cube, MOVED, pieces, spare};
use crate::tiles::plan::Plan;
use crate::tiles::points::points_of;
use crate::tiles::watch::OfTile;
use glam::{DVec3, IVec3};

/// Blocks around a piece whose samples and points take part in it: what the border of these changes is nearer to it.
const HALO: i32 = 2;

/// How far from what is made anew points take part in it, in widths of the kernel.
const NEAR: f64 = 4.0;

/// Makes the piece of the mesh with this number, counted from 0, and writes it to the folder. Those of later rounds need those of
/// earlier ones around them.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if the folder lacks something or cannot be written, or there is no such piece;
/// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor asks for it.
pub fn mesh_one(folder: &TileFolder, number: usize, monitor: &dyn Monitor) -> Result<()> {
    let plan = folder.plan()?;
    let all = pieces(&plan);
    let Some(&cube) = all.get(number) else {
        let cause = format!("its mesh has {} pieces, numbered from 0; there is no piece {number}", all.len());
        return Err(folder.error(cause, "give a smaller number"));
    };
    let work = Work { folder, plan: &plan, number, cube, monitor };
    let made = if cube.round == 0 { work.of_samples()? } else { work.of_rims(&all)? };
    folder.write_piece(number, &made)
}

/// The making of a piece.
struct Work<'a> {
    folder: &'a TileFolder,
    plan: &'a Plan,
    number: usize,
    cube: Cube,
    monitor: &'a dyn Monitor,
}

impl Work<'_> {
    /// The blocks around the piece that it takes.
    fn around(&self) -> BlockBox {
        self.cube.blocks().grown(IVec3::splat(HALO))
    }

    /// The piece of what the samples make.
    fn of_samples(&self) -> Result<MadePiece> {
        let samples = self.samples()?;
        let triangles = triangulate_samples(&samples, &OfTile(self.monitor))?;
        let whole = Mesh { positions: samples.iter().map(|s| s.position).collect(), triangles };
        let selected = self.owned(&whole);
        let points = points_of(self.folder, self.plan, self.around(), self.monitor)?;
        let spare = self.spare()? - self.unused(&whole) as i64;
        let piece = self.optimized(&whole, &selected, spare, points)?;
        Ok(self.keyed(piece, |v| u64::from(samples[v as usize].number), Vec::new()))
    }

    /// The piece that takes the place of what is along the rims of the pieces that were made in the rounds before.
    fn of_rims(&self, all: &[Cube]) -> Result<MadePiece> {
        let around = self.around();
        let is_there = |cube: &Cube| cube.round < self.cube.round && cube.blocks().touches(around);
        let before = (0..).zip(all).filter(|(_, cube)| is_there(cube));
        let before: Vec<(usize, MadePiece)> =
            before.map(|(number, _)| Ok((number, self.folder.read_piece(number)?))).collect::<Result<_>>()?;
        let joined = Joined::new(&before);
        let anew = joined.to_be_made_anew().into_iter();
        let selected: Vec<bool> = anew.zip(self.owned(&joined.mesh)).map(|(anew, own)| anew && own).collect();
        let points = self.near(&joined.mesh, &selected)?;
        let piece = self.optimized(&joined.mesh, &selected, 0, points)?;
        let replaced = joined.sources.iter().zip(&selected).filter(|t| *t.1).map(|t| *t.0).collect();
        Ok(self.keyed(piece, |v| joined.keys[v as usize], replaced))
    }

    /// The samples in the piece and around it, in the order of their numbers.
    fn samples(&self) -> Result<Vec<TilePoint>> {
        let (around, block) = (self.around(), self.plan.sampling.block());
        let mut samples = Vec::new();
        for tile in 0..self.plan.tiles.len() {
            if self.plan.tile_box(tile).grown(IVec3::splat(MOVED)).touches(around) {
                samples.extend(self.folder.read_samples(tile)?);
            }
        }
        samples.retain(|sample| around.contains(place_of(sample.position, block)));
        samples.sort_unstable_by_key(|sample| sample.number);
        Ok(samples)
    }

    /// How many samples in the piece no triangle has: others take their place.
    fn unused(&self, whole: &Mesh) -> usize {
        let mut is_used = vec![false; whole.positions.len()];
        whole.triangles.as_flattened().iter().for_each(|&v| is_used[v as usize] = true);
        let (own, block) = (self.cube.blocks(), self.plan.sampling.block());
        let is_own = |p: DVec3| own.contains(place_of(p, block));
        whole.positions.iter().zip(is_used).filter(|&(&p, is_used)| !is_used && is_own(p)).count()
    }

    /// For each triangle whether it belongs to the piece.
    fn owned(&self, mesh: &Mesh) -> Vec<bool> {
        let block = self.plan.sampling.block();
        (0..mesh.triangles.len()).map(|t| self.cube.owns(mesh.corners(t), block)).collect()
    }

    /// The points near the `selected` triangles.
    fn near(&self, mesh: &Mesh, selected: &[bool]) -> Result<Vec<TilePoint>> {
        let corners = mesh.triangles.iter().zip(selected).filter(|t| *t.1).flat_map(|t| t.0);
        let mut corners: Vec<u32> = corners.copied().collect();
        corners.sort_unstable();
        corners.dedup();
        if corners.is_empty() {
            return Ok(Vec::new());
        }
        let corners: Vec<DVec3> = corners.into_iter().map(|v| mesh.positions[v as usize]).collect();
        let near = Neighbors::new(&corners);
        let mut points = points_of(self.folder, self.plan, self.around(), self.monitor)?;
        let mut found = Vec::new();
        points.retain(|point| {
            near.collect_nearest_within(point.position, 1, NEAR * self.plan.sampling.sigma, &mut found);
            !found.is_empty()
        });
        Ok(points)
    }

    /// How many samples the piece leaves out, so that the mesh has as many vertices as are wanted.
    fn spare(&self) -> Result<i64> {
        let Some(wanted) = self.plan.wanted else { return Ok(0) };
        let tiles = 0..self.plan.tiles.len();
        let counts: Vec<Counts> = tiles.map(|tile| self.folder.read_counts(tile)).collect::<Result<_>>()?;
        Ok(spare(self.cube, counts.into_iter(), wanted as u64))
    }

    /// What takes the place of the `selected` triangles, with `spare` vertices less.
    fn optimized(&self, whole: &Mesh, selected: &[bool], spare: i64, points: Vec<TilePoint>) -> Result<Piece> {
        check(self.monitor)?;
        if !selected.contains(&true) {
            return Ok(Piece::default());
        }
        let outline = self.folder.outline()?;
        optimize_piece(whole, selected, spare, points, &self.plan.sampling, &outline, &OfTile(self.monitor))
    }

    /// The piece whose vertices are known by those keys if they are of what it takes the place of.
    fn keyed(&self, piece: Piece, key: impl Fn(u32) -> u64, replaced: Vec<[u32; 2]>) -> MadePiece {
        let Piece { mesh: Mesh { positions, triangles }, source } = piece;
        let key = |(v, &source): (u32, &u32)| if source == NONE { new_key(self.number, v) } else { key(source) };
        MadePiece { keys: (0..).zip(&source).map(key).collect(), positions, triangles, replaced }
    }
}
