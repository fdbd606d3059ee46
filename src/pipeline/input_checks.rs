//! Checks of the numbers of an input.

use crate::base::error::{Error, Fault, Result};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Largest permitted coordinate: squares of differences must stay finite.
const LARGEST_COORDINATE: f64 = 1e150;

/// Refuses a mesh without faces, coordinates that are not finite or too large, and corners that do not exist.
///
/// # Errors
/// [`Error::Mesh`] for the first of these.
pub fn refuse_bad_numbers(mesh: &Mesh) -> Result<()> {
    let refuse = |fault, cause: String, remedy: &str| Err(Error::Mesh { fault, cause, remedy: remedy.into() });
    if mesh.triangles.is_empty() {
        let n = mesh.positions.len();
        let remedy = "a surface with faces is needed; reconstruct one from the points first";
        return refuse(Fault::Empty, format!("{n} points and no faces"), remedy);
    }
    refuse_bad_positions(&mesh.positions)?;
    let bound = mesh.positions.len();
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= bound)) {
        return refuse(
            Fault::Indices,
            format!(
                "triangle {t} has a corner that does not exist: {:?}, where there are {bound} vertices",
                mesh.triangles[t]
            ),
            "correct the indices",
        );
    }
    Ok(())
}

/// Refuses coordinates that are not finite or too large.
///
/// # Errors
/// [`Error::Mesh`] for the first of these.
pub fn refuse_bad_positions(positions: &[DVec3]) -> Result<()> {
    let bad = positions.iter().position(|p| !p.abs().cmplt(DVec3::splat(LARGEST_COORDINATE)).all());
    bad.map_or(Ok(()), |v| {
        let remedy = "remove it or correct its coordinates".into();
        Err(Error::Mesh {
            fault: Fault::Coordinates,
            cause: format!("vertex {v} is at {}, which is too large or not finite", positions[v]),
            remedy,
        })
    })
}
