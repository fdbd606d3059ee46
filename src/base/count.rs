//! Counts as words.

/// Returns `count` followed by its noun: `one` if it is 1, otherwise `many`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Returns the non-zero counts in words; each count comes with its singular and its plural noun.
pub fn counts(counts: &[(usize, &str, &str)]) -> Vec<String> {
    counts.iter().filter(|c| c.0 > 0).map(|&(count, one, many)| counted(count, one, many)).collect()
}
