//! Prepared input of a run: the input, repaired in the same way for every attempt, and the requirements on the result.

use crate::base::error::{Error, Fault, Result};
use crate::base::monitor::{Monitor, check};
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::topology::{Topology, components, topology, topology_of_manifold};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::input_checks::refuse_bad_numbers;
use crate::pipeline::options::Options;
use crate::pipeline::result::lost::Components;
use crate::pipeline::scale::Field;
use crate::pipeline::unit::Unit;
use crate::prepare::bend::smooth;
use crate::prepare::needles::without_needles;
use crate::prepare::repair::{Repaired, repair_welded};
use crate::prepare::repairs::Repairs;
use crate::prepare::stitch::{Cracks, Stitched, close_cracks, stitch};
use crate::surface::features::Features;

/// Data that all runs share, whatever the number of vertices.
pub(super) struct PreparedInput<'a> {
    pub input: &'a Mesh,
    pub options: &'a Options,
    pub unit: Unit,
    /// Target edge lengths, if the options have some.
    pub field: Option<Field>,
    /// Maximum distance of the result from the input, in the units of the input.
    pub allowed: Option<f64>,
    pub repairs: Repairs,
    /// Possible cracks in the repaired input, in the units of the input.
    pub cracks: Option<Cracks>,
    /// Topology of the input.
    pub of_input: Topology,
    /// Topology after repairs.
    pub of_repaired: Topology,
    /// Components after repairs.
    pub components: Components,
    /// Finer surface from which the sampled one was made, if that was coarsened.
    pub fine: Option<Fine>,
}

/// Surface that is finer than the sampled one.
pub(super) struct Fine {
    /// Input, repaired and smoothed.
    pub mesh: OrientedManifold,
    /// Its sharp edges, as far as the coarser surface has them.
    pub features: Features,
}

impl<'a> PreparedInput<'a> {
    /// Prepares the input, and returns it repaired and smoothed: in the pipeline's unit, or in that of the input if only a
    /// part of it is remeshed, so that the rest stays unchanged to the last bit.
    ///
    /// # Errors
    /// Those of [`super::remesh`] that the input and its fields can cause.
    pub(super) fn new(
        input: &'a Mesh,
        options: &'a Options,
        monitor: &dyn Monitor,
    ) -> Result<(PreparedInput<'a>, OrientedManifold)> {
        monitor.stage("repair");
        refuse_bad_numbers(input)?;
        options.grading.check(input.positions.len())?;
        options.part.as_ref().map_or(Ok(()), |part| part.check(input.positions.len()))?;
        let unit = Unit::of(input);
        let field = options.grading.field().map(|lengths| Field::new(lengths, input, &unit));
        let (Repaired { mesh: mut repaired, repairs, twins }, cracks) = repaired(input, options, &unit);
        check(monitor)?;
        refuse_no_surface(&repairs, repaired.triangles.len())?;
        let component = components(repaired.positions.len(), &repaired.triangles);
        let of_repaired = topology_of_manifold(&repaired.triangles, &component, &twins);
        drop(twins);
        let untouched = repairs == Repairs::default();
        let of_input = if untouched { of_repaired } else { topology(input.positions.len(), &input.triangles) };
        let components = Components::new(input, &repaired, &component);
        let scale = if options.part.is_some() { 1.0 } else { unit.size };
        let cracks = cracks.map(|cracks| Cracks { width: scale * cracks.width, ..cracks });
        let allowed = options.max_error.map(|e| e.length(scale * repaired.diagonal()));
        if let Some(support) = options.smoothing() {
            monitor.stage("smooth");
            smooth(&mut repaired, support);
            check(monitor)?;
        }
        let fine = None;
        let prepared = PreparedInput {
            input,
            options,
            unit,
            field,
            allowed,
            repairs,
            cracks,
            of_input,
            of_repaired,
            components,
            fine,
        };
        Ok((prepared, repaired))
    }

    /// Sharp edges of the sampled surface that are kept.
    pub(super) fn features(&self) -> &Features {
        self.fine.as_ref().map_or(&self.options.features, |fine| &fine.features)
    }

    /// Maximum distance of the result from the repaired input, in the pipeline's unit, if it is bounded.
    pub(super) fn limit(&self) -> Option<f64> {
        self.allowed.map(|allowed| allowed / self.unit.size)
    }

    /// Repairs and smooths the input again as [`PreparedInput::new`] does.
    pub(super) fn repaired_again(&self) -> OrientedManifold {
        let (Repaired { mesh: mut repaired, .. }, _) = repaired(self.input, self.options, &self.unit);
        if let Some(support) = self.options.smoothing() {
            smooth(&mut repaired, support);
        }
        repaired
    }
}

/// Makes the input a manifold, in the unit that [`PreparedInput::new`] specifies. Also returns the repairs and possible
/// cracks.
fn repaired(input: &Mesh, options: &Options, unit: &Unit) -> (Repaired, Option<Cracks>) {
    match options.part {
        Some(_) => made_manifold(input.clone(), options.weld),
        None => {
            let (repaired, cracks) = made_manifold(unit.inwards(input), options.weld.map(|weld| weld / unit.size));
            (without_needles(repaired), cracks)
        }
    }
}

/// Makes the mesh a manifold. Also returns the repairs and possible cracks. Without a weld distance, only seams that
/// rounding opened are closed.
fn made_manifold(mesh: Mesh, weld: Option<f64>) -> (Repaired, Option<Cracks>) {
    let Stitched { welded, cracks } = match weld {
        Some(tolerance) => Stitched { welded: close_cracks(&mesh, tolerance), cracks: None },
        None => stitch(&mesh),
    };
    drop(mesh.triangles);
    (repair_welded(mesh.positions, welded), cracks)
}

/// Number of edges with more than two faces, in total and per face, above which a mesh is not a surface. Where sheets meet
/// there are at most a twentieth per face; the cells of a volume, or all triangles between near points, have half an edge
/// per face. Such a mesh would fall apart into as many patches as it has faces.
const MANY_CUT_EDGES: usize = 1000;
const MOST_CUT_EDGES: f64 = 0.25;

fn refuse_no_surface(repairs: &Repairs, faces: usize) -> Result<()> {
    let cut = repairs.cut_edges;
    if cut < MANY_CUT_EDGES || (cut as f64) < MOST_CUT_EDGES * faces as f64 {
        return Ok(());
    }
    let share = 100.0 * cut as f64 / faces as f64;
    let cause = format!(
        "{cut} edges have three or more faces, {share:.0} for every hundred of the {faces} faces, but a surface whose sheets meet has at most five: these are all faces of a volume's cells, or triangles between all nearby points, not a surface"
    );
    let remedy = "export only its outer surface, or give only its points, as a cloud".into();
    Err(Error::Mesh { fault: Fault::NoSurface, cause, remedy })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn what_is_repaired_again_is_the_same() {
        // Every triangle separate, and one of them twice.
        let sphere = testing::sphere();
        let input = Mesh::soup((0..sphere.triangles.len()).chain([0]).map(|t| sphere.corners(t)));
        let options = Options { smooth: Some(2.3), ..Options::default() };
        let (prepared, first) = PreparedInput::new(&input, &options, &()).unwrap();
        assert_eq!(first.positions.len(), sphere.positions.len());
        assert!(prepared.repaired_again() == first);
    }
}
