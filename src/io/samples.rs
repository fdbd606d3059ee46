//! Writing samples: points with normals and, if they are a subset of others, their numbers there.

use super::text::write_line;
use crate::surface::points::Points;
use std::io::{self, Write};

/// A format that samples can be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleFormat {
    /// `v` and `vn` lines, without the numbers.
    Obj,
    /// Binary: x y z, nx ny nz and, for a subset, index.
    Ply,
    /// Lines of x y z and, with normals, nx ny nz; without the numbers.
    Xyz,
}

impl SampleFormat {
    /// The format whose files have this ending (without a dot, upper or lower case).
    pub fn from_extension(extension: &str) -> Option<SampleFormat> {
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(SampleFormat::Obj),
            "ply" => Some(SampleFormat::Ply),
            "xyz" | "xyzn" => Some(SampleFormat::Xyz),
            _ => None,
        }
    }
}

/// Writes samples as the content of a file. `out` should be buffered. Coordinates keep every bit.
///
/// # Errors
/// Those of `out`.
pub fn write_samples(
    points: &Points,
    indices: Option<&[u32]>,
    format: SampleFormat,
    out: &mut dyn Write,
) -> io::Result<()> {
    match format {
        SampleFormat::Obj => {
            points.positions.iter().try_for_each(|p| write_line(out, "v", p.to_array()))?;
            points.normals.iter().try_for_each(|n| write_line(out, "vn", n.to_array()))
        }
        SampleFormat::Ply => write_ply(points, indices, out),
        SampleFormat::Xyz => write_xyz(points, out),
    }
}

fn write_ply(points: &Points, indices: Option<&[u32]>, out: &mut dyn Write) -> io::Result<()> {
    let Points { positions, normals } = points;
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", positions.len())?;
    let names: &[&str] = if normals.is_empty() { &["x", "y", "z"] } else { &["x", "y", "z", "nx", "ny", "nz"] };
    names.iter().try_for_each(|name| writeln!(out, "property double {name}"))?;
    if indices.is_some() {
        writeln!(out, "property uint index")?;
    }
    writeln!(out, "end_header")?;
    for (i, p) in positions.iter().enumerate() {
        out.write_all(p.to_array().map(f64::to_le_bytes).as_flattened())?;
        if let Some(n) = normals.get(i) {
            out.write_all(n.to_array().map(f64::to_le_bytes).as_flattened())?;
        }
        if let Some(indices) = indices {
            out.write_all(&indices[i].to_le_bytes())?;
        }
    }
    Ok(())
}

fn write_xyz(points: &Points, out: &mut dyn Write) -> io::Result<()> {
    for (i, p) in points.positions.iter().enumerate() {
        match points.normals.get(i) {
            Some(n) => write_line(out, "", [p.x, p.y, p.z, n.x, n.y, n.z])?,
            None => write_line(out, "", p.to_array())?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, dvec3};

    fn points() -> Points {
        Points { positions: vec![DVec3::ZERO, dvec3(1.5, -2.0, 1e-7)], normals: vec![DVec3::Z, DVec3::X] }
    }

    fn written(points: &Points, indices: Option<&[u32]>, format: SampleFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_samples(points, indices, format, &mut bytes).expect("memory does not fail");
        bytes
    }

    #[test]
    fn text_is_plain() {
        let xyz = written(&points(), None, SampleFormat::Xyz);
        assert_eq!(String::from_utf8(xyz).unwrap(), "0 0 0 0 0 1\n1.5 -2 1e-7 1 0 0\n");
        let obj = written(&points(), None, SampleFormat::Obj);
        assert_eq!(String::from_utf8(obj).unwrap(), "v 0 0 0\nv 1.5 -2 1e-7\nvn 0 0 1\nvn 1 0 0\n");
    }

    #[test]
    fn the_reader_understands_ply() {
        let bytes = written(&points(), Some(&[7, 300]), SampleFormat::Ply);
        let read = |name| crate::io::property(&bytes, crate::io::Format::Ply, crate::io::NO_BUFFERS, name).unwrap();
        assert_eq!(read("index"), [7.0, 300.0]);
        assert_eq!(read("nx"), [0.0, 1.0]);
        let loaded = crate::io::parse(&bytes, crate::io::Format::Ply, crate::io::NO_BUFFERS).unwrap();
        assert_eq!(loaded.mesh.positions, points().positions);
    }
}
