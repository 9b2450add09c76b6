//! Definitions of the words of a comparison.

/// Returns (name, definition) of each word of a comparison; they are stored beside its numbers.
pub fn comparison_definitions() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = include_str!("definitions.txt").lines();
    lines.filter_map(|line| line.split_once(" | "))
}
