//! Compressed points, from memory or from a file.
//!
//! Cost: one pass, in which the crate `laz` holds at most one chunk, some 50,000 points; of COPC, only the wanted nodes are
//! read, some at a time, on all threads. Sizes for which the crate would reserve memory are first compared with the size of
//! the file.

use super::copc::{self, Node};
use super::header::{HEADERS, Header};
use super::window::Window;
use crate::base::error::{Place, Result};
use crate::base::parallel;
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use crate::prepare::thin::{Levels, Wanted};
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor};
use laz::{LasZipDecompressor, LazItem, LazVlr};
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Maximum number of points per byte of a compressed file: real points take more than a byte each.
const MOST_PER_BYTE: u64 = 16;

/// Whether compressed points can be read at all.
#[cfg(feature = "fs")]
pub(super) const CAN_UNPACK: bool = true;

/// Number of bytes before the first chunk, and size of the number of points before a chunk's layers.
const BEFORE_CHUNKS: u64 = 8;
const COUNT: usize = 4;

/// Number of nodes of an octree that are read together.
const BATCH: usize = 16;

const TOO_LONG: &str = "a chunk of points is longer than the file";

/// Passes points of a LAZ file to `show`: the number of each, in ascending order, and a row of bytes as in LAS. Of COPC, only
/// nodes are read in which wanted points may be, and the levels that were read are returned.
///
/// # Errors
/// Those of `show`; an error with the place of the damage.
pub(super) fn unpack<R: Read + Seek + Send + Sync>(
    mut source: R,
    header: &Header,
    wanted: &Wanted,
    show: &mut dyn FnMut(usize, &[u8]) -> Result<()>,
) -> Result<Option<Levels>> {
    let damaged = |cause: String| malformed(Place::Byte(header.start), cause, CUT_SHORT);
    let end = source.seek(SeekFrom::End(0)).map_err(|e| damaged(e.to_string()))?;
    let mut bytes = Window::of(source, end);
    if header.count as u64 / MOST_PER_BYTE > end || !bytes.has_sound_chunks(header.start as u64) {
        return Err(damaged(format!(
            "the header declares {} points, more than a file of this size can hold",
            header.count
        )));
    }
    let Some(record) = bytes.record_of_laszip() else {
        return Err(malformed(
            Place::Byte(HEADERS[0]),
            "the record that describes the compression is missing",
            EXPORT_AGAIN,
        ));
    };
    let start = header.start as u64;
    let chunks = bytes.table_of_chunks(start).map(|end| start + BEFORE_CHUNKS..end);
    let nodes = chunks.and_then(|chunks| copc::nodes(&mut bytes, header, chunks));
    let chosen = nodes.map(|nodes| copc::chosen(nodes, wanted, header));
    let mut refused = Ok(());
    let mut shown = |number: usize, row: &[u8]| {
        refused = show(number, row);
        refused.is_ok()
    };
    // The crate assumes that the data was compressed by a correct program.
    let unpacked = catch_unwind(AssertUnwindSafe(|| match &chosen {
        Some((nodes, _)) => bytes.unpack_nodes(nodes, header, &record, &mut shown),
        None => bytes.unpack(header, &record, &mut shown),
    }));
    refused?;
    match unpacked {
        Ok(Ok(())) => Ok(chosen.map(|(_, levels)| levels)),
        Ok(Err(cause)) => Err(damaged(format!("the compressed points cannot be read: {cause}"))),
        Err(_) => Err(damaged("the compressed points are damaged".into())),
    }
}

impl<R: Read + Seek> Window<R> {
    /// Passes all points to `show` until it returns false.
    fn unpack(
        mut self,
        header: &Header,
        record: &[u8],
        show: &mut dyn FnMut(usize, &[u8]) -> bool,
    ) -> std::result::Result<(), String>
    where
        R: Send + Sync,
    {
        let (record, layers) = compression(record, header)?;
        let start = header.start as u64;
        let end_of_chunks = self.table_of_chunks(start).filter(|end| (start..self.end).contains(end));
        let end_of_chunks = end_of_chunks.unwrap_or(self.end);
        if layers > 0 && !self.has_sound_layers(start + BEFORE_CHUNKS..end_of_chunks, header, layers) {
            return Err(TOO_LONG.into());
        }
        self.seek(SeekFrom::Start(start)).map_err(|e| e.to_string())?;
        let mut points = LasZipDecompressor::new(self, record).map_err(|e| e.to_string())?;
        if layers > 0 {
            // Ensures that nothing after the checked range is taken for a chunk.
            points.get_mut().end = end_of_chunks;
        }
        let mut row = vec![0; header.length];
        for number in 0..header.count {
            points.decompress_one(&mut row).map_err(|e| e.to_string())?;
            if !show(number, &row) {
                break;
            }
        }
        Ok(())
    }

    /// Passes the points of some nodes to `show` until it returns false.
    fn unpack_nodes(
        mut self,
        nodes: &[Node],
        header: &Header,
        record: &[u8],
        show: &mut dyn FnMut(usize, &[u8]) -> bool,
    ) -> std::result::Result<(), String> {
        let (record, layers) = compression(record, header)?;
        for nodes in nodes.chunks(BATCH) {
            let read = |node: &Node| self.at(node.at, node.size).ok_or(TOO_LONG);
            let chunks: Vec<Vec<u8>> = nodes.iter().map(read).collect::<std::result::Result<_, _>>()?;
            let unpacked = parallel::each(chunks.into_iter().zip(nodes), |(chunk, node)| {
                let points = unpacked(chunk, header, &record, layers)?;
                let is_whole = points.len() == header.length * node.points;
                if is_whole { Ok(points) } else { Err("a node of the octree has another number of points".to_owned()) }
            });
            for (points, node) in unpacked.into_iter().zip(nodes) {
                for (row, number) in points?.chunks_exact(header.length).zip(node.first..) {
                    if !show(number, row) {
                        return Ok(());
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether all layers of the chunks in this range, for which the crate reserves memory at once, end before the last chunk
    /// does. A chunk consists of a point, the number of points, the sizes of the layers in 32 bits, and the layers.
    fn has_sound_layers(&mut self, chunks: Range<u64>, header: &Header, layers: usize) -> bool {
        let Range { start: mut at, end } = chunks;
        let before = (header.length + COUNT) as u64;
        let whole = std::mem::replace(&mut self.end, end);
        let mut is_sound = true;
        // A chunk that ends before its layers is detected by the crate.
        while let Some(sizes) = self.at(at + before, 4 * layers).filter(|_| is_sound) {
            let size = |bytes: &[u8]| bytes.try_into().map_or(0, u32::from_le_bytes);
            let size: u64 = sizes.chunks_exact(4).map(|bytes| u64::from(size(bytes))).sum();
            at += before + 4 * layers as u64;
            is_sound = size <= end - at;
            at += size;
        }
        self.end = whole;
        is_sound
    }

    /// Returns the offset of the chunk table, at which the points end.
    fn table_of_chunks(&mut self, start: u64) -> Option<u64> {
        let table = match self.array(start).map(i64::from_le_bytes) {
            Some(-1) => self.end.checked_sub(8).and_then(|at| self.array(at)).map(i64::from_le_bytes),
            table => table,
        };
        table.and_then(|at| at.try_into().ok())
    }

    /// Whether the chunk table, for which the crate reserves memory at once, has no more chunks than the file has bytes.
    fn has_sound_chunks(&mut self, start: u64) -> bool {
        let table = self.table_of_chunks(start).and_then(|at| at.checked_add(4));
        let chunks = table.and_then(|at| self.array(at)).map(u32::from_le_bytes);
        chunks.is_none_or(|chunks| u64::from(chunks) <= self.end)
    }

    /// Returns the record that describes the compression of points.
    fn record_of_laszip(&mut self) -> Option<Vec<u8>> {
        const RECORD_HEADER: usize = 54;
        let mut at = u64::from(u16::from_le_bytes(self.array(94)?));
        for _ in 0..u32::from_le_bytes(self.array(100)?) {
            let header = self.at(at, RECORD_HEADER)?;
            let short = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
            let data = self.at(at + RECORD_HEADER as u64, usize::from(short(20)))?;
            if short(18) == LazVlr::RECORD_ID && header[2..].starts_with(LazVlr::USER_ID.as_bytes()) {
                return Some(data);
            }
            at += (RECORD_HEADER + data.len()) as u64;
        }
        None
    }
}

/// Returns how points are compressed, and in how many layers.
fn compression(record: &[u8], header: &Header) -> std::result::Result<(LazVlr, usize), String> {
    let record = LazVlr::from_buffer(record).map_err(|e| e.to_string())?;
    let sizes: usize = record.items().iter().map(|item| usize::from(item.size())).sum();
    if sizes != header.length {
        return Err(format!("points of {sizes} bytes instead of {}", header.length));
    }
    let layers = record.items().iter().map(layers_of).sum();
    Ok((record, layers))
}

/// Returns the points of a chunk, as rows.
fn unpacked(chunk: Vec<u8>, header: &Header, record: &LazVlr, layers: usize) -> std::result::Result<Vec<u8>, String> {
    let end = chunk.len() as u64;
    let mut chunk = Window::of(Cursor::new(chunk), end);
    let count = chunk.array(header.length as u64).map_or(0, u32::from_le_bytes);
    if layers == 0 || !chunk.has_sound_layers(0..end, header, layers) || u64::from(count) / MOST_PER_BYTE > end {
        return Err(TOO_LONG.into());
    }
    chunk.seek(SeekFrom::Start(0)).map_err(|e| e.to_string())?;
    let mut points = LayeredPointRecordDecompressor::new(chunk);
    points.set_fields_from(record.items()).map_err(|e| e.to_string())?;
    let mut rows = vec![0; header.length * count as usize];
    points.decompress_many(&mut rows).map_err(|e| e.to_string())?;
    Ok(rows)
}

/// Returns the number of layers per chunk for a part of a point; zero in layouts below 6.
fn layers_of(item: &LazItem) -> usize {
    use laz::LazItemType::{Byte14, Point14, RGB14, RGBNIR14, WavePacket14};
    match item.item_type() {
        Point14 => 9,
        RGB14 | WavePacket14 => 1,
        RGBNIR14 => 2,
        Byte14(count) => count.into(),
        _ => 0,
    }
}
