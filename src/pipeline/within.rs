//! Local resampling: a part of the input is remeshed and everything else stays as it is, to the last bit.
//!
//! The part is cut out, remeshed as a surface with a boundary whose vertices and edges along the interface are given, and sewn
//! in again. Edge lengths go over from those of the interface to the wanted ones.
//!
//! Based on: the future work in C. Öztireli, M. Alexa, M. Gross, Spectral sampling of manifolds, 2010,
//! DOI 10.1145/1882261.1866190.
//!
//! Limits: triangles at the interface are as good as its edges allow, and where an interface zigzags that is not very good.

use crate::base::error::{Error, Result};
use crate::geom::aabb::Aabb;
use crate::manifold::Manifold;
use crate::mesh::submesh::{Kept, Submesh, sew};
use crate::mesh::topology::{NONE, components};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::options::{Density, Options};
use crate::pipeline::scale::{Field, Scale};
use crate::pipeline::source::Repaired;
use crate::pipeline::unit::Unit;
use crate::prepare::repair::{Repairs, repair};
use crate::prepare::stitch::{close_cracks, open_cracks};
use crate::surface::domain::Domain;
use crate::surface::sizing::{lengths_from_interface, mean_density, vertices};
use glam::DVec3;
use std::collections::HashMap;

/// Which part of the input is remeshed: the triangles with all three corners in it.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// What is inside a box, its faces included: its lowest and its highest x, y and z, in the units of the input.
    Box([f64; 3], [f64; 3]),
    /// So much of the vertices of the input.
    Vertices(Vec<bool>),
}

impl Selection {
    /// Refuses what no input has a part in.
    pub(super) fn validate(&self) -> Result<()> {
        let Selection::Box(lowest, highest) = self else { return Ok(()) };
        let wrong = (0..3).find(|&k| !lowest[k].is_finite() || !highest[k].is_finite() || lowest[k] > highest[k]);
        wrong.map_or(Ok(()), |k| {
            let cause = format!("no {} is from {} to {}", ["x", "y", "z"][k], lowest[k], highest[k]);
            let remedy = "give the lowest x, y and z of a box, then the highest".into();
            Err(Error::Option { option: "within", cause, remedy })
        })
    }

    /// Refuses another number of vertices than the input has.
    fn check(&self, vertices: usize) -> Result<()> {
        match self {
            Selection::Vertices(selected) if selected.len() != vertices => Err(Error::Option {
                option: "select",
                cause: format!("{} marks for the {vertices} vertices of the input", selected.len()),
                remedy: "give each vertex one".into(),
            }),
            _ => Ok(()),
        }
    }

    /// For each triangle of `whole`, which is `input` but for repairs, whether it is in the part. Repairs number vertices
    /// anew, so those that are selected are known by their places.
    fn triangles(&self, whole: &Mesh, input: &Mesh) -> Vec<bool> {
        let inside: Vec<bool> = match self {
            Selection::Box(lowest, highest) => {
                let (lowest, highest) = (DVec3::from(*lowest), DVec3::from(*highest));
                whole.positions.iter().map(|p| p.cmpge(lowest).all() && p.cmple(highest).all()).collect()
            }
            Selection::Vertices(selected) => {
                let mut places = HashMap::new();
                for (&p, &is_selected) in input.positions.iter().zip(selected) {
                    *places.entry(place(p)).or_insert(false) |= is_selected;
                }
                whole.positions.iter().map(|&p| places.get(&place(p)).copied().unwrap_or(false)).collect()
            }
        };
        whole.triangles.iter().map(|t| t.iter().all(|&v| inside[v as usize])).collect()
    }

    /// That it has no triangle of `whole`.
    fn is_empty(&self, whole: &Mesh) -> Error {
        let Aabb { lo, hi } = whole.bounds().unwrap_or_default();
        let list = |p: DVec3| p.to_array().map(|x| x.to_string()).join(",");
        match self {
            Selection::Box(lowest, highest) => Error::Option {
                option: "within",
                cause: format!(
                    "no triangle is inside {},{}; those of the input are within {},{}",
                    list(DVec3::from(*lowest)),
                    list(DVec3::from(*highest)),
                    list(lo),
                    list(hi)
                ),
                remedy: "give a larger box, or another one".into(),
            },
            Selection::Vertices(selected) => Error::Option {
                option: "select",
                cause: format!(
                    "no triangle has all its corners selected; {} of {} vertices are",
                    selected.iter().filter(|s| **s).count(),
                    selected.len()
                ),
                remedy: "select more of them".into(),
            },
        }
    }
}

/// What makes vertices at exactly the same place the same: adding zero makes -0.0 and 0.0 the same bits.
fn place(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// The input, the part of it that is remeshed, and what it was mended by.
pub(super) struct Within {
    /// The input after repairs, in its own coordinates.
    pub whole: Mesh,
    repairs: Repairs,
    /// The part, in the coordinates of the input.
    pub part: Submesh,
    /// Whether each triangle of the whole is in the part.
    selected: Vec<bool>,
    /// Pieces of the selection that are too small.
    left: usize,
}

impl Within {
    /// The part of `input` that is asked for; `None` if that is all of it.
    pub(super) fn new(input: &Mesh, options: &Options, field: Option<&Field>, unit: &Unit) -> Result<Option<Within>> {
        let Some(selection) = &options.part else { return Ok(None) };
        selection.check(input.positions.len())?;
        let welded = options.weld.map(|tolerance| close_cracks(input, tolerance));
        let (whole, repairs) = repair(welded.as_ref().unwrap_or(input));
        let selected = selection.triangles(&whole, input);
        if selected.iter().all(|selected| *selected) {
            return Ok(None);
        }
        if !selected.contains(&true) {
            return Err(selection.is_empty(&whole));
        }
        let mut within = Within { part: Submesh::cut_out(&whole, &selected), whole, repairs, selected, left: 0 };
        let spacing = unit.size * Scale::new(options.density, field, &unit.inwards(&within.part.mesh), unit)?.spacing;
        within.leave_small_components(spacing);
        if within.part.mesh.triangles.is_empty() {
            let cause = format!("the part is smaller than a triangle of edges {spacing:.4e} long");
            return Err(Error::Option { option: "points", cause, remedy: "give more points, or a larger part".into() });
        }
        Ok(Some(within))
    }

    /// The part, in the pipeline's unit.
    pub(super) fn repaired(&self, options: &Options, unit: &Unit) -> Repaired {
        let open_cracks = if options.weld.is_none() { open_cracks(&self.whole) } else { 0 };
        Repaired { mesh: unit.inwards(&self.part.mesh), repairs: self.repairs, open_cracks }
    }

    /// Leaves components that have no room for a point as they are.
    fn leave_small_components(&mut self, spacing: f64) {
        let mesh = &self.part.mesh;
        let component = components(mesh.positions.len(), &mesh.triangles);
        let mut area = vec![0.0; mesh.positions.len()];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            area[component[corners[0] as usize] as usize] += 0.5 * mesh.area_vector(t).length();
        }
        let mut is_small = vec![false; mesh.positions.len()];
        for ends in &self.part.interface {
            let component = component[ends[0] as usize] as usize;
            is_small[component] = area[component] < 0.75f64.sqrt() * spacing * spacing;
        }
        self.left = is_small.iter().filter(|small| **small).count();
        if self.left == 0 {
            return;
        }
        let stays = mesh.triangles.iter().map(|corners| is_small[component[corners[0] as usize] as usize]);
        let of_part = self.selected.iter_mut().filter(|selected| **selected);
        of_part.zip(stays).filter(|(_, stays)| *stays).for_each(|(selected, _)| *selected = false);
        self.part = Submesh::cut_out(&self.whole, &self.selected);
    }

    /// Gives `domain`, that of the part, lengths that go over from those of the interface, and the scale that they have.
    /// Vertices on the interface are counted by half: the other half of the surface around them is not in the part.
    pub(super) fn grade(&self, domain: &mut Domain, density: Density, scale: &Scale) -> Scale {
        let on_interface = self.part.interface_vertices();
        let wanted: Vec<f64> =
            (0..domain.mesh.positions.len() as u32).map(|v| scale.spacing * domain.size_at(v)).collect();
        let count = matches!(density, Density::Points(_) | Density::Auto).then_some(scale.wanted);
        let lengths = lengths_from_interface(domain, &wanted, count.map(|n| n as f64 + 0.5 * on_interface as f64));
        let inside = count.unwrap_or_else(|| (vertices(domain, &lengths) - 0.5 * on_interface as f64).round() as usize);
        let spacing = mean_density(&domain.mesh, &lengths).sqrt().recip();
        domain.grade(lengths.into_iter().map(|length| length / spacing).collect());
        Scale { wanted: inside + on_interface, spacing }
    }

    /// The vertices that the whole is to have, with so many `wanted` of the part and its interface.
    pub(super) fn wanted(&self, wanted: usize) -> usize {
        let mut stays = vec![false; self.whole.positions.len()];
        let corners = self.whole.triangles.iter().zip(&self.selected).filter(|t| !*t.1).flat_map(|t| t.0);
        corners.for_each(|&v| stays[v as usize] = true);
        stays.iter().filter(|stays| **stays).count() + wanted - self.part.interface_vertices()
    }

    /// The whole with `mesh`, that of `made`, whose vertices lie on `domain`, in the place of the part; what is kept are
    /// vertices and triangles of `input`.
    pub(super) fn sew(&self, mesh: &Mesh, made: &Manifold, domain: &Domain, input: &Mesh) -> (Mesh, Option<Kept>) {
        let (_, old) = made.connectivity.compact();
        let joined = |&v: &u32| match corner_of_interface(made, domain, v) {
            NONE => NONE,
            corner => self.part.source[corner as usize],
        };
        let joined: Vec<u32> = old.iter().map(joined).collect();
        let (mesh, kept) = sew(&self.whole, &self.selected, mesh, &joined);
        let origin = Origin::new(input);
        let vertices = kept.vertices.iter().map(|&v| origin.vertex(self.whole.positions[v as usize])).collect();
        let triangles = kept.triangles.iter().map(|&t| origin.triangle(self.whole.corners(t as usize))).collect();
        (mesh, Some(Kept { vertices, triangles }))
    }

    /// What a user should know about it.
    pub(super) fn notes(&self, mesh: &Mesh, kept: &Kept) -> Vec<String> {
        let new = mesh.positions.len() - kept.vertices.len();
        let of_input = if self.repairs == Repairs::default() { "the input" } else { "the input, once repaired," };
        let mut notes = vec![format!(
            "{new} vertices are inside of the part that was remeshed; {} vertices and {} triangles of {of_input} are as \
             they were",
            kept.vertices.len(),
            kept.triangles.len()
        )];
        if self.left > 0 {
            notes.push(format!("{} components of the part stay as they are: no point fits into them", self.left));
        }
        notes
    }
}

/// The vertex of the part that vertex `v` of what was made of it is, if that is on the interface. A vertex there is a corner of
/// the triangle of the domain that it lies on.
fn corner_of_interface(made: &Manifold, domain: &Domain, v: u32) -> u32 {
    if !made.connectivity.is_on_interface(v) {
        return NONE;
    }
    let sample = &made.samples[v as usize];
    let corners = domain.mesh.triangles[sample.triangle as usize];
    let corner = corners.into_iter().find(|&w| domain.mesh.positions[w as usize] == sample.position);
    corner.map_or(NONE, |w| domain.original[w as usize])
}

/// Which vertex and which triangle of a mesh is at a place: the first of several.
struct Origin {
    vertices: HashMap<[u64; 3], u32>,
    triangles: HashMap<[[u64; 3]; 3], u32>,
}

impl Origin {
    fn new(mesh: &Mesh) -> Origin {
        let mut origin = Origin { vertices: HashMap::new(), triangles: HashMap::new() };
        for (&p, v) in mesh.positions.iter().zip(0..) {
            origin.vertices.entry(place(p)).or_insert(v);
        }
        for t in 0..mesh.triangles.len() {
            origin.triangles.entry(places(mesh.corners(t))).or_insert(t as u32);
        }
        origin
    }

    fn vertex(&self, at: DVec3) -> u32 {
        self.vertices.get(&place(at)).copied().unwrap_or(NONE)
    }

    fn triangle(&self, corners: [DVec3; 3]) -> u32 {
        self.triangles.get(&places(corners)).copied().unwrap_or(NONE)
    }
}

/// The places of the corners of a triangle, wherever they begin and whichever way they go.
fn places(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    let mut places = corners.map(place);
    places.sort_unstable();
    places
}
