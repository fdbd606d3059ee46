//! Shortcomings of a result compared with the requirements. A result without any is verified.

use crate::base::count::counts;
use crate::mesh::topology::Topology;
use crate::pipeline::cloud::coverage::Coverage;
use crate::pipeline::result::{Deviation, Remeshed};

/// Returns the shortcomings of a result, a phrase each; empty if it is an oriented manifold with the Euler characteristic,
/// components and boundary loops of `wanted`, without `crossing` faces where the input has none, without `slivers` and
/// `bridges`, within the requested error bound, and close to nearly all points of a cloud.
pub fn shortcomings(
    found: &Topology,
    wanted: &Topology,
    crossing: usize,
    slivers: usize,
    bridges: usize,
    deviation: Option<&Deviation>,
    coverage: Option<&Coverage>,
) -> Vec<String> {
    let faces = counts(&[
        (slivers, "face with an angle below 1 degree", "faces with an angle below 1 degree"),
        (bridges, "face where the input has no surface", "faces where the input has no surface"),
    ]);
    let differences = [
        ("Euler characteristic", found.euler, wanted.euler),
        ("number of components", found.components as i64, wanted.components as i64),
        ("number of boundary loops", found.boundary_loops as i64, wanted.boundary_loops as i64),
    ];
    let differences = differences.iter().filter(|(_, found, wanted)| found != wanted);
    let differences = differences.map(|(what, found, wanted)| format!("the {what} is {found} instead of {wanted}"));
    let far = deviation.filter(|d| !d.is_allowed());
    let far = far.map(|d| format!("the distance to the input is up to {:.4e} instead of {:.4e}", d.reached, d.allowed));
    let missed = coverage.filter(|coverage| !coverage.is_enough());
    let missed = missed.map(|Coverage { points, missed, within, .. }| {
        format!("{missed} of {points} points are farther than {within:.4e} from the result")
    });
    topology_faults(found, crossing).into_iter().chain(faces).chain(differences).chain(far).chain(missed).collect()
}

/// Returns the faults of a mesh as an oriented manifold, a phrase each; `crossing` of its faces intersect others.
pub fn topology_faults(found: &Topology, crossing: usize) -> Vec<String> {
    counts(&[
        (found.nonmanifold_edges, "edge with more than two faces", "edges with more than two faces"),
        (found.nonmanifold_vertices, "vertex with more than one fan", "vertices with more than one fan"),
        (
            found.misoriented_edges,
            "edge between faces of opposite orientation",
            "edges between faces of opposite orientation",
        ),
        (crossing, "self-intersecting face", "self-intersecting faces"),
    ])
}

impl Remeshed {
    /// Returns the shortcomings of the result, a phrase each. They include points of a cloud that it misses, if its
    /// `coverage` is known.
    pub fn shortcomings(&self, coverage: Option<&Coverage>) -> Vec<String> {
        shortcomings(
            &self.output,
            &self.repaired,
            self.new_self_intersections.len(),
            self.slivers.len(),
            self.bridges.len(),
            self.deviation.as_ref(),
            coverage,
        )
    }

    /// Returns whether the result meets the requirements: it has the topology of the repaired input, no faces that intersect
    /// each other where those of the input do not, no slivers and no bridges, and it is as close to the input as requested.
    pub fn verified(&self) -> bool {
        self.shortcomings(None).is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::testing::tetrahedron;

    #[test]
    fn self_intersections_that_the_input_does_not_have_are_a_shortcoming() {
        let wanted = topology(4, &tetrahedron().triangles);
        let of_new = |new: usize| shortcomings(&wanted, &wanted, new, 0, 0, None, None);
        assert_eq!(of_new(2), ["2 self-intersecting faces"]);
        assert_eq!(of_new(1), ["1 self-intersecting face"]);
        assert_eq!(of_new(0), [""; 0]);
    }

    #[test]
    fn triangles_where_the_input_has_no_surface_are_a_shortcoming() {
        let wanted = topology(4, &tetrahedron().triangles);
        let found = shortcomings(&wanted, &wanted, 0, 0, 3, None, None);
        assert_eq!(found, ["3 faces where the input has no surface"]);
    }
}
