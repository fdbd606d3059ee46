//! Evaluates the library's measure s(x) at points of the plane or of space, for comparison with other implementations.
//!
//! ```text
//! cargo run --release --example measure -- NEIGHBOURS.txt QUERIES.txt
//! ```
//!
//! Each line of both files contains the two or three coordinates of a point in units of σ. Prints one line per query: s
//! after the nearest neighbour, after the two nearest, and so on, up to the library's maximum number of neighbours.

use spectral_remesh::stages::geom::vector::{difference, length_squared};
use spectral_remesh::stages::spectral::measure::{MOST_NEIGHBOURS, Measure};
use std::error::Error;

type Point = [f64; 3];

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [neighbours, queries] = names.as_slice() else {
        return Err("two files are expected: neighbours and queries".into());
    };
    let neighbours = read(neighbours)?;
    for query in read(queries)? {
        let values: Vec<String> = measures(&query, &neighbours).iter().map(f64::to_string).collect();
        println!("{}", values.join(" "));
    }
    Ok(())
}

/// Returns s(x) after each of the neighbours, the nearest first.
fn measures(x: &Point, neighbours: &[Point]) -> Vec<f64> {
    let mut offsets: Vec<Point> = neighbours.iter().map(|p| difference(p, x)).collect();
    offsets.sort_by(|a, b| length_squared(a).total_cmp(&length_squared(b)));
    let mut measure = Measure::new();
    offsets.iter().take(MOST_NEIGHBOURS).map(|offset| measure.add(offset)).collect()
}

fn read(name: &str) -> Result<Vec<Point>, Box<dyn Error>> {
    let text = std::fs::read_to_string(name).map_err(|e| format!("{name}: {e}"))?;
    text.lines().map(|line| point(line).map_err(|e| format!("{name}: {line}: {e}").into())).collect()
}

/// Parses a point of space; a point of the plane gets z = 0.
fn point(line: &str) -> Result<Point, Box<dyn Error>> {
    let numbers = line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    match *numbers.as_slice() {
        [x, y] => Ok([x, y, 0.0]),
        [x, y, z] => Ok([x, y, z]),
        _ => Err("two or three coordinates are expected".into()),
    }
}
