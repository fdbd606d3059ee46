//! The places of a mesh to inspect first: faults that keep it from being verified, and the places with the worst figures.

use crate::mesh::sides::{edges, sorted_sides};
use crate::mesh::triangle_mesh::Mesh;
use crate::report::page::colours::Colouring;
use crate::report::page::html::escape;
use crate::report::page::shown::Shown;
use crate::report::remeshing::Report;
use crate::report::rows::{degrees, hundredths, significant};
use glam::DVec3;
use std::fmt::Write;

/// The reason why a place is listed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Kind {
    name: &'static str,
    /// The colouring that shows why this place is worse than others; `None` for a fault.
    shown_by: Option<Colouring>,
}

const CROSSING: Kind = Kind { name: "intersects another face", shown_by: None };
const SLIVER: Kind = Kind { name: "angle below 1°", shown_by: None };
const BRIDGE: Kind = Kind { name: "no input surface here", shown_by: None };
const NON_MANIFOLD: Kind = Kind { name: "at an edge with more than two faces", shown_by: None };
const MISORIENTED: Kind = Kind { name: "oriented against its neighbour", shown_by: None };
const TOO_FAR: Kind = Kind { name: "farther than allowed", shown_by: None };
const ANGLE: Kind = Kind { name: "smallest angle", shown_by: Some(Colouring::Angle) };
const QUALITY: Kind = Kind { name: "lowest quality", shown_by: Some(Colouring::Quality) };
const DISTANCE: Kind = Kind { name: "largest distance", shown_by: Some(Colouring::Distance) };

/// A place on one of the meshes of a page.
pub(super) struct Place {
    /// The number of the mesh on the page.
    pub mesh: usize,
    /// The reason why it is listed.
    pub kind: Kind,
    /// The figure at the place, and a name for the place.
    pub value: String,
    pub name: String,
    pub point: DVec3,
    /// The surface normal at the place; zero if unknown.
    pub normal: DVec3,
    /// The mean edge length of the mesh.
    pub size: f64,
}

impl Place {
    /// Returns whether the place is a fault rather than just worse than others.
    pub(super) fn is_fault(&self) -> bool {
        self.kind.shown_by.is_none()
    }

    /// Returns the attributes of links to the place for the page's script: its number, and the colouring that shows it.
    pub(super) fn link(&self, number: usize) -> String {
        let by = self.kind.shown_by.map_or(String::new(), |c| format!(" data-by=\"{}\"", c.key()));
        format!("href=\"#view\" data-place=\"{number}\"{by}")
    }
}

/// Maximum numbers of faults and of worst places of one kind.
const FAULTS: usize = 6;
const WORST: usize = 4;

/// Smallest distance that is listed, in percent of the diagonal.
const LEAST_DISTANCE: f64 = 5e-4;

/// Minimum distance between places of one kind, in mean edge lengths: neighbours count as one place.
const APART: f64 = 3.0;

/// Returns the places of the meshes that a report is about, without those of an input.
pub(super) fn places(shown: &[Shown]) -> Vec<Place> {
    (0..).zip(shown).filter_map(|(mesh, shown)| Some(of_mesh(mesh, shown, shown.report?))).flatten().collect()
}

fn of_mesh(number: usize, shown: &Shown, report: &Report) -> Vec<Place> {
    let Some(shape) = &shown.measured.shape else { return Vec::new() };
    let search = Search { number, mesh: shown.mesh, size: shape.edge_mean };
    let angle = |&t: &u32| degrees(shown.angles[t as usize]);
    let (non_manifold, misoriented) = edges_with_faults(shown.mesh);
    let mut places = Vec::new();
    places.extend(search.faces(CROSSING, &report.crossings.faces, |_| String::new()));
    places.extend(search.faces(SLIVER, &report.slivers, angle));
    places.extend(search.faces(BRIDGE, &report.bridges, |_| String::new()));
    places.extend(search.faces(NON_MANIFOLD, &non_manifold, |_| String::new()));
    places.extend(search.faces(MISORIENTED, &misoriented, |_| String::new()));
    if let Some(deviation) = report.deviation.filter(|d| !d.is_allowed()) {
        places.push(search.at(TOO_FAR, DVec3::from(deviation.place), significant(deviation.reached)));
    }
    places.extend(search.faces(ANGLE, &search.worst_faces(&shown.angles), angle));
    let quality = |&t: &u32| format!("Q {:.4}", shown.qualities[t as usize]);
    places.extend(search.faces(QUALITY, &search.worst_faces(&shown.qualities), quality));
    if let Some(distances) = &shown.distances {
        let of_face = |corners: &[u32; 3]| -corners.map(|v| distances[v as usize]).into_iter().fold(0.0, f64::max);
        let of_faces: Vec<f64> = shown.mesh.triangles.iter().map(of_face).collect();
        let mut farthest = search.worst_faces(&of_faces);
        farthest.retain(|&t| -of_faces[t as usize] >= LEAST_DISTANCE);
        places.extend(search.faces(DISTANCE, &farthest, |&t| hundredths(-of_faces[t as usize]) + " %"));
    }
    places
}

/// Returns a face at each edge with more than two faces, and at each edge whose two faces run along it in the same
/// direction.
fn edges_with_faults(mesh: &Mesh) -> (Vec<u32>, Vec<u32>) {
    let (mut non_manifold, mut misoriented) = (Vec::new(), Vec::new());
    for edge in edges(&sorted_sides(&mesh.triangles)) {
        match edge {
            [] | [_] => {}
            [a, b] if a.forward() == b.forward() => misoriented.push(a.side / 3),
            [_, _] => {}
            [first, ..] => non_manifold.push(first.side / 3),
        }
    }
    (non_manifold, misoriented)
}

/// A mesh that is searched for places.
struct Search<'a> {
    number: usize,
    mesh: &'a Mesh,
    /// The mean edge length.
    size: f64,
}

impl Search<'_> {
    /// Returns places for the first of these faces, with a figure for each.
    fn faces(&self, kind: Kind, faces: &[u32], value: impl Fn(&u32) -> String) -> Vec<Place> {
        let place = |t: &u32| Place {
            mesh: self.number,
            kind,
            value: value(t),
            name: format!("face {t}"),
            point: self.centre(*t),
            normal: self.mesh.area_vector(*t as usize).normalize_or_zero(),
            size: self.size,
        };
        faces.iter().take(FAULTS).map(place).collect()
    }

    /// Returns a place at a point, with the normal of the triangle whose centroid is nearest to it.
    fn at(&self, kind: Kind, point: DVec3, value: String) -> Place {
        let [x, y, z] = point.to_array().map(significant);
        let nearest = (0..self.mesh.triangles.len()).min_by(|&s, &t| {
            let distance = |t: usize| self.centre(t as u32).distance_squared(point);
            distance(s).total_cmp(&distance(t))
        });
        let normal = nearest.map_or(DVec3::ZERO, |t| self.mesh.area_vector(t).normalize_or_zero());
        let name = format!("({x}, {y}, {z})");
        Place { mesh: self.number, kind, value, name, point, normal, size: self.size }
    }

    fn centre(&self, t: u32) -> DVec3 {
        self.mesh.centroid(t as usize)
    }

    /// Returns the faces with the lowest values, the lowest first, and only one of neighbouring faces.
    fn worst_faces(&self, values: &[f64]) -> Vec<u32> {
        let mut order: Vec<u32> = (0..values.len() as u32).collect();
        order.sort_by(|&s, &t| values[s as usize].total_cmp(&values[t as usize]).then(s.cmp(&t)));
        let mut found: Vec<u32> = Vec::new();
        for t in order {
            let is_apart = |&s: &u32| self.centre(s).distance(self.centre(t)) > APART * self.size;
            if found.iter().all(is_apart) {
                found.push(t);
            }
            if found.len() == WORST {
                break;
            }
        }
        found
    }
}

/// Returns the places as links, by which the page's script turns the camera.
pub(super) fn list(places: &[Place], shown: &[Shown], are_links: bool) -> String {
    let mut out = String::new();
    let several = shown.iter().filter(|s| s.report.is_some()).count() > 1;
    let numbered: Vec<(usize, &Place)> = places.iter().enumerate().collect();
    for of_mesh in numbered.chunk_by(|a, b| a.1.mesh == b.1.mesh) {
        if several {
            let _ = writeln!(out, "<h3>{}</h3>", escape(&shown[of_mesh[0].1.mesh].title()));
        }
        out.push_str("<div class=\"places\">\n");
        for group in of_mesh.chunk_by(|a, b| a.1.kind == b.1.kind) {
            let _ = write!(out, "<div><h4>{}</h4><ul>", group[0].1.kind.name);
            for (number, place) in group {
                let Place { value, name, .. } = place;
                let text = format!("<b>{value}</b> {name}");
                let _ = match are_links {
                    true => write!(out, "<li><a {}>{text}</a></li>", place.link(*number)),
                    false => write!(out, "<li>{text}</li>"),
                };
            }
            out.push_str("</ul></div>\n");
        }
        out.push_str("</div>\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Report;
    use crate::report::page::shown::{Subject, all};
    use crate::report::remeshing::tests::crossing;
    use crate::testing::sheet;

    fn found(mesh: &Mesh) -> Vec<(&'static str, String)> {
        let report = Report::of_mesh(mesh, None);
        let places = places(&all(None, &[Subject { report: &report, mesh, edges: None }]));
        places.into_iter().map(|place| (place.kind.name, place.name)).collect()
    }

    #[test]
    fn what_is_wrong_comes_before_what_is_worst() {
        let mut mesh = crossing();
        mesh.triangles[0].swap(0, 1);
        let found = found(&mesh);
        assert_eq!(found[0], ("intersects another face", "face 2".into()));
        assert!(found.iter().any(|f| f.0 == "oriented against its neighbour"));
        assert_eq!(found.last().unwrap().0, "lowest quality");
    }

    #[test]
    fn of_neighbours_the_worst_is_named() {
        let mut mesh = sheet(20, |_, _| 0.0);
        mesh.positions[30].x += 0.04;
        mesh.positions[300].x += 0.03;
        let found = found(&mesh);
        let angles: Vec<&String> = found.iter().filter(|f| f.0 == "smallest angle").map(|f| &f.1).collect();
        let near = |name: &str, v: u32| {
            let t: usize = name["face ".len()..].parse().unwrap();
            mesh.triangles[t].contains(&v)
        };
        assert!(near(angles[0], 30) && near(angles[1], 300) && angles.len() == WORST, "{angles:?}");
    }
}
