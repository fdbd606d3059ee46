//! Counts in words.

/// `count` of something: `one` in words, or `many`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Those counts that are not zero, each with its word for one and for many.
pub fn counts(counts: &[(usize, &str, &str)]) -> Vec<String> {
    counts.iter().filter(|c| c.0 > 0).map(|&(count, one, many)| counted(count, one, many)).collect()
}
