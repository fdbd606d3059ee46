//! Points of a file as rows of numbers: x, y, z, red, green, blue and intensity; NaN where a number is missing.

use super::MAGIC;
use super::scans::{Cloud, Point, each_point, promised};
use crate::base::error::Result;
use crate::io::bytes::array;
use crate::io::content::Parsed;
use crate::io::table::{Packed, Rows, Table};
use crate::prepare::thin::Seen;
use glam::DVec3;
use std::fs::File;
use std::io::BufReader;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Numbers per row, and bytes per number.
const NUMBERS: usize = 7;
const NUMBER: usize = 8;

/// Data shared by all points: the number of directions in which nothing was seen, known once all points were shown.
#[derive(Default)]
struct Scans {
    nowhere: Arc<AtomicUsize>,
}

/// Returns the table of points of a file that begins with `head`.
pub(crate) fn table(head: &[u8]) -> Option<Table> {
    let rows = Scans::default();
    let packed = Scans { nowhere: Arc::clone(&rows.nowhere) };
    let row = NUMBERS * NUMBER;
    let table = Table { start: 0, row, points: 0, rows: Box::new(rows), packed: Some(Box::new(packed)) };
    head.starts_with(MAGIC).then_some(table)
}

fn row(point: Point) -> Vec<u8> {
    let color = point.color.unwrap_or([f64::NAN; 3]);
    let numbers = point.position.to_array().into_iter().chain(color).chain([point.intensity.unwrap_or(f64::NAN)]);
    numbers.flat_map(f64::to_le_bytes).collect()
}

fn point(row: &[u8]) -> Point {
    let number = |k: usize| array(row, NUMBER * k).map_or(f64::NAN, f64::from_le_bytes);
    let known = |x: f64| Some(x).filter(|x| !x.is_nan());
    Point {
        position: DVec3::from_array([0, 1, 2].map(number)),
        color: known(number(3)).map(|red| [red, number(4), number(5)]),
        intensity: known(number(6)),
    }
}

impl Rows for Scans {
    fn look(&self, row: &[u8]) -> Seen {
        Seen { position: point(row).position, normal: DVec3::ZERO }
    }

    fn read(&self, rows: &[u8]) -> Parsed {
        let mut cloud = Cloud::default();
        rows.chunks_exact(NUMBERS * NUMBER).for_each(|row| cloud.push(point(row)));
        Ok(cloud.finish(self.nowhere.load(Ordering::Relaxed)))
    }
}

impl Packed for Scans {
    fn count(&self, file: &File) -> Result<Option<usize>> {
        promised(BufReader::new(file)).map(|points| usize::try_from(points).ok())
    }

    fn unpack(&self, file: &File, show: &mut dyn FnMut(&[u8]) -> Result<()>) -> Result<()> {
        let nowhere = each_point(BufReader::new(file), &mut |point| show(&row(point)))?;
        self.nowhere.store(nowhere, Ordering::Relaxed);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{parse, tests::file};
    use super::*;
    use std::io::{Seek, Write};

    #[test]
    fn points_become_the_rows_that_all_of_the_file_has() {
        let bytes = file();
        let table = table(&bytes).unwrap();
        let mut on_disk = tempfile::tempfile().unwrap();
        on_disk.write_all(&bytes).unwrap();
        on_disk.rewind().unwrap();
        let packed = table.packed.unwrap();
        assert_eq!(packed.count(&on_disk).unwrap(), Some(6), "with directions in which nothing was seen");
        let mut rows = Vec::new();
        packed
            .unpack(&on_disk, &mut |row| {
                rows.extend_from_slice(row);
                Ok(())
            })
            .unwrap();
        assert_eq!(rows.len(), 4 * table.row);
        assert_eq!(table.rows.look(&rows[table.row..]).position, DVec3::new(3.0, 0.5, 0.25));
        assert!(table.rows.read(&rows).unwrap() == parse(&bytes).unwrap());
    }
}
