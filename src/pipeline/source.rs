//! What a run goes by: the input, what of it is remeshed and how it was mended, and what is asked of the result.

use crate::base::error::{Error, Result};
use crate::mesh::topology::{Topology, topology};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::kernel::{Beside, check_signals};
use crate::pipeline::options::{Options, check_field};
use crate::pipeline::scale::Field;
use crate::pipeline::unit::Unit;
use crate::pipeline::within::Within;
use crate::prepare::repair::{Repairs, repair};
use crate::prepare::stitch::{close_cracks, open_cracks};
use crate::surface::domain::Domain;
use glam::DVec3;

/// What a run goes by.
pub(super) struct Source<'a> {
    pub input: &'a Mesh,
    pub options: &'a Options,
    pub unit: Unit,
    /// The edge lengths that are wanted, if the options have some.
    pub field: Option<Field>,
    /// The part that is remeshed, if it is not all of the input.
    pub within: Option<Within>,
    /// How far the result may be from the input, in the units of that.
    pub allowed: Option<f64>,
    pub repairs: Repairs,
    pub open_cracks: usize,
    pub of_input: Topology,
    /// The topology after repairs.
    pub of_repaired: Topology,
    /// That of the part that is remeshed.
    pub of_sampled: Topology,
}

impl<'a> Source<'a> {
    /// What a run goes by, and what is sampled, in the pipeline's unit.
    ///
    /// # Errors
    /// Those of [`super::remesh`] that the input and its fields can have.
    pub(super) fn new(input: &'a Mesh, options: &'a Options) -> Result<(Source<'a>, Mesh)> {
        refuse_bad_numbers(input)?;
        options.sizing.as_deref().map_or(Ok(()), |lengths| check_field(input.positions.len(), lengths))?;
        check_signals(&options.signals, input.positions.len())?;
        let unit = Unit::of(input);
        let field = options.sizing.as_deref().map(|lengths| Field::new(lengths, input, &unit));
        let within = Within::new(input, options, field.as_ref(), &unit)?;
        let topology_of = |mesh: &Mesh| topology(mesh.positions.len(), &mesh.triangles);
        let (of_input, Repaired { mesh, repairs, open_cracks }) = rayon::join(
            || topology_of(input),
            || match &within {
                Some(within) => within.repaired(options, &unit),
                None => repaired(input, options, &unit),
            },
        );
        let untouched = options.weld.is_none() && repairs == Repairs::default();
        let whole = within.as_ref().map_or(&mesh, |within| &within.whole);
        let of_repaired = if untouched { of_input } else { topology_of(whole) };
        let of_sampled = if within.is_some() { topology_of(&mesh) } else { of_repaired };
        let diagonal = within.as_ref().map_or_else(|| unit.size * mesh.diagonal(), |within| within.whole.diagonal());
        let allowed = options.max_error.map(|e| e.length(diagonal));
        let source = Source {
            input,
            options,
            unit,
            field,
            within,
            allowed,
            repairs,
            open_cracks,
            of_input,
            of_repaired,
            of_sampled,
        };
        Ok((source, mesh))
    }

    /// What counts beside the position in the kernel over `domain`.
    pub(super) fn beside<'d>(&self, domain: &'d Domain) -> Beside<'d> {
        Beside::new(self.options.sigma_n, &self.options.signals, self.input, &self.unit, domain)
    }
}

/// What is sampled, in the pipeline's unit, and what it took to make it a manifold.
pub(super) struct Repaired {
    pub mesh: Mesh,
    pub repairs: Repairs,
    pub open_cracks: usize,
}

fn repaired(input: &Mesh, options: &Options, unit: &Unit) -> Repaired {
    let mut mesh = unit.inwards(input);
    if let Some(tolerance) = options.weld {
        mesh = close_cracks(&mesh, tolerance / unit.size);
    }
    let (mesh, repairs) = repair(&mesh);
    let open_cracks = if options.weld.is_none() { open_cracks(&mesh) } else { 0 };
    Repaired { mesh, repairs, open_cracks }
}

/// Largest coordinate that can be worked with: squares of differences must stay finite.
const LARGEST_COORDINATE: f64 = 1e150;

pub(super) fn refuse_bad_numbers(mesh: &Mesh) -> Result<()> {
    let mesh_error = |cause: String, remedy: &str| Err(Error::Mesh { cause, remedy: remedy.into() });
    if mesh.triangles.is_empty() {
        let n = mesh.positions.len();
        let remedy = "a surface with faces is needed; reconstruct one from the points first";
        return mesh_error(format!("{n} points and no faces"), remedy);
    }
    refuse_bad_positions(&mesh.positions)?;
    let bound = mesh.positions.len();
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= bound)) {
        return mesh_error(
            format!("triangle {t} has a corner that is not there: {:?} of {bound}", mesh.triangles[t]),
            "mend the indices",
        );
    }
    Ok(())
}

pub(super) fn refuse_bad_positions(positions: &[DVec3]) -> Result<()> {
    let bad = positions.iter().position(|p| !p.abs().cmplt(DVec3::splat(LARGEST_COORDINATE)).all());
    bad.map_or(Ok(()), |v| {
        let remedy = "remove it or mend its coordinates".into();
        Err(Error::Mesh { cause: format!("vertex {v} is at {}", positions[v]), remedy })
    })
}
