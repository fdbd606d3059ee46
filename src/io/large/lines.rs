//! OBJ, read in blocks of whole lines.

use super::blocks::{Blocks, show_triangles};
use super::places::Places;
use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::io::content::Read;
use crate::io::line_blocks::in_blocks;
use crate::io::obj::{self, vertex_number};
use crate::io::opened::Opened;
use crate::io::text::Words;
use glam::DVec3;

/// Approximate number of bytes in a file per triangle: the line of a face, and half the line of a vertex.
const OF_TRIANGLE: u64 = 40;

/// A file of lines.
pub(super) struct Lines {
    pub file: Opened,
}

impl Lines {
    /// Passes all lines to `show`, by their keywords.
    fn read(&self, monitor: &dyn Monitor, show: &mut dyn FnMut(&[u8], &mut Words) -> Result<()>) -> Result<()> {
        self.file.seek(0)?;
        let fill = |bytes: &mut [u8]| check(monitor).and_then(|()| self.file.fill(bytes));
        in_blocks(self.file.length, fill, |bytes, line| {
            let mut words = Words::new(bytes).starting_at(line).with_comments().with_continued_lines();
            loop {
                if let Some(keyword) = words.here() {
                    show(keyword, &mut words).map_err(|error| self.file.locate(error))?;
                }
                if !words.next_line() {
                    return Ok(());
                }
            }
        })
    }
}

impl Blocks for Lines {
    fn faces(&self) -> u64 {
        self.file.length / OF_TRIANGLE
    }

    /// Only reading the whole file would tell.
    fn keeps_attributes(&self) -> bool {
        false
    }

    fn places(&mut self, monitor: &dyn Monitor) -> Result<Places> {
        let mut places = Places::with_capacity((self.faces() / 2) as usize);
        self.read(monitor, &mut |keyword, words| {
            if keyword == b"v" {
                let mut next = || words.coordinate(Words::here);
                places.push(DVec3::new(next()?, next()?, next()?));
            }
            Ok(())
        })?;
        Ok(places)
    }

    fn triangles(
        &mut self,
        places: &Places,
        monitor: &dyn Monitor,
        take: &mut dyn FnMut([u32; 3]) -> Result<()>,
    ) -> Result<()> {
        let mut known = 0;
        let mut corners = Vec::new();
        self.read(monitor, &mut |keyword, words| {
            match keyword {
                b"v" => known += 1,
                b"f" | b"fo" => {
                    corners.clear();
                    while let Some(corner) = words.here() {
                        let (number, _) = vertex_number(corner, known).map_err(|cause| words.mistake(cause))?;
                        if number > places.len() {
                            let cause = format!("a face uses vertex {number}, but the file has only {}", places.len());
                            return Err(words.mistake(cause));
                        }
                        corners.push(number as u32 - 1);
                    }
                    show_triangles(&corners, places, take)?;
                }
                _ => {}
            }
            Ok(())
        })
    }

    /// The vertices include their colours.
    fn vertices(&self, numbers: &[u32], _: &Places) -> Result<Read> {
        let mut text = Vec::new();
        let (mut wanted, mut known) = (numbers.iter().peekable(), 0);
        self.read(&(), &mut |keyword, words| {
            if keyword == b"v" {
                if wanted.next_if(|&&v| v == known).is_some() {
                    text.push(b'v');
                    while let Some(word) = words.here() {
                        text.push(b' ');
                        text.extend_from_slice(word);
                    }
                    text.push(b'\n');
                }
                known += 1;
            }
            Ok(())
        })?;
        obj::parse(&text).map_err(|error| self.file.locate(error))
    }
}
