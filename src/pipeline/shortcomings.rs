//! What keeps a result from being what was asked for. A result without any of these is verified.

use crate::base::count::counts;
use crate::mesh::topology::Topology;
use crate::pipeline::coverage::Coverage;
use crate::pipeline::result::{Deviation, Remeshed};

/// What keeps a result from being an oriented manifold of the Euler characteristic, components and boundary loops of
/// `wanted`, without `crossing` faces where the input has none, without `slivers` and `bridges`, within the error asked for and
/// near all points of a cloud, a phrase each; empty if it is one.
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

/// What keeps a mesh, `crossing` of whose faces intersect others, from being a sound oriented manifold, a phrase each.
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
    /// What keeps the result from being what was asked for, a phrase each, held against the points of a cloud, too, where it
    /// is known how near it is to them.
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

    /// Whether the result is what it should be: of the topology of the repaired input, without faces that cross each
    /// other where those of the input do not, without slivers and bridges, and as near to the input as was asked for.
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
