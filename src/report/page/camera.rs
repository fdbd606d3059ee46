//! The initial view of the meshes.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use glam::{DMat3, DVec3};

/// Size of a picture in pixels; a panel of the viewer has the same aspect ratio.
pub(super) const WIDTH: usize = 960;
pub(super) const HEIGHT: usize = 720;

/// Distance of the eye from its target, in half diagonals of the box of all meshes; the viewer uses the same value.
pub(super) const EYE: f64 = 5.0;

/// Azimuth and elevation of the eye, in degrees.
const AROUND: f64 = 30.0;
const ABOVE: f64 = 25.0;

/// Fraction of a picture that is filled.
const FILLED: f64 = 0.95;

/// The common view of all meshes of a page.
pub(super) struct FirstView {
    /// The box of all meshes, and half its diagonal, which is the unit of length of the view.
    pub lo: DVec3,
    pub size: DVec3,
    pub half_diagonal: f64,
    /// The rows of a rotation: right, up, towards the eye.
    pub rotation: [DVec3; 3],
    /// The target of the view relative to the middle of the box, in units of half the diagonal.
    pub target: DVec3,
    /// Magnification: at 1, half a diagonal reaches from the middle of a picture to its upper edge.
    pub zoom: f64,
}

impl FirstView {
    /// A view that `meshes` together fill.
    pub(super) fn of<'a>(meshes: impl Iterator<Item = &'a Mesh> + Clone) -> FirstView {
        let points = meshes.flat_map(|m| &m.positions).copied();
        let bounds = Aabb::of(points.clone()).unwrap_or_default();
        let half_diagonal = 0.5 * bounds.diagonal();
        let half_diagonal = if half_diagonal > 0.0 { half_diagonal } else { 1.0 };
        let rotation = first_rotation(bounds.size());
        let mut view =
            FirstView { lo: bounds.lo, size: bounds.size(), half_diagonal, rotation, target: DVec3::ZERO, zoom: 1.0 };
        // Centring shifts the middle a little because of the perspective, so the reach is measured again afterwards.
        let screen = Aabb::of(points.clone().map(|p| view.on_screen(p))).unwrap_or_default();
        let middle = screen.lo + 0.5 * screen.size();
        view.target = rotation[0] * middle.x + rotation[1] * middle.y;
        let reach = |p: DVec3| p.y.abs().max(p.x.abs() * HEIGHT as f64 / WIDTH as f64);
        let reach = points.map(|p| reach(view.on_screen(p))).fold(0.0, f64::max);
        if reach > 0.0 {
            view.zoom = FILLED / reach;
        }
        view
    }

    /// Returns a point relative to the middle of the box, in units of half the diagonal.
    pub(super) fn off_middle(&self, p: DVec3) -> DVec3 {
        (p - self.lo - 0.5 * self.size) / self.half_diagonal
    }

    /// Returns the position of a point relative to the target: right, up and towards the eye.
    pub(super) fn seen(&self, p: DVec3) -> DVec3 {
        DMat3::from_cols_array_2d(&self.rotation.map(|row| row.to_array())).transpose()
            * (self.off_middle(p) - self.target)
    }

    /// Returns the position of a point in the picture, where y = 1 is the upper edge; near things look larger.
    fn on_screen(&self, p: DVec3) -> DVec3 {
        let seen = self.seen(p);
        self.zoom * EYE / (EYE - seen.z) * seen
    }
}

/// Returns the rows of the initial rotation for a box of this size. The box is seen along its shortest axis, from slightly
/// aside and above, with y up, or with z up if y is the shortest axis.
fn first_rotation(size: DVec3) -> [DVec3; 3] {
    let towards = if size.z <= size.x.min(size.y) {
        DVec3::Z
    } else if size.y <= size.x {
        -DVec3::Y
    } else {
        DVec3::X
    };
    let up = if towards == -DVec3::Y { DVec3::Z } else { DVec3::Y };
    let right = up.cross(towards);
    let [(sin_a, cos_a), (sin_b, cos_b)] = [AROUND, ABOVE].map(|angle: f64| math::sin_cos(angle.to_radians()));
    let eye = cos_b * (cos_a * towards + sin_a * right) + sin_b * up;
    let right = cos_a * right - sin_a * towards;
    [right, eye.cross(right), eye]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::cube;

    /// A cube stretched to this size, away from the origin.
    fn view(size: DVec3) -> (Mesh, FirstView) {
        let mut mesh = cube();
        mesh.positions.iter_mut().for_each(|p| *p = 7.0 + *p * size);
        let view = FirstView::of([&mesh].into_iter());
        (mesh, view)
    }

    #[test]
    fn the_first_rotation_looks_along_the_shortest_axis() {
        for (size, axis) in [([3.0, 2.0, 1.0], DVec3::Z), ([3.0, 1.0, 2.0], -DVec3::Y), ([1.0, 2.0, 3.0], DVec3::X)] {
            let [right, up, near] = view(size.into()).1.rotation;
            assert!(right.cross(up).abs_diff_eq(near, 1e-12) && right.dot(up).abs() < 1e-12);
            assert!((right.length() - 1.0).abs() < 1e-12 && near.dot(axis) > 0.7);
        }
    }

    #[test]
    fn everything_is_in_the_first_picture_and_fills_it() {
        for size in [[3.0, 2.0, 1.0], [1.0, 30.0, 1.0], [5.0, 5.0, 0.0]] {
            let (mesh, view) = view(size.into());
            let aspect = WIDTH as f64 / HEIGHT as f64;
            let reach = |p: &DVec3| {
                let p = view.on_screen(*p);
                (p.x / aspect).abs().max(p.y.abs())
            };
            let largest = mesh.positions.iter().map(reach).fold(0.0, f64::max);
            assert!((0.9..1.0).contains(&largest), "{size:?}: {largest}");
        }
    }
}
