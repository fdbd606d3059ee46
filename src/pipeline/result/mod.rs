//! Result of the pipeline: the mesh, whether it meets the requirements, and what a user should know about it.

pub(in crate::pipeline) mod edges;
pub(in crate::pipeline) mod lost;
pub(in crate::pipeline) mod origins;
pub(in crate::pipeline) mod shortcomings;

use crate::base::count::{counted, counts};
use crate::manifold::small_angles::SLIVER;
use crate::mesh::provenance::Origins;
use crate::mesh::submesh::Kept;
use crate::mesh::topology::Topology;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::coverage::Coverage;
use crate::pipeline::result::edges::Edges;
use crate::pipeline::result::lost::LostComponents;
use crate::pipeline::sized::pinholes::Pinholes;
use crate::prepare::repairs::Repairs;
use crate::prepare::stitch::Cracks;
use crate::surface::narrow_patches::LeftOut;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Remeshed surface and information about it.
#[derive(Debug, Clone)]
pub struct Remeshed {
    /// The resulting mesh, in the coordinates of the input.
    pub mesh: Mesh,
    /// Origins of its vertices and triangles on the input.
    pub origins: Origins,
    /// Topology of the input, before repairs.
    pub input: Topology,
    /// Topology of the input after repairs, without components of negligible area: the reference for the topology of the
    /// result.
    pub repaired: Topology,
    /// Topology of the result.
    pub output: Topology,
    /// Repairs of the input.
    pub repairs: Repairs,
    /// Kernel width used, in the units of the input.
    pub sigma_p: f64,
    /// Distance of neighbours if the wanted vertices were packed hexagonally on the input's area, in the units of the input.
    pub spacing: f64,
    /// Smallest and largest target distance; both equal the spacing if nothing is graded.
    pub spacing_range: [f64; 2],
    /// Number of vertices that the density implies.
    pub wanted: usize,
    /// Number of sharp edges that were kept, counted as curves between corners.
    pub sharp_curves: usize,
    /// Number of smooth patches that were tessellated from the input as a whole, because their samples remained inconsistent even
    /// with parts of them tessellated.
    pub tessellated_patches: usize,
    /// Faces of the result that intersect or touch another one away from shared corners and edges, in increasing order.
    pub self_intersections: Vec<u32>,
    /// Those of them without self-intersecting faces of the repaired input within their own length, in increasing order.
    pub new_self_intersections: Vec<u32>,
    /// Number of self-intersecting faces of the repaired input; `None` if the result has none, since then it is not needed.
    pub self_intersections_of_input: Option<usize>,
    /// New triangles with an angle below 1 degree that the input does not force, in increasing order.
    pub slivers: Vec<u32>,
    /// Triangles where the input has no surface, in increasing order.
    pub bridges: Vec<u32>,
    /// Smallest angle of the new triangles, in degrees, without those that the input forces where sharp edges and boundaries
    /// meet or a spike ends; `None` if all are forced.
    pub unforced_theta_min: Option<f64>,
    /// Sharp edges that were left out, in the units of the input.
    pub left_out: LeftOut,
    /// Number of curves along sharp edges that were smoothed over because the patches beside them did not fit together.
    pub smoothed_curves: usize,
    /// Holes that were closed because they were too small for the edges, in the units of the input.
    pub pinholes: Pinholes,
    /// Whether no sharp edge was kept because there were too many.
    pub blunted: bool,
    /// Whether the input is rough at the scale of the result's much longer edges, as a noisy scan is.
    pub is_rough: bool,
    /// Components of the input that are nearly absent from the result; `None` if there are none.
    pub lost: Option<LostComponents>,
    /// Distance of the result from the repaired input; `None` if no bound was requested.
    pub deviation: Option<Deviation>,
    /// Sharp edges of the result, those that were left out, and the target lengths.
    pub edges: Edges,
    /// Parts of the input that came through untouched, if only a part of it was remeshed: its vertices and triangles are the
    /// first ones of the result.
    pub kept: Option<Kept>,
    /// Notes for the user, one sentence each.
    pub notes: Vec<String>,
}

/// Distance of a result from its input, and its allowed maximum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Maximum allowed distance, in the units of the input.
    pub allowed: f64,
    /// Upper bound of the distance of any point of the result from the repaired input, and of any point of that or of a
    /// cloud from the result, up to rounding. It is usually within a tenth of the Hausdorff distance or a quarter of
    /// `allowed`. In the units of the input.
    pub reached: f64,
    /// Point at about this distance: x, y and z.
    pub place: [f64; 3],
}

impl Deviation {
    /// Returns whether the result is as close as required.
    pub fn is_allowed(&self) -> bool {
        self.reached <= self.allowed
    }
}

impl Remeshed {
    /// Includes the points of the cloud in a requested deviation: the input, which was laid through them, may have left some
    /// out.
    pub fn hold_against_points(&mut self, coverage: &Coverage) {
        let Some(before) = self.deviation.filter(|d| d.reached < coverage.largest) else { return };
        let deviation = Deviation { reached: coverage.largest, place: coverage.place, ..before };
        self.deviation = Some(deviation);
        if !deviation.is_allowed() {
            self.notes.retain(|note| *note != note_on_deviation(&before));
            self.notes.push(note_on_deviation(&deviation));
        }
    }

    /// Returns whether the result has the topology of the repaired input and no faces that intersect each other where those
    /// of the input do not.
    pub fn is_sound(&self) -> bool {
        self.has_topology() && self.new_self_intersections.is_empty()
    }

    /// Returns whether the result is an oriented manifold with the repaired input's Euler characteristic, number of
    /// components and number of boundary loops.
    pub fn has_topology(&self) -> bool {
        has_kind(&self.output, &self.repaired)
    }
}

/// Returns whether a topology is that of an oriented manifold with the wanted Euler characteristic, components and boundary
/// loops.
pub(in crate::pipeline) fn has_kind(found: &Topology, wanted: &Topology) -> bool {
    let kind = |t: &Topology| (t.euler, t.components, t.boundary_loops);
    found.is_manifold() && found.is_oriented() && kind(found) == kind(wanted)
}

/// Notes how many holes were closed, and where the largest is.
fn note_on_pinholes(Pinholes { count, place }: &Pinholes) -> String {
    let holes = counted(*count, "hole is", "holes are");
    let place = near(*place);
    format!(
        "{holes} too small for edges of this length and therefore closed, the largest {place}; more points keep more of them"
    )
}

/// Notes which sharp edges were left out.
fn note_on_left_out(LeftOut { patches, deviation }: &LeftOut) -> String {
    let patches = counted(
        *patches,
        "strip, patch or patch tip is too narrow for so few vertices",
        "strips, patches or patch tips are too narrow for so few vertices",
    );
    format!(
        "{patches}: each is joined with a neighbour and the sharp edges between them are dropped, which moves the surface \
         by {deviation:.2e} at most; more points keep more of them"
    )
}

/// Notes what repair did to the input.
fn notes_on_repairs(r: &Repairs) -> impl Iterator<Item = String> {
    let dropped = r.degenerate_triangles + r.duplicate_triangles;
    let done = [
        (
            r.faces_between_cells,
            ["face between the cells of a volume was", "faces between the cells of a volume were"],
            "dropped: only its outer surface is left",
        ),
        (
            r.cut_edges,
            ["edge with more than two faces was", "edges with more than two faces were"],
            "taken apart into sheets",
        ),
        (r.split_vertices, ["vertex was", "vertices were"], "duplicated where sheets met only at a point or an edge"),
        (
            r.unorientable_edges,
            ["edge was", "edges were"],
            "cut open because the surface is one-sided (like a Möbius strip)",
        ),
        (r.flipped_triangles, ["face was", "faces were"], "turned over to agree with the neighbours"),
        (
            r.needles,
            ["triangle with almost no height was", "triangles with almost no height were"],
            "collapsed or flipped: rounding had produced them",
        ),
        (dropped, ["degenerate or repeated face was", "degenerate or repeated faces were"], "dropped"),
        (
            r.seam_vertices,
            ["boundary vertex was", "boundary vertices were"],
            "welded to others not exactly at the same place, which closes seams",
        ),
    ];
    let any = done.into_iter().filter(|(count, ..)| *count > 0);
    any.map(|(count, [one, many], done)| format!("{} {done}", counted(count, one, many)))
}

/// Collects the notes on a result.
pub(in crate::pipeline) fn notes(result: &Remeshed, cracks: Option<Cracks>) -> Vec<String> {
    let mut notes: Vec<String> = notes_on_repairs(&result.repairs).collect();
    notes.extend(cracks.map(note_on_cracks));
    if result.is_rough {
        notes.push("the surface is rough, like a noisy scan: smoothing removes noise".into());
    }
    if result.blunted {
        notes.push("the sharp edges are too close together for so few vertices: none is kept sharp".into());
    }
    if result.output.vertices != result.wanted {
        notes.push(format!(
            "{} instead of {}: the topology of the input needs that many",
            counted(result.output.vertices, "vertex", "vertices"),
            result.wanted
        ));
    }
    notes.extend(notes_on_self_intersections(result));
    notes.extend(note_on_slivers(result));
    notes.extend(note_on_bridges(result));
    notes.extend(result.deviation.as_ref().filter(|d| !d.is_allowed()).map(note_on_deviation));
    if !result.has_topology() {
        notes.push("the result does not have the topology of the input".into());
    }
    notes.extend(result.lost.as_ref().map(LostComponents::note));
    if result.pinholes.count > 0 {
        notes.push(note_on_pinholes(&result.pinholes));
    }
    if result.left_out.patches > 0 {
        notes.push(note_on_left_out(&result.left_out));
    }
    if result.smoothed_curves > 0 {
        let edges = counted(result.smoothed_curves, "sharp edge is", "sharp edges are");
        notes.push(format!(
            "{edges} smoothed over where there are too few vertices to fit between them; more points may keep them"
        ));
    }
    notes
}

impl LostComponents {
    /// Notes how many components were lost, and the size and position of the largest.
    pub fn note(&self) -> String {
        let &LostComponents { gone, shrunk, triangles, share, place } = self;
        let parts = [
            (gone, "component of the input is not in the result", "components of the input are not in the result"),
            (
                shrunk,
                "component is smaller than the edges: only a few triangles, without its shape, are left of it",
                "components are smaller than the edges: only a few triangles, without their shape, are left of them",
            ),
        ];
        let place = near(DVec3::from_array(place));
        format!(
            "{}: the largest, {place}, has {}, {:.2} % of the area; more points keep more of them",
            counts(&parts).join("; "),
            counted(triangles, "triangle", "triangles"),
            100.0 * share
        )
    }
}

/// Notes which boundaries may be cracks, and what would close them.
fn note_on_cracks(Cracks { vertices, width }: Cracks) -> String {
    // Rounding must not make the number smaller.
    let width = format!("{:.2e}", 1.01 * width);
    let vertices = counted(vertices, "boundary vertex lies", "boundary vertices lie");
    format!(
        "{vertices} within {width} of another one across a gap: if it is a crack, a weld \
         distance of {width} closes it"
    )
}

/// Notes how many slivers there are, and where the first one is.
fn note_on_slivers(result: &Remeshed) -> Option<String> {
    let has = ["face has", "faces have"].map(|has| format!("{has} an angle below {SLIVER} degree"));
    note_on_faces(result, &result.slivers, &has, "more points there may avoid that")
}

/// Notes how many bridges there are, and where the first one is.
fn note_on_bridges(result: &Remeshed) -> Option<String> {
    let is = ["face is", "faces are"].map(|is| format!("{is} where the input has no surface"));
    note_on_faces(
        result,
        &result.bridges,
        &is,
        "part of the input is too thin for so few vertices; more points follow it better",
    )
}

/// Notes how many `faces` there are, with a phrase for one and for many, where the first one is, and what helps.
fn note_on_faces(result: &Remeshed, faces: &[u32], [one, many]: &[String; 2], remedy: &str) -> Option<String> {
    let place = near(result.mesh.centroid(*faces.first()? as usize));
    Some(format!("{}, the first {place}: {remedy}", counted(faces.len(), one, many)))
}

/// Notes how many faces intersect others, where the first one is, and whether the input is to blame.
fn notes_on_self_intersections(result: &Remeshed) -> Vec<String> {
    let place = |t: u32| near(result.mesh.centroid(t as usize));
    let intersect = |count: usize| counted(count, "face intersects others", "faces intersect others");
    let (new, all) = (&result.new_self_intersections, &result.self_intersections);
    let of_input = result.self_intersections_of_input.unwrap_or(0);
    let of_new = new.first().map(|&t| {
        let count = new.len();
        format!(
            "{}, the first {}, where no faces of the input do; more points may separate them",
            intersect(count),
            place(t)
        )
    });
    let inherited = all.iter().find(|t| new.binary_search(t).is_err()).map(|&t| {
        let count = all.len() - new.len();
        let of_input = counted(of_input, "face of the input does", "faces of the input do");
        format!("{}, the first {}; {of_input}, too", intersect(count), place(t))
    });
    of_new.into_iter().chain(inherited).collect()
}

/// Notes by how much the requested error bound is exceeded, and where.
fn note_on_deviation(deviation: &Deviation) -> String {
    let Deviation { allowed, reached, place } = deviation;
    let place = near(DVec3::from_array(*place));
    format!(
        "the largest distance to the input, {place}, is {reached:.4e}, more than the allowed {allowed:.4e}: more points reduce it"
    )
}

fn near(place: DVec3) -> String {
    let [x, y, z] = place.to_array().map(|x| format!("{x:.6}"));
    format!("near ({x}, {y}, {z})")
}
