//! Lists of different lengths in one array (compressed sparse rows).

/// Rows of values, stored one after the other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Csr<T> {
    /// Start of each row in `values`; has one more entry than there are rows.
    start: Vec<u32>,
    values: Vec<T>,
}

impl<T: Copy> Csr<T> {
    /// Builds the rows by a counting sort of `entries`, pairs of a row below `rows` and a value. Values keep the order of
    /// the entries within each row. `entries` is called several times and must return the same entries each time.
    pub fn new<I: Iterator<Item = (u32, T)>>(rows: usize, entries: impl Fn() -> I) -> Csr<T> {
        let mut start = vec![0u32; rows + 1];
        entries().for_each(|(row, _)| start[row as usize + 1] += 1);
        for row in 0..rows {
            start[row + 1] += start[row];
        }
        let Some((_, any)) = entries().next() else { return Csr { start, values: Vec::new() } };
        let mut values = vec![any; start[rows] as usize];
        let mut free = start.clone();
        for (row, value) in entries() {
            let at = &mut free[row as usize];
            values[*at as usize] = value;
            *at += 1;
        }
        Csr { start, values }
    }

    /// The values of a row.
    #[inline]
    pub fn row(&self, row: u32) -> &[T] {
        &self.values[self.start[row as usize] as usize..self.start[row as usize + 1] as usize]
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// The number of values in all rows.
    pub fn len(&self) -> usize {
        self.values.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_the_order_of_their_entries() {
        let entries = [(2, 'a'), (0, 'b'), (2, 'c'), (0, 'd')];
        let csr = Csr::new(4, || entries.into_iter());
        assert_eq!([0, 1, 2, 3].map(|row| csr.row(row).to_vec()), [vec!['b', 'd'], vec![], vec!['a', 'c'], vec![]]);
        assert_eq!(csr.len(), 4);
        assert!(Csr::<u32>::new(2, std::iter::empty).row(1).is_empty());
    }
}
