//! Projection from space to the picture.

use glam::{DVec2, DVec3};
use spectral_remesh::Mesh;
use spectral_remesh::geom::aabb::Aabb;
use spectral_remesh::stages::picture::raster::Projected;

/// Distance of the camera from the middle of the mesh, in half diagonals of its bounding box.
const DISTANCE: f64 = 4.5;

/// Fraction of the picture's longer side that remains free around the mesh.
const MARGIN: f64 = 0.06;

/// A camera that is directed at the middle of a mesh, with z up.
pub struct Camera {
    middle: DVec3,
    right: DVec3,
    up: DVec3,
    /// Direction from the middle towards the camera.
    towards: DVec3,
    distance: f64,
}

/// The part of the picture that shows one mesh.
pub struct Panel {
    /// In pixels.
    pub width: usize,
    pub height: usize,
    /// Pixels per unit of the image plane, and the point of that plane in the middle of the panel.
    scale: f64,
    middle: DVec2,
}

/// A mesh as seen by the camera.
pub struct View {
    pub triangles: Vec<[u32; 3]>,
    /// The position of each vertex in the picture, in samples: x to the right, y down.
    pub places: Vec<DVec2>,
    /// The reciprocal of the distance to each vertex along the line of sight, which is linear over a triangle in the
    /// picture.
    pub nearness: Vec<f64>,
    /// The unit normal of each triangle in the camera's frame: right, up, towards the camera.
    pub normals: Vec<DVec3>,
    /// The length of a pixel at the middle of the mesh, in the mesh's units.
    pub pixel: f64,
}

impl Camera {
    /// A camera at this azimuth and elevation, in degrees.
    pub fn new(mesh: &Mesh, (azimuth, elevation): (f64, f64)) -> Camera {
        let Aabb { lo: low, hi: high } = mesh.bounds().unwrap_or(Aabb { lo: DVec3::ZERO, hi: DVec3::ONE });
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        let right = DVec3::new(-sin_a, cos_a, 0.0);
        let towards = DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e);
        let distance = DISTANCE * 0.5 * (high - low).length();
        Camera { middle: 0.5 * (low + high), right, up: towards.cross(right), towards, distance }
    }

    /// Returns a point's position on the image plane through the middle, and the reciprocal of its distance.
    fn see(&self, p: DVec3) -> (DVec2, f64) {
        let v = p - self.middle;
        let nearness = 1.0 / (self.distance - v.dot(self.towards)).max(1e-3 * self.distance);
        (DVec2::new(v.dot(self.right), v.dot(self.up)) * (self.distance * nearness), nearness)
    }

    /// Projects the mesh to a panel with `samples` samples along each side of a pixel.
    pub fn project(&self, mesh: &Mesh, panel: &Panel, samples: usize) -> View {
        let scale = panel.scale * samples as f64;
        let centre = DVec2::new(panel.width as f64, panel.height as f64) * (0.5 * samples as f64);
        let place = |p| (p - panel.middle) * DVec2::new(scale, -scale) + centre;
        let (places, nearness) = mesh.positions.iter().map(|&p| self.see(p)).map(|(p, n)| (place(p), n)).unzip();
        let normal = |t| {
            let n = mesh.area_vector(t).normalize_or_zero();
            DVec3::new(n.dot(self.right), n.dot(self.up), n.dot(self.towards))
        };
        let normals = (0..mesh.triangles.len()).map(normal).collect();
        View { triangles: mesh.triangles.clone(), places, nearness, normals, pixel: 1.0 / panel.scale }
    }
}

impl View {
    /// Returns the data to draw.
    pub fn projected(&self) -> Projected<'_> {
        Projected { triangles: &self.triangles, places: &self.places, nearness: &self.nearness }
    }
}

impl Panel {
    /// A panel that `mesh` fills at zoom 1, with a longer side of `size` pixels.
    pub fn new(camera: &Camera, mesh: &Mesh, size: usize, zoom: f64) -> Panel {
        let seen = mesh.triangles.iter().flatten().map(|&v| camera.see(mesh.positions[v as usize]).0);
        let (low, high) = seen
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (DVec2::min(low, p), DVec2::max(high, p)));
        let extent = (high - low).max(DVec2::splat(1e-12));
        let scale = size as f64 * (1.0 - MARGIN) / extent.max_element();
        let pixels = |x: f64| (x * scale + size as f64 * MARGIN).ceil().min(size as f64) as usize;
        let (width, height) = (pixels(extent.x), pixels(extent.y));
        Panel { width, height, scale: scale * zoom, middle: 0.5 * (low + high) }
    }
}
