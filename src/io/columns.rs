//! Extra numbers after the coordinates of vertices: how many there are, and what three in a row mean.

use super::text::{Words, number};
use crate::mesh::attributes::{Attribute, COLOR, NORMAL, Scalar};

/// Maximum deviation of a normal's length from one: files have at least three digits.
const UNIT: f64 = 0.01;

/// Minimum share of rows of unit length (or zero) for a column triple to be taken as normals.
const MOST: f64 = 0.95;

/// Numbers that follow the required ones of every vertex. They are kept only if all vertices have equally many.
#[derive(Default)]
pub(super) struct Columns {
    /// Numbers per vertex, once the first has been read.
    width: Option<usize>,
    values: Vec<f64>,
    /// Whether the vertices differ in their number of values, or have words that are not finite numbers.
    pub ragged: bool,
}

impl Columns {
    /// Reads the rest of a vertex's line, at most `most` numbers.
    #[inline]
    pub fn read_line(&mut self, words: &mut Words, most: usize) {
        let as_before = self.width == Some(0) && words.ends_here();
        if !as_before && !self.ragged {
            self.read_numbers(words, most);
        }
    }

    fn read_numbers(&mut self, words: &mut Words, most: usize) {
        let before = self.values.len();
        for _ in 0..most {
            let Some(word) = words.here() else { break };
            match number(word).filter(|x| x.is_finite()) {
                Some(x) => self.values.push(x),
                None => self.ragged = true,
            }
        }
        let found = self.values.len() - before;
        self.ragged |= *self.width.get_or_insert(found) != found;
        if self.ragged {
            self.values = Vec::new();
        }
    }

    /// Returns the numbers of all vertices, and how many each vertex has.
    pub fn into_table(self) -> (Vec<f64>, usize) {
        if self.ragged { (Vec::new(), 0) } else { (self.values, self.width.unwrap_or(0)) }
    }
}

/// Returns columns `from..to` of a table with rows of `width` numbers.
pub(super) fn cut(table: &[f64], width: usize, from: usize, to: usize) -> Vec<f64> {
    table.chunks_exact(width).flat_map(|row| &row[from..to]).copied().collect()
}

/// Returns `values` as colours of `components` numbers: as fractions if all are from 0 to 1, else as bytes or 16-bit numbers
/// if all are integers in range.
pub(super) fn color(values: Vec<f64>, components: usize) -> Option<Attribute> {
    let all = |is: fn(&f64) -> bool| values.iter().all(is);
    let scalar = match () {
        () if all(|x| (0.0..=1.0).contains(x)) => Scalar::F32,
        () if all(|x| (0.0..=255.0).contains(x) && x.fract() == 0.0) => Scalar::U8,
        () if all(|x| (0.0..=65535.0).contains(x) && x.fract() == 0.0) => Scalar::U16,
        () => return None,
    };
    Some(Attribute { name: COLOR.into(), components, values, scalar })
}

/// Returns `values` as normals, of three numbers each.
pub(super) fn normal(values: Vec<f64>) -> Attribute {
    Attribute { name: NORMAL.into(), components: 3, values, scalar: Scalar::F64 }
}

/// Whether nearly all vectors of three numbers have unit length or are zero, and at least one has unit length.
pub(super) fn are_unit(values: &[f64]) -> bool {
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = values.chunks_exact(3).filter(|v| (length(v) - 1.0).abs() < UNIT).count();
    let zero = values.chunks_exact(3).filter(|v| length(v) == 0.0).count();
    unit > 0 && (unit + zero) as f64 >= MOST * (values.len() / 3) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> (Vec<f64>, usize) {
        let mut columns = Columns::default();
        let mut words = Words::new(text.as_bytes());
        loop {
            columns.read_line(&mut words, 4);
            if !words.next_line() {
                return columns.into_table();
            }
        }
    }

    #[test]
    fn all_lines_have_as_many_numbers_or_none_is_kept() {
        assert_eq!(table("1 2\n3 4"), (vec![1.0, 2.0, 3.0, 4.0], 2));
        for ragged in ["1 2\n3", "1 2\n\n", "1 2\n3 4 5", "\n1 2", "1 2\n3 x", "1 nan\n2 3"] {
            assert_eq!(table(ragged), (vec![], 0), "{ragged}");
        }
        assert_eq!(table("1 2 3 4 5 6"), (vec![1.0, 2.0, 3.0, 4.0], 4));
    }

    #[test]
    fn colours_are_whole_numbers_or_fractions() {
        let scalar = |values: &[f64]| color(values.to_vec(), 3).map(|c| c.scalar);
        assert_eq!(scalar(&[0.0, 1.0, 0.5]), Some(Scalar::F32));
        assert_eq!(scalar(&[0.0, 1.0, 255.0]), Some(Scalar::U8));
        assert_eq!(scalar(&[0.0, 1.0, 256.0]), Some(Scalar::U16));
        for none in [[0.0, 1.5, 2.0], [0.0, -1.0, 2.0], [0.0, 0.0, 65536.0]] {
            assert_eq!(scalar(&none), None);
        }
    }

    #[test]
    fn normals_have_unit_length() {
        assert!(are_unit(&[0.6, 0.8, 0.0, 0.0, 0.0, 0.0]) && !are_unit(&[0.0; 6]) && !are_unit(&[1.0, 1.0, 0.0]));
    }
}
