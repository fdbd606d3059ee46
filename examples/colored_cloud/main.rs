//! Turns a cloud of coloured points into a mesh whose vertices have colours, too, and know the points between which they
//! lie.
//!
//! `cargo run --release --example colored_cloud`

#![allow(clippy::disallowed_methods)]

use spectral_remesh::{Attribute, Attributes, Input, Options, Result, Scalar, remesh};
use std::f64::consts::{PI, TAU};

fn main() -> Result<()> {
    // 5,000 points on a sphere, along a spiral, with colours that depend on the height.
    let point = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 5000.0;
        let (sin, cos) = (f64::from(i) * TAU * 2.0 / (1.0 + 5f64.sqrt())).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    };
    let positions: Vec<[f64; 3]> = (0..5000).map(point).collect();
    let color = |p: &[f64; 3]| [p[2].acos() / PI, 0.5, 1.0 - p[2].acos() / PI];
    let values = positions.iter().flat_map(color).collect();
    let color = Attribute { name: "color".into(), components: 3, values, scalar: Scalar::F32 };
    let attributes = Attributes { vertex: vec![color], ..Attributes::default() };

    let input = Input::points(&positions).with_attributes(&attributes);
    let outcome = remesh(&input, &Options::points(1000).into(), &())?;
    println!("{} vertices, {} triangles, verified: {}", 1000, outcome.triangles().len(), outcome.verified());
    for v in [0, 500, 999] {
        let (position, origin) = (outcome.positions()[v], outcome.origins[v]);
        println!("{position:.3?} has the colour {:.3?}", outcome.attributes.vertex[0].of(v));
        println!("    and lies between the points {:?}, {:.2?}", origin.vertices, origin.weights);
    }
    Ok(())
}
