//! Gives samples, and a mesh that was made in pieces, the attributes of the nearest points.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::io::spill::Chunk;
use crate::mesh::attributes::{Attribute, Attributes};
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::kdtree::Neighbors;
use crate::spectral::lattice::place_of;
use crate::tiles::folder::TileFolder;
use crate::tiles::pieces::Cube;
use crate::tiles::plan::Plan;
use crate::tiles::points::{CELLS, NUMBER, kept_in};
use crate::transfer::vertex::{Carried, carry_at_vertices};
use glam::{DVec3, IVec3};

/// Number of blocks around a cube that contain the points nearest to its vertices.
const HALO: i32 = 2;

/// Returns the attributes of `mesh`, that of all pieces: each vertex has those of the point nearest to it, but its own
/// normal.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if the points cannot be read; [`Error::Cancelled`](crate::Error::Cancelled) if the monitor
/// asks for it.
pub fn nearest_attributes(folder: &TileFolder, mesh: &Mesh, monitor: &dyn Monitor) -> Result<Carried> {
    monitor.stage("carry attributes");
    Ok(carry_at_vertices(attributes_near(folder, &folder.plan()?, &mesh.positions, monitor)?, mesh))
}

/// Returns the attributes of the point nearest to each of `positions`; if there are only normals, those of the first point.
///
/// # Errors
/// Those of [`nearest_attributes`].
pub(super) fn attributes_near(
    folder: &TileFolder,
    plan: &Plan,
    positions: &[DVec3],
    monitor: &dyn Monitor,
) -> Result<Attributes> {
    let table = folder.table(plan)?;
    let read = |rows: &[u8]| table.rows.read(rows).map_err(|error| error.in_file(&plan.input));
    let first = Chunk { length: (NUMBER + table.row) as u32, ..plan.chunks[0] };
    let of_first = read(&folder.rows(&[first])?[NUMBER..])?.attributes;
    // Normals are not carried over: a mesh has its own.
    if of_first.vertex.iter().all(Attribute::is_normal) {
        return Ok(of_first);
    }
    Ok(read(&nearest_rows(folder, plan, positions, table.row, monitor)?)?.attributes)
}

/// Returns the row, of `size` bytes, of the point nearest to each of `positions`.
fn nearest_rows(
    folder: &TileFolder,
    plan: &Plan,
    positions: &[DVec3],
    size: usize,
    monitor: &dyn Monitor,
) -> Result<Vec<u8>> {
    let cube = |v: &usize| Cube::first_around(place_of(positions[*v], plan.sampling.block()));
    let mut vertices: Vec<usize> = (0..positions.len()).collect();
    vertices.sort_by_cached_key(|v| cube(v).blocks().lo.to_array());
    let mut rows = vec![0; size * positions.len()];
    for vertices in vertices.chunk_by(|v, w| cube(v) == cube(w)) {
        check(monitor)?;
        let around = cube(&vertices[0]).blocks().grown(IVec3::splat(HALO));
        let points =
            kept_in(folder, plan, around, CELLS, monitor, |point, row| (point.position, Box::<[u8]>::from(row)))?;
        let near = Neighbors::new(&points.iter().map(|point| point.0).collect::<Vec<_>>());
        let nearest = parallel::map(vertices, |&v| near.nearest(positions[v]));
        for (v, nearest) in vertices.iter().zip(nearest) {
            if let Some(nearest) = nearest {
                rows[v * size..][..size].copy_from_slice(&points[nearest.point as usize].1);
            }
        }
    }
    Ok(rows)
}
