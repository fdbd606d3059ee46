//! Tests of COPC files: which parts of them are read.

use super::copc::{ENTRY, INFO, PAGE, RECORD, USER};
use super::header::{COMPRESSED, MAGIC};
use super::{parse, table};
use crate::base::error::Result;
use crate::geom::aabb::Aabb;
use crate::io::bytes::u32_at;
use crate::prepare::thin::{Levels, Wanted};
use glam::DVec3;
use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr, LazVlrBuilder};
use std::io::{Cursor, Write};

const ROW: usize = 30;

/// Side of the square of points, one in each unit cell; those of the root are in every fourth row and column, those of the
/// middle level in every second one.
const SIDE: usize = 32;

/// Chunks: level, place, and points.
fn chunks() -> Vec<([i32; 4], Vec<[u8; ROW]>)> {
    let mut chunks: Vec<([i32; 4], Vec<[u8; ROW]>)> = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        let level = (0..2).find(|level| (x | y) % (4 >> level) == 0).unwrap_or(2);
        let place = |x: usize| (x * (1 << level) / SIDE) as i32;
        let mut row = [0; ROW];
        row[..4].copy_from_slice(&(x as i32).to_le_bytes());
        row[4..8].copy_from_slice(&(y as i32).to_le_bytes());
        row[12..14].copy_from_slice(&(i as u16).to_le_bytes());
        let key = [level, place(x), place(y), 0];
        match chunks.iter_mut().find(|(other, _)| *other == key) {
            Some((_, rows)) => rows.push(row),
            None => chunks.push((key, vec![row])),
        }
    }
    chunks
}

fn record(user: &[u8], number: u16, data: &[u8]) -> Vec<u8> {
    let mut record = vec![0; 54];
    record[2..2 + user.len()].copy_from_slice(user);
    record[18..20].copy_from_slice(&number.to_le_bytes());
    record[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
    [&record, data].concat()
}

/// A file with the octree of these chunks; the entries of its last level are in a page of their own.
fn copc() -> Vec<u8> {
    let items = LazItemRecordBuilder::default_for_point_format_id(6, 0).unwrap();
    let laszip = LazVlrBuilder::new(items).with_variable_chunk_size().build();
    let mut data = Vec::new();
    laszip.write_to(&mut data).unwrap();
    let records =
        |info: &[u8]| [record(USER, 1, info), record(LazVlr::USER_ID.as_bytes(), LazVlr::RECORD_ID, &data)].concat();
    let start = RECORD as usize + records(&[0; 160]).len();
    let mut compressor = LasZipCompressor::new(Cursor::new(Vec::new()), laszip.clone()).unwrap();
    let (mut ends, chunks) = (vec![8], chunks());
    for (_, rows) in &chunks {
        rows.iter().for_each(|row| compressor.compress_one(row).unwrap());
        compressor.finish_current_chunk().unwrap();
        ends.push(compressor.get().position());
    }
    compressor.done().unwrap();
    let mut points = compressor.into_inner().into_inner();
    // The compressor did not know where its output will be.
    let table = u64::from_le_bytes(*points.first_chunk().unwrap()) + start as u64;
    points[..8].copy_from_slice(&table.to_le_bytes());
    let entry = |key: [i32; 4], at: u64, size: usize, points: i32| {
        let mut entry = key.map(i32::to_le_bytes).concat();
        entry.extend(at.to_le_bytes());
        entry.extend((size as i32).to_le_bytes());
        entry.extend(points.to_le_bytes());
        entry
    };
    let (mut first, mut last) = (Vec::new(), Vec::new());
    for ((key, rows), at) in chunks.iter().zip(ends.windows(2)) {
        let page = if key[0] == 2 { &mut last } else { &mut first };
        page.extend(entry(*key, start as u64 + at[0], (at[1] - at[0]) as usize, rows.len() as i32));
    }
    let pages = (start + points.len()) as u64;
    first.extend(entry([2, 0, 0, 0], pages + first.len() as u64 + ENTRY as u64, last.len(), PAGE));
    let half = SIDE as f64 / 2.0;
    let mut info: Vec<u8> = [half, half, half, half, 4.0].map(f64::to_le_bytes).concat();
    info.extend(pages.to_le_bytes());
    info.extend((first.len() as u64).to_le_bytes());
    info.resize(160, 0);
    let mut header = vec![0; RECORD as usize];
    header[..4].copy_from_slice(MAGIC);
    header[24..26].copy_from_slice(&[1, 4]);
    header[94..96].copy_from_slice(&(RECORD as u16).to_le_bytes());
    header[96..100].copy_from_slice(&(start as u32).to_le_bytes());
    header[100] = 2;
    header[104] = 6 | COMPRESSED;
    header[105] = ROW as u8;
    header[247..255].copy_from_slice(&((SIDE * SIDE) as u64).to_le_bytes());
    (0..3).for_each(|k| header[131 + 8 * k..139 + 8 * k].copy_from_slice(&1f64.to_le_bytes()));
    [header, records(&info), points, first, last].concat()
}

/// Returns the number and the place of each point that is read, and the levels.
fn read(bytes: &[u8], wanted: Wanted) -> Result<(Vec<usize>, Vec<DVec3>, Option<Levels>)> {
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(bytes).unwrap();
    let table = table(bytes, bytes.len() as u64).unwrap();
    let (mut numbers, mut places) = (Vec::new(), Vec::new());
    let levels = table.packed.unwrap().unpack_wanted(&file, &wanted, &mut |number, row| {
        numbers.push(number);
        places.push(table.rows.look(row).position);
        Ok(())
    })?;
    Ok((numbers, places, levels))
}

#[test]
fn coarse_levels_suffice_for_few_points() {
    let bytes = copc();
    let all = parse(&bytes).unwrap().mesh.positions;
    let (numbers, places, levels) = read(&bytes, Wanted { points: Some(16), within: None }).unwrap();
    assert_eq!(levels, Some(Levels { read: 1, all: 3, points: 64 }));
    assert!(places.iter().all(|p| p.x % 4.0 == 0.0 && p.y % 4.0 == 0.0));
    assert!(numbers.iter().zip(&places).all(|(&number, place)| all[number] == *place));
    let most = |points| read(&bytes, Wanted { points: Some(points), within: None }).unwrap();
    assert_eq!(most(17).2, Some(Levels { read: 2, all: 3, points: 256 }));
    let (numbers, places, levels) = most(1000);
    assert_eq!(levels, Some(Levels { read: 3, all: 3, points: 1024 }));
    assert!(numbers == (0..1024).collect::<Vec<usize>>() && places == all);
}

#[test]
fn of_a_box_only_the_nodes_are_read_that_it_meets() {
    let bytes = copc();
    let all = parse(&bytes).unwrap().mesh.positions;
    let within = Aabb { lo: DVec3::new(1.0, 2.0, -1.0), hi: DVec3::new(6.5, 5.0, 40.0) };
    let (numbers, places, levels) = read(&bytes, Wanted { points: None, within: Some(within) }).unwrap();
    assert!(numbers.is_sorted() && numbers.iter().zip(&places).all(|(&number, place)| all[number] == *place));
    let inside = |places: &[DVec3]| places.iter().filter(|p| within.contains(**p)).count();
    assert_eq!((inside(&places), inside(&all)), (24, 24));
    // The root, a quarter of the middle level, and one or two nodes of the last one.
    assert!(places.len() < 64 + 48 + 2 * 48 + 1 && levels.is_some_and(|levels| levels.read == 3), "{}", places.len());
    let few = read(&bytes, Wanted { points: Some(1), within: Some(within) }).unwrap();
    assert!(few.2.is_some_and(|levels| levels.read < 3));
}

#[test]
fn a_damaged_octree_is_no_octree_or_an_error() {
    let good = copc();
    let wanted = Wanted { points: Some(16), within: None };
    let start = u32_at(&good, 96).unwrap() as usize;
    let pages = u64::from_le_bytes(*good[INFO as usize + 40..].first_chunk().unwrap()) as usize;
    for at in (RECORD as usize..start).chain(pages..good.len()).step_by(3) {
        for value in [0, 0xFF] {
            let mut bytes = good.clone();
            bytes[at] = value;
            let _ = read(&bytes, wanted);
        }
    }
    let mut bytes = good.clone();
    bytes[pages + 28] += 1;
    let (numbers, _, levels) = read(&bytes, wanted).unwrap();
    assert!(numbers.len() == 1024 && levels.is_none(), "more points in the octree than in the file");
    let mut bytes = good.clone();
    bytes[pages + 16] += 1;
    let (numbers, _, levels) = read(&bytes, wanted).unwrap();
    assert!(numbers.len() == 1024 && levels.is_none(), "other chunks than the file has");
    // The page of the last level refers to the first page.
    let last = good[pages..].chunks_exact(ENTRY).position(|entry| entry[28..] == PAGE.to_le_bytes()).unwrap();
    let mut bytes = good.clone();
    bytes[pages + ENTRY * last + 16..][..8].copy_from_slice(&(pages as u64).to_le_bytes());
    assert!(read(&bytes, wanted).unwrap().2.is_none());
    // A chunk with another number of points than its node.
    let mut bytes = good;
    let chunk = start + 8;
    bytes[chunk + ROW] -= 1;
    assert!(read(&bytes, wanted).unwrap_err().to_string().contains("another number of points"));
}
