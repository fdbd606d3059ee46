//! The octree of a COPC file, which is a LAZ file whose chunks are the nodes of an octree: a node has some of the points in
//! its cube, evenly spread, and its children have points between them. So a part of the points, in a box or to a level, can
//! be read without the rest.
//!
//! Source: COPC 1.0, <https://copc.io>.
//!
//! An octree that does not fit the rest of the file is ignored, such as after a program that does not know COPC has
//! compressed the points again: the file is still a LAZ file.

use super::header::Header;
use super::window::Window;
use crate::geom::aabb::Aabb;
use crate::prepare::thin::{Levels, Wanted};
use glam::{DVec3, IVec3};
use std::io::{Read, Seek};
use std::ops::Range;

/// Offset of the first record, which describes the octree, and the name of whom it is from.
pub(super) const RECORD: u64 = 375;
pub(super) const USER: &[u8] = b"copc\0";
const USER_AT: u64 = RECORD + 2;
pub(super) const INFO: u64 = RECORD + 54;

/// Size of an entry of the hierarchy, in bytes, and its number of points if it is a page of further entries.
pub(super) const ENTRY: usize = 32;
pub(super) const PAGE: i32 = -1;

/// Maximum number of levels: more cannot differ in the place of a node, which has 32 bits.
const MOST_LEVELS: usize = 32;

/// The levels that are read have this many times as many points as are wanted, so that they can be thinned evenly.
const ROOM: f64 = 4.0;

/// A node of the octree, with points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// Its level, 0 for the root.
    level: usize,
    cube: Aabb,
    /// Offset of its chunk, and size of the chunk, in bytes.
    pub at: u64,
    pub size: usize,
    /// Number of its first point in the file, and how many points it has.
    pub first: usize,
    pub points: usize,
}

/// Returns the nodes in the order of the file, whose `chunks` are in this range of bytes; `None` if the file has no octree with
/// exactly these chunks and all of its points.
pub(super) fn nodes<R: Read + Seek>(file: &mut Window<R>, header: &Header, chunks: Range<u64>) -> Option<Vec<Node>> {
    if file.at(USER_AT, USER.len())? != USER {
        return None;
    }
    let mut number = |k: u64| file.array(INFO + 8 * k);
    let mut real = |k| number(k).map(f64::from_le_bytes);
    let (centre, half) = (DVec3::new(real(0)?, real(1)?, real(2)?), real(3)?);
    if !(half > 0.0 && half.is_finite() && centre.is_finite()) {
        return None;
    }
    let root = Aabb { lo: centre - half, hi: centre + half };
    let (at, size) = (number(5).map(u64::from_le_bytes)?, number(6).map(u64::from_le_bytes)?);
    let mut nodes = entries(file, (at, size), root)?;
    nodes.sort_unstable_by_key(|node| node.at);
    let (mut at, mut first) = (chunks.start, 0);
    for node in &mut nodes {
        if node.at != at {
            return None;
        }
        node.first = first;
        at += node.size as u64;
        first += node.points;
    }
    (at == chunks.end && first == header.count).then_some(nodes)
}

/// Returns the nodes with points in the page of the hierarchy with this offset and size, and in the pages below it.
fn entries<R: Read + Seek>(file: &mut Window<R>, page: (u64, u64), root: Aabb) -> Option<Vec<Node>> {
    let (mut pages, mut nodes) = (vec![page], Vec::new());
    // Pages do not overlap, so they are no larger than the file; damaged ones may refer to each other.
    let mut left = file.end;
    while let Some((at, size)) = pages.pop() {
        left = left.checked_sub(size.max(1))?;
        for entry in file.at(at, usize::try_from(size).ok()?)?.chunks_exact(ENTRY) {
            let whole = |k: usize| entry[k..].first_chunk().map_or(0, |bytes| i32::from_le_bytes(*bytes));
            let at = entry[16..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
            let size = usize::try_from(whole(24)).ok()?;
            match whole(28) {
                PAGE => pages.push((at, size as u64)),
                0 => {}
                points => {
                    let level = usize::try_from(whole(0)).ok().filter(|&level| level < MOST_LEVELS)?;
                    let place = IVec3::new(whole(4), whole(8), whole(12)).as_dvec3();
                    let width = root.size() / (1u64 << level) as f64;
                    let lo = root.lo + width * place;
                    let points = usize::try_from(points).ok()?;
                    nodes.push(Node { level, cube: Aabb { lo, hi: lo + width }, at, size, first: 0, points });
                }
            }
        }
    }
    Some(nodes)
}

/// Returns the nodes in which wanted points may be, and their levels.
pub(super) fn chosen(mut nodes: Vec<Node>, wanted: &Wanted, header: &Header) -> (Vec<Node>, Levels) {
    let share = |cube: &Aabb| {
        let Some(within) = wanted.within else { return 1.0 };
        let common = (cube.hi.min(within.hi) - cube.lo.max(within.lo)).max(DVec3::ZERO);
        (common / cube.size()).element_product()
    };
    if let Some(within) = wanted.within {
        // Points are rounded to multiples of the scale.
        let grown = Aabb { lo: within.lo - header.scale.abs(), hi: within.hi + header.scale.abs() };
        nodes.retain(|node| node.cube.meets(&grown));
    }
    let all = nodes.iter().map(|node| node.level + 1).max().unwrap_or(0);
    let mut counts = vec![0.0; all];
    nodes.iter().for_each(|node| counts[node.level] += share(&node.cube) * node.points as f64);
    let enough = ROOM * wanted.points.map_or(f64::INFINITY, |most| most as f64);
    let mut found = 0.0;
    let reaches = |count: &f64| {
        found += count;
        found >= enough
    };
    let read = counts.iter().position(reaches).map_or(all, |level| level + 1);
    nodes.retain(|node| node.level < read);
    let points = nodes.iter().map(|node| node.points).sum();
    (nodes, Levels { read, all, points })
}
