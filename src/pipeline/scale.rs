//! Number and spacing of vertices for a density or a field of lengths.

use crate::base::error::{Error, Fault, Result, Setting};
use crate::geom::packing::{count_on, spacing_of};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::density::{Density, FIRST_POINTS, check_count};
use crate::pipeline::unit::Unit;
use crate::surface::domain::Domain;
use crate::surface::sizing::{field_lengths, field_sizes, mean_density};

/// σp in units of the mean spacing d at which the scan with ε = 0.5 keeps a density of 2 / (√3 d²): measured on eleven
/// closed models at 5,000 to 20,000 points, where it met the count within 1 %.
pub(super) const SIGMA_OF_SPACING: f64 = 0.866;

/// Maximum number of curve samples per wanted point: the boundary of a narrow band has two, that of a heap of needles might
/// have thousands.
const MOST_ON_CURVES: f64 = 4.0;

/// Number of candidates per wanted point: with fewer, the scan leaves gaps; with more, it only takes longer.
pub(super) const CANDIDATES_PER_POINT: usize = 20;

/// Longest edge of the domain in mean spacings, to keep walks over it short.
pub(super) const LONGEST_EDGE: f64 = 2.0;

/// Longest edge on curves in mean spacings: the distance between curves is measured at the ends of edges.
pub(super) const LONGEST_ON_CURVES: f64 = 0.5;

/// Field of target edge lengths, in the pipeline's unit.
pub(super) struct Field {
    /// Length at each vertex of the input.
    of_input: Vec<f64>,
    /// Spacing of the number of vertices that the lengths require.
    spacing: f64,
}

impl Field {
    /// Makes a field of `lengths` at the vertices of `input`.
    pub(super) fn new(lengths: &[f64], input: &Mesh, unit: &Unit) -> Field {
        let of_input: Vec<f64> = lengths.iter().map(|length| length / unit.size).collect();
        let spacing = mean_density(input, &of_input).sqrt().recip();
        Field { of_input, spacing }
    }

    /// Shortest of its lengths after scaling to a mean of `spacing`.
    pub(super) fn shortest(&self, spacing: f64) -> f64 {
        spacing * self.of_input.iter().copied().fold(f64::INFINITY, f64::min) / self.spacing
    }

    /// Gives `domain` the sizes of the field, and returns the resulting scale at the given density.
    pub(super) fn grade(&self, domain: &mut Domain, density: Density, scale: Scale) -> Result<Scale> {
        let lengths = domain.values(&self.of_input);
        if density != Density::OfField {
            domain.grade(field_sizes(domain, lengths, scale.spacing));
            return Ok(scale);
        }
        let lengths = field_lengths(domain, lengths);
        let spacing = mean_density(&domain.mesh, &lengths).sqrt().recip();
        domain.grade(lengths.into_iter().map(|length| length / spacing).collect());
        let wanted = count(domain.mesh.area(), spacing);
        check_count(Setting::Field, wanted, format!("the lengths would give {wanted} vertices"))?;
        Ok(Scale { wanted, spacing })
    }
}

/// Number of vertices at distance `spacing` that cover `area`.
fn count(area: f64, spacing: f64) -> usize {
    count_on(area, spacing).round() as usize
}

/// Returns the mean spacing that a density implies on `area`, in the units of the input; `None` if lengths or an error bound
/// determine it.
pub fn spacing_on(area: f64, density: Density) -> Option<f64> {
    match density {
        Density::Points(n) => Some(Scale::of_points(n, area).spacing),
        Density::EdgeLength(length) => Some(length),
        Density::SigmaP(sigma) => Some(Scale::spacing_of_sigma(sigma)),
        Density::OfField | Density::Auto => None,
    }
}

/// Number and spacing of vertices that a density implies on a surface, in the pipeline's unit.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    pub wanted: usize,
    pub spacing: f64,
}

/// Refuses a mesh without area.
pub(super) fn refuse_no_area(clean: &Mesh, unit: &Unit) -> Result<()> {
    if clean.area() > unit.area_of_rounding(clean) {
        return Ok(());
    }
    let remedy = "a surface is needed; check that the coordinates do not all lie on a line".into();
    Err(Error::Mesh { fault: Fault::NoArea, cause: "the triangles have no area".into(), remedy })
}

/// Smallest permitted spacing, in the pipeline's unit: cells of the sampler are numbered in 32 bits.
pub(super) const SMALLEST_SPACING: f64 = 1e-8;

impl Scale {
    pub(super) fn new(density: Density, field: Option<&Field>, clean: &Mesh, unit: &Unit) -> Result<Scale> {
        refuse_no_area(clean, unit)?;
        let area = clean.area();
        let checked = |wanted: usize, spacing: f64| {
            if spacing >= SMALLEST_SPACING {
                return Ok(Scale { wanted, spacing });
            }
            let cause = format!("{wanted} vertices would be {:e} apart", spacing * unit.size);
            Err(Error::Mesh {
                fault: Fault::TooNarrow,
                cause,
                remedy: "ask for fewer vertices on so narrow a surface".into(),
            })
        };
        let from_length = |option, length: f64, spacing: f64| {
            let wanted = count(area, spacing);
            check_count(option, wanted, format!("a length of {length} would give {wanted} vertices"))?;
            checked(wanted, spacing)
        };
        let points = |n: usize| checked(n, Scale::of_points(n, area).spacing);
        match density {
            Density::Points(n) => points(n),
            Density::EdgeLength(l) => from_length(Setting::EdgeLength, l, l / unit.size),
            Density::OfField => {
                let spacing = field.map_or(f64::NAN, |field| field.spacing);
                from_length(Setting::Field, spacing * unit.size, spacing)
            }
            Density::SigmaP(s) => from_length(Setting::SigmaP, s, Scale::spacing_of_sigma(s / unit.size)),
            Density::Auto => points(FIRST_POINTS),
        }
    }

    /// Spacing along curves: wider if they are so long, relative to the area, that they would take many times the wanted
    /// number of vertices.
    pub(super) fn curve_spacing(&self, domain: &Domain) -> f64 {
        self.spacing.max(domain.curves.length() / (MOST_ON_CURVES * self.wanted as f64))
    }

    pub(super) fn sigma(&self) -> f64 {
        Scale::sigma_of_spacing(self.spacing)
    }

    /// Scale of `wanted` vertices on `area`.
    pub(super) fn of_points(wanted: usize, area: f64) -> Scale {
        Scale { wanted, spacing: spacing_of(wanted as f64, area) }
    }

    /// Number of samples that a kernel of width `sigma` leaves on `area`.
    pub(super) fn count_of_sigma(sigma: f64, area: f64) -> usize {
        count(area, Scale::spacing_of_sigma(sigma))
    }

    /// σp for samples at distance `spacing`.
    pub(super) fn sigma_of_spacing(spacing: f64) -> f64 {
        SIGMA_OF_SPACING * spacing
    }

    /// Distance of samples for σp.
    pub(super) fn spacing_of_sigma(sigma: f64) -> f64 {
        sigma / SIGMA_OF_SPACING
    }
}
