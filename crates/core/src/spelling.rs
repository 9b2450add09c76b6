//! The known name that a misspelt one was probably meant to be; words that go with a number, and its digits.

/// Letters to insert, remove or change (Levenshtein), or neighbours to swap.
pub use strsim::osa_distance as edits;

/// `; did you mean NAME?`, to be added to a sentence that refuses `text`; empty when no known name is near, or several are.
pub fn hint<'a>(text: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(text, known).map_or_else(String::new, |name| format!("; did you mean {name}?"))
}

/// Formats a number of things: `1 photo`, `2 photos`.
pub fn count(number: usize, one: &str) -> String {
    format!("{number} {one}{}", choose(number, "", "s"))
}

/// Formats a number with `behind` decimal places, a five rounded away from zero as papers do; no minus before a zero.
pub fn digits(value: f64, behind: usize) -> String {
    let scale = 10_f64.powi(behind as i32);
    // What is a five to twelve digits is one: 100 · 0.0875 is not always 8.75.
    let scaled = value * scale;
    let rounded = (scaled + 1e-9 * scaled.signum()).round() / scale;
    format!("{:.behind$}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Ids one after the other: `1, 2, 3`.
pub fn list(ids: &[u32]) -> String {
    ids.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
}

/// Quotes a word for a shell.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._-/=+:,@%".contains(c);
    if word.chars().all(is_plain) && !word.is_empty() {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Returns the word for one thing, or that for several.
pub fn choose<'a>(number: usize, one: &'a str, several: &'a str) -> &'a str {
    if number == 1 { one } else { several }
}

/// Returns the only name that fewest edits make of `text`, no more than one for every three letters of it; else the only one that begins
/// with it. Upper and lower case are the same.
pub fn nearest<'a>(text: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let known: Vec<&str> = known.into_iter().collect();
    let text = text.to_lowercase();
    let length = text.chars().count();
    let distances = known.iter().map(|name| (edits(&text, &name.to_lowercase()), *name));
    let near: Vec<_> = distances.filter(|(edits, _)| 3 * edits <= length).collect();
    let least = near.iter().map(|(edits, _)| *edits).min();
    let begin = |name: &&str| length >= 3 && name.to_lowercase().starts_with(&text);
    let best: Vec<&str> = match least {
        Some(least) => near
            .iter()
            .filter(|(edits, _)| *edits == least)
            .map(|(_, name)| *name)
            .collect(),
        None => known.into_iter().filter(begin).collect(),
    };
    match best[..] {
        [name] => Some(name),
        _ => None,
    }
}
