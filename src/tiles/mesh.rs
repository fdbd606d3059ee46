//! Makes the mesh of a plan piece by piece.

use crate::base::error::{Error, Result};
use crate::base::monitor::{Monitor, check};
use crate::geom::aabb::Aabb;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{
    MadeAnew, PartOfMesh, TilePoint, base_mesh, nodes, optimize_piece, place_nodes, triangulate_nodes,
};
use crate::spatial::kdtree::Neighbors;
use crate::spectral::lattice::{BlockBox, place_of};
use crate::tiles::folder::TileFolder;
use crate::tiles::joined::Joined;
use crate::tiles::made::{MadePiece, new_key};
use crate::tiles::pieces::{Cube, MOVED, Piece, pieces, rounds, spare};
use crate::tiles::plan::Plan;
use crate::tiles::points::{CELLS, FINE_CELLS, points_of};
use crate::tiles::watch::{OfTile, one_by_one};
use glam::{DVec3, IVec3};

/// Number of blocks around a cube whose samples, nodes and points take part in it: the effects of the border of this region
/// do not reach the cube.
const HALO: i32 = 2;

/// Maximum distance, in kernel widths, from the triangles made anew to the points that take part in them.
const NEAR: f64 = 4.0;

/// Makes the piece of the mesh with this number, counted from 0, and writes it to the folder. Pieces of later rounds need
/// those of earlier rounds around them.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if the folder lacks something or cannot be written, or there is no such piece;
/// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor asks for it.
pub fn mesh_one(folder: &TileFolder, number: usize, monitor: &dyn Monitor) -> Result<()> {
    let plan = folder.plan()?;
    let all = pieces(&plan);
    let Some(&piece) = all.get(number) else {
        let cause = format!("its mesh has {} pieces, numbered from 0; there is no piece {number}", all.len());
        return Err(folder.error(cause, "give a smaller number"));
    };
    if plan.is_thick {
        let cause = "the noise of its points is larger than their distance, which pieces of a mesh do not smooth away";
        return Err(folder.error(cause, "remesh the cloud as a whole, or plan it with fewer points or with smoothing"));
    }
    let work = Work { folder, plan: &plan, all: &all, number, monitor };
    match piece {
        Piece::Base => folder.write_piece(number, &work.base()?),
        Piece::Nodes(cube) => folder.write_nodes(number, &work.nodes(cube)?),
        Piece::Triangles(cube) if cube.round == 0 => folder.write_piece(number, &work.of_nodes(cube)?),
        Piece::Triangles(cube) => folder.write_piece(number, &work.of_rims(cube)?),
    }
}

/// Makes the pieces with these numbers, one after the other; without numbers, all that are not made yet.
///
/// # Errors
/// Those of [`mesh_one`].
pub fn mesh_pieces(folder: &TileFolder, numbers: Option<&[usize]>, monitor: &dyn Monitor) -> Result<()> {
    monitor.stage("mesh pieces");
    let all = rounds(&folder.plan()?).into_iter().flatten();
    let missing: Vec<usize> = all.filter(|&number| !folder.has_piece(number)).collect();
    one_by_one(numbers.unwrap_or(&missing), |number| mesh_one(folder, number, monitor), monitor)
}

/// What is needed to make a piece.
struct Work<'a> {
    folder: &'a TileFolder,
    plan: &'a Plan,
    /// All pieces.
    all: &'a [Piece],
    /// The number of this one.
    number: usize,
    monitor: &'a dyn Monitor,
}

impl Work<'_> {
    /// Returns the number of vertices that the mesh is to have.
    fn wanted(&self) -> Result<usize> {
        let samples = || (0..self.plan.tiles.len()).map(|tile| self.folder.count_samples(tile)).sum();
        self.plan.wanted.map_or_else(samples, Ok)
    }

    /// Makes the base mesh; it is empty if no surface passes through the outline.
    fn base(&self) -> Result<MadePiece> {
        let monitor = OfTile(self.monitor);
        let made = base_mesh(&self.folder.outline()?, self.wanted()?, self.plan.sampling.seed, &monitor);
        let Mesh { positions, triangles } = match made {
            Err(Error::Mesh { .. }) => Mesh::default(),
            made => made?,
        };
        let keys = (0..positions.len() as u32).map(|v| new_key(self.number, v)).collect();
        Ok(MadePiece { keys, positions, triangles, replaced: Vec::new() })
    }

    /// Makes the nodes in a cube.
    fn nodes(&self, cube: Cube) -> Result<Vec<TilePoint>> {
        let (around, block) = (around(cube), self.plan.sampling.block());
        let MadePiece { positions, triangles, .. } = self.folder.read_piece(0)?;
        let is_near = |corners: [DVec3; 3]| {
            let Aabb { lo, hi } = Aabb::of_triangle(corners);
            BlockBox { lo: place_of(lo, block), hi: place_of(hi, block) + 1 }.touches(around)
        };
        let nodes = nodes(&Mesh { positions, triangles }, self.wanted()?, is_near);
        let points = points_of(self.folder, self.plan, around, CELLS, self.monitor)?;
        let outline = self.folder.outline()?;
        let mut placed = place_nodes(&nodes, points, &self.samples(around)?, &self.plan.sampling, &outline);
        placed.retain(|node| cube.blocks().contains(place_of(node.position, block)));
        Ok(placed)
    }

    /// Makes the triangles of a cube between its nodes.
    fn of_nodes(&self, cube: Cube) -> Result<MadePiece> {
        let (keys, nodes) = self.nodes_around(cube)?;
        let triangles = triangulate_nodes(&nodes, &OfTile(self.monitor))?;
        let whole = Mesh { positions: nodes.iter().map(|s| s.position).collect(), triangles };
        let selected = self.owned(&whole, cube);
        let points = self.surface_points(cube)?;
        let part = PartOfMesh {
            whole: &whole,
            selected: &selected,
            disordered: nodes.iter().map(|node| node.number != NONE).collect(),
            spare: self.spare(cube)? - self.unused(&whole, cube) as i64,
        };
        let piece = self.optimized(&part, points)?;
        Ok(self.keyed(piece, &keys, Vec::new()))
    }

    /// Makes the triangles that replace those along the rims of the pieces of earlier rounds.
    fn of_rims(&self, cube: Cube) -> Result<MadePiece> {
        let around = around(cube);
        let is_there = |piece: &Piece| match piece {
            Piece::Triangles(other) => other.round < cube.round && other.blocks().touches(around),
            _ => false,
        };
        let before = (0..).zip(self.all).filter(|(_, piece)| is_there(piece));
        let before: Vec<(usize, MadePiece)> =
            before.map(|(number, _)| Ok((number, self.folder.read_piece(number)?))).collect::<Result<_>>()?;
        let joined = Joined::new(&before);
        let first = self.all.iter().position(|piece| matches!(piece, Piece::Triangles(_)));
        let anew = joined.to_be_made_anew(first.unwrap_or(0)).into_iter();
        let selected: Vec<bool> = anew.zip(self.owned(&joined.mesh, cube)).map(|(anew, own)| anew && own).collect();
        let points = self.near(cube, &joined.mesh, &selected)?;
        let disordered = joined.at_small_angles();
        let part = PartOfMesh { whole: &joined.mesh, selected: &selected, disordered, spare: 0 };
        let piece = self.optimized(&part, points)?;
        let replaced = joined.sources.iter().zip(&selected).filter(|t| *t.1).map(|t| *t.0).collect();
        Ok(self.keyed(piece, &joined.keys, replaced))
    }

    /// Returns the samples in some blocks, in the order of their numbers.
    fn samples(&self, blocks: BlockBox) -> Result<Vec<TilePoint>> {
        let mut samples = Vec::new();
        for tile in 0..self.plan.tiles.len() {
            if self.plan.tile_box(tile).grown(IVec3::splat(MOVED)).touches(blocks) {
                samples.extend(self.folder.read_samples(tile)?);
            }
        }
        samples.retain(|sample| blocks.contains(place_of(sample.position, self.plan.sampling.block())));
        samples.sort_unstable_by_key(|sample| sample.number);
        Ok(samples)
    }

    /// Returns the keys and the nodes in and around a cube.
    fn nodes_around(&self, cube: Cube) -> Result<(Vec<u64>, Vec<TilePoint>)> {
        let (around, block) = (around(cube), self.plan.sampling.block());
        let mut all = Vec::new();
        for (number, piece) in self.all.iter().enumerate() {
            if matches!(piece, Piece::Nodes(other) if other.blocks().touches(around)) {
                let nodes = (0..).zip(self.folder.read_nodes(number)?);
                all.extend(nodes.map(|(v, node)| (new_key(number, v), node)));
            }
        }
        Ok(all.into_iter().filter(|(_, node)| around.contains(place_of(node.position, block))).unzip())
    }

    /// Returns the number of nodes in a cube that no triangle uses: other vertices take their place.
    fn unused(&self, whole: &Mesh, cube: Cube) -> usize {
        let is_own = |p: DVec3| cube.blocks().contains(place_of(p, self.plan.sampling.block()));
        whole.positions.iter().zip(whole.used_vertices()).filter(|&(&p, is_used)| !is_used && is_own(p)).count()
    }

    /// Returns, for each triangle, whether it belongs to a cube.
    fn owned(&self, mesh: &Mesh, cube: Cube) -> Vec<bool> {
        let block = self.plan.sampling.block();
        (0..mesh.triangles.len()).map(|t| cube.owns(mesh.corners(t), block)).collect()
    }

    /// Returns the points in and around a cube through which the surface passes.
    fn surface_points(&self, cube: Cube) -> Result<Vec<TilePoint>> {
        let cells = if self.plan.sampling.is_sharp { FINE_CELLS } else { CELLS };
        points_of(self.folder, self.plan, around(cube), cells, self.monitor)
    }

    /// Returns the points near the `selected` triangles of a cube.
    fn near(&self, cube: Cube, mesh: &Mesh, selected: &[bool]) -> Result<Vec<TilePoint>> {
        let corners = mesh.triangles.iter().zip(selected).filter(|t| *t.1).flat_map(|t| t.0);
        let mut corners: Vec<u32> = corners.copied().collect();
        corners.sort_unstable();
        corners.dedup();
        if corners.is_empty() {
            return Ok(Vec::new());
        }
        let corners: Vec<DVec3> = corners.into_iter().map(|v| mesh.positions[v as usize]).collect();
        let near = Neighbors::new(&corners);
        let mut points = self.surface_points(cube)?;
        points.retain(|point| near.has_within(point.position, NEAR * self.plan.sampling.sigma));
        Ok(points)
    }

    /// Returns how many vertices the triangles of a cube leave out, so that the mesh has the wanted number.
    fn spare(&self, cube: Cube) -> Result<i64> {
        let Some(wanted) = self.plan.wanted else { return Ok(0) };
        let nodes = self.all.iter().enumerate().filter(|(_, piece)| matches!(piece, Piece::Nodes(_)));
        let counts: Vec<u64> =
            nodes.map(|(number, _)| Ok(self.folder.count_nodes(number)? as u64)).collect::<Result<_>>()?;
        let own = self.all.iter().skip(1).position(|piece| *piece == Piece::Nodes(cube));
        Ok(own.map_or(0, |own| spare(own, &counts, wanted as u64)))
    }

    /// Optimises a part of a mesh, and returns what replaces it.
    fn optimized(&self, part: &PartOfMesh, points: Vec<TilePoint>) -> Result<MadeAnew> {
        check(self.monitor)?;
        if !part.selected.contains(&true) {
            return Ok(MadeAnew::default());
        }
        let outline = self.folder.outline()?;
        optimize_piece(part, points, &self.plan.sampling, &outline, &OfTile(self.monitor))
    }

    /// Makes a piece of `made`: vertices of the replaced mesh keep their `keys`, all others get new ones.
    fn keyed(&self, made: MadeAnew, keys: &[u64], replaced: Vec<[u32; 2]>) -> MadePiece {
        let MadeAnew { mesh: Mesh { positions, triangles }, source } = made;
        let key =
            |(v, &source): (u32, &u32)| if source == NONE { new_key(self.number, v) } else { keys[source as usize] };
        MadePiece { keys: (0..).zip(&source).map(key).collect(), positions, triangles, replaced }
    }
}

/// Returns the blocks in and around a cube that take part in it.
fn around(cube: Cube) -> BlockBox {
    cube.blocks().grown(IVec3::splat(HALO))
}
