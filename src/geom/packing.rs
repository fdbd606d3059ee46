//! Hexagonal packing: points at distance d from their six neighbours, each with √3 / 2 d² of the area.

/// Returns the number of points at distance `spacing` that cover `area`.
pub fn count_on(area: f64, spacing: f64) -> f64 {
    2.0 * area / (3f64.sqrt() * spacing * spacing)
}

/// Returns the distance at which `count` points cover `area`.
pub fn spacing_of(count: f64, area: f64) -> f64 {
    (2.0 * area / (3f64.sqrt() * count)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_and_two_triangles_go_together() {
        let area =
            2.0 * crate::geom::triangle::area([[0.0; 3], [3.0, 0.0, 0.0], [1.5, 6.75f64.sqrt(), 0.0]].map(Into::into));
        assert!((count_on(area, 3.0) - 1.0).abs() < 1e-12 && (spacing_of(4.0, 4.0 * area) - 3.0).abs() < 1e-12);
    }
}
