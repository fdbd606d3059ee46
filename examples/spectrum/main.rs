//! The spectrum of samples on a toroidal square (paper, section 7.1 and figure 11): the mean periodogram of ten random point
//! distributions, each after ten sweeps of gradient ascent, with its radial power and its anisotropy.
//!
//! `cargo run --release --example spectrum -- [POINTS [FOLDER]]` writes `points-0.csv` to `points-9.csv`,
//! `periodogram.png` and `spectrum.csv` to the folder, and prints the normalized Poisson-disk radius ρ.
//!
//! The periodogram is P(f) = |Σ exp(-2πi f·x)|² / N at integer frequencies f, by direct summation. The radial power is its
//! mean over rings |f| = r. The anisotropy is the variance over the ring divided by the square of that mean: -10 dB for the
//! mean of ten isotropic distributions. R. A. Ulichney, Digital halftoning, 1987, chapter 3.

#![allow(clippy::disallowed_methods)]

use spectral_remesh::stages::base::error::Result;
use spectral_remesh::stages::base::rng::{Stage, stream, unit};
use spectral_remesh::stages::geom::vector::length_squared;
use spectral_remesh::stages::spectral::ascent::{AscentParameters, PAPER_STEP};
use spectral_remesh::stages::spectral::free_ascent::ascend_freely;
use spectral_remesh::stages::surface::submanifold::{FlatTorus, Submanifold};
use std::f64::consts::TAU;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Number of distributions over which the periodogram is averaged.
const RUNS: u64 = 10;

/// Range of frequencies on either side of zero, in units of √N: the power of blue noise settles at about three.
const FREQUENCIES: f64 = 3.0;

/// The power that is shown as white in the picture.
const WHITE: f64 = 3.0;

type Points = Vec<[f64; 2]>;

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().map_or(Ok(1024), |word| word.parse())?;
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "target/spectrum".into()));
    fs::create_dir_all(&folder)?;
    let runs: Vec<Points> = (0..RUNS).map(|seed| blue_noise(count, seed)).collect::<Result<_>>()?;
    let radii: Vec<f64> = runs.iter().map(poisson_disk_radius).collect();
    println!("{count} points, ρ of {RUNS} runs: mean {:.3}", radii.iter().sum::<f64>() / radii.len() as f64);

    let spectrum = Spectrum::of(&runs);
    for (seed, points) in runs.iter().enumerate() {
        write_points(&folder.join(format!("points-{seed}.csv")), points)?;
    }
    write_rings(&folder.join("spectrum.csv"), &spectrum)?;
    write_picture(&folder.join("periodogram.png"), &spectrum)?;
    println!("points, spectrum.csv and periodogram.png are in {}", folder.display());
    Ok(())
}

/// Returns random points after ten sweeps, with the kernel of the paper: σ = 2.5 r for ρ = 0.75.
fn blue_noise(count: usize, seed: u64) -> Result<Points> {
    let mut rng = stream(seed, Stage::Candidates);
    let mut points: Points = (0..count).map(|_| [unit(&mut rng), unit(&mut rng)]).collect();
    let sigma = 2.5 * 0.75 * largest_radius(count);
    ascend_freely(&FlatTorus, &mut points, AscentParameters { sigma, step: PAPER_STEP, sweeps: 10 }, &())?;
    Ok(points)
}

/// The radius of disks around this number of points at hexagonal packing.
fn largest_radius(count: usize) -> f64 {
    (1.0 / (2.0 * 3f64.sqrt() * count as f64)).sqrt()
}

/// ρ: half the distance of the closest pair, divided by the largest possible radius.
fn poisson_disk_radius(points: &Points) -> f64 {
    let distance = |i: usize, j: usize| length_squared(&FlatTorus.offset(&points[i], &points[j]));
    let pairs = (0..points.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| distance(i, j)).fold(f64::INFINITY, f64::min).sqrt() / 2.0 / largest_radius(points.len())
}

/// A mean periodogram, row by row, of frequencies from -`highest` to `highest`.
struct Spectrum {
    highest: i32,
    power: Vec<f64>,
}

impl Spectrum {
    fn of(runs: &[Points]) -> Spectrum {
        let count = runs[0].len() as f64;
        let highest = (FREQUENCIES * count.sqrt()).ceil() as i32;
        let all = (-highest..=highest).flat_map(|v| (-highest..=highest).map(move |u| [u, v]));
        let mean = |f: [i32; 2]| runs.iter().map(|points| power(points, f)).sum::<f64>() / runs.len() as f64;
        Spectrum { highest, power: all.map(mean).collect() }
    }

    /// Returns the radius, the mean power, and the anisotropy in decibels of each ring.
    fn rings(&self) -> Vec<(i32, f64, f64)> {
        let size = 2 * self.highest + 1;
        let mut rings: Vec<Vec<f64>> = vec![Vec::new(); self.highest as usize + 1];
        for (i, &power) in (0..).zip(&self.power) {
            let [u, v] = [i % size - self.highest, i / size - self.highest];
            let radius = f64::from(u * u + v * v).sqrt().round() as usize;
            // Use only one of each pair of opposite frequencies, since both have the same power.
            if (v, u) > (0, 0) && radius < rings.len() {
                rings[radius].push(power);
            }
        }
        rings.iter().zip(0..).skip(1).map(|(ring, radius)| ring_figures(radius, ring)).collect()
    }
}

/// The power of a distribution at one frequency.
fn power(points: &Points, f: [i32; 2]) -> f64 {
    let phase = |x: &[f64; 2]| TAU * (f64::from(f[0]) * x[0] + f64::from(f[1]) * x[1]);
    let (sin, cos) = points.iter().map(|x| phase(x).sin_cos()).fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    (sin * sin + cos * cos) / points.len() as f64
}

fn ring_figures(radius: i32, ring: &[f64]) -> (i32, f64, f64) {
    let mean = ring.iter().sum::<f64>() / ring.len() as f64;
    let variance = ring.iter().map(|p| (p - mean) * (p - mean)).sum::<f64>() / (ring.len() as f64 - 1.0).max(1.0);
    (radius, mean, 10.0 * (variance / (mean * mean)).log10())
}

fn write_points(path: &Path, points: &Points) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    writeln!(out, "x,y")?;
    points.iter().try_for_each(|[x, y]| writeln!(out, "{x},{y}"))?;
    out.flush()
}

fn write_rings(path: &Path, spectrum: &Spectrum) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    writeln!(out, "frequency,power,anisotropy_db")?;
    let rings = spectrum.rings();
    rings.iter().try_for_each(|(radius, power, decibels)| writeln!(out, "{radius},{power:.5},{decibels:.3}"))?;
    out.flush()
}

/// Writes the periodogram in shades of grey, with frequency zero in the middle in black.
fn write_picture(path: &Path, spectrum: &Spectrum) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let size = 2 * spectrum.highest as usize + 1;
    let mut shades: Vec<u8> = spectrum.power.iter().map(|p| (255.0 * (p / WHITE).min(1.0)) as u8).collect();
    shades[size * size / 2] = 0;
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), size as u32, size as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&shades)?;
    Ok(())
}
