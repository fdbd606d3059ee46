//! Counts in words.

/// `count` and the word for it: `one` if it is 1, else `many`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// The counts that are not zero, in words; each is given with its words for one and for many.
pub fn counts(counts: &[(usize, &str, &str)]) -> Vec<String> {
    counts.iter().filter(|c| c.0 > 0).map(|&(count, one, many)| counted(count, one, many)).collect()
}
