//! Draws a mesh, or two side by side, to a PNG file. Needs neither a display nor a graphics card.
//!
//! `cargo run --release --example render -- MESH [MESH] OUT.png [--size 800] [--view AZIMUTH,ELEVATION] [--zoom 1]`

#![allow(clippy::disallowed_methods)]

mod camera;
mod shade;

use camera::{Camera, Panel};
use clap::Parser;
use spectral_remesh::Error;
use spectral_remesh::io::file::read_file;
use spectral_remesh::stages::picture::raster::draw;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Samples along each side of a pixel.
const SAMPLES: usize = 4;

/// Draw one mesh, or two side by side as seen by one camera, to a PNG file.
#[derive(Parser)]
struct Arguments {
    /// One or two meshes, and the PNG file to write.
    #[arg(num_args = 2..=3, required = true, value_name = "MESH.. OUT.png")]
    files: Vec<PathBuf>,
    /// Longer side of a mesh's part of the picture, in pixels.
    #[arg(long, default_value_t = 800, value_parser = clap::value_parser!(u32).range(16..=8000))]
    size: u32,
    /// Where the camera stands: degrees around the z axis from x, degrees above the horizon.
    #[arg(long, default_value = "30,20", value_parser = angles, value_name = "AZIMUTH,ELEVATION", allow_hyphen_values = true)]
    view: (f64, f64),
    /// Enlarges the middle of the picture.
    #[arg(long, default_value_t = 1.0)]
    zoom: f64,
    /// The axis that points up in the picture.
    #[arg(long, default_value = "z", value_parser = ["y", "z"])]
    up: String,
    /// Width of the lines along edges, in pixels; 0 for none.
    #[arg(long, default_value_t = 1.0)]
    line: f64,
}

fn angles(text: &str) -> Result<(f64, f64), String> {
    let parse = |s: &str| s.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let both = text.split_once(',').and_then(|(a, e)| Some((parse(a)?, parse(e)?)));
    both.ok_or_else(|| "two angles in degrees are expected, such as 30,20".into())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let (out, inputs) = arguments.files.split_last().expect("clap asks for two files or three");
    let mut meshes = inputs.iter().map(|file| Ok(read_file(file, None)?.mesh)).collect::<Result<Vec<_>, Error>>()?;
    if arguments.up == "y" {
        meshes.iter_mut().flat_map(|m| &mut m.positions).for_each(|p| *p = glam::DVec3::new(p.x, -p.z, p.y));
    }
    let camera = Camera::new(&meshes[0], arguments.view);
    let panel = Panel::new(&camera, &meshes[0], arguments.size as usize, arguments.zoom);
    let pictures: Vec<Vec<[u8; 3]>> = meshes
        .iter()
        .map(|mesh| {
            let view = camera.project(mesh, &panel, SAMPLES);
            let hits = draw(view.projected(), panel.width * SAMPLES, panel.height * SAMPLES);
            shade::resolve(&view, &hits, &panel, SAMPLES, arguments.line)
        })
        .collect();
    save(out, &panel, &pictures)?;
    Ok(())
}

/// Writes pictures of the same size side by side.
fn save(path: &Path, panel: &Panel, pictures: &[Vec<[u8; 3]>]) -> Result<(), Box<dyn std::error::Error>> {
    let width = panel.width * pictures.len();
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width as u32, panel.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let rows = (0..panel.height).flat_map(|y| pictures.iter().map(move |p| &p[y * panel.width..][..panel.width]));
    let bytes: Vec<u8> = rows.flatten().flatten().copied().collect();
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}
