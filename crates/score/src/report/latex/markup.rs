//! Texts, numbers and rows in TeX.

use scaleproof_core::spelling::digits;

/// Returns a `tabular` of blocks of rows with a line between two of them; the first is the head.
pub(crate) fn tabular(columns: &str, blocks: impl IntoIterator<Item = Vec<String>>) -> String {
    let blocks: Vec<String> = blocks.into_iter().map(|rows| rows.concat()).collect();
    let rows = blocks.join("\\midrule\n");
    format!("\\begin{{tabular}}{{{columns}}}\n\\toprule\n{rows}\\bottomrule\n\\end{{tabular}}\n")
}

/// Returns a line of a `tabular`.
pub(crate) fn row<T: Into<String>>(cells: impl IntoIterator<Item = T>) -> String {
    let cells: Vec<String> = cells.into_iter().map(Into::into).collect();
    format!("{} \\\\\n", cells.join(" & "))
}

/// Formats a number with a true minus sign.
pub(crate) fn number(value: f64, behind: usize) -> String {
    let text = digits(value, behind);
    text.strip_prefix('-').map(|size| format!("$-{size}$")).unwrap_or(text)
}

/// Escapes text for TeX. A bracket or star that opens a row would be read as an argument of the `\\` before it.
pub fn escaped(text: &str) -> String {
    let mut tex = String::new();
    for c in text.chars() {
        match c {
            '\\' => tex += "\\textbackslash{}",
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => tex.extend(['\\', c]),
            '^' => tex += "\\textasciicircum{}",
            '~' => tex += "\\textasciitilde{}",
            '<' => tex += "\\textless{}",
            '>' => tex += "\\textgreater{}",
            '|' => tex += "\\textbar{}",
            '[' | '*' => tex.extend(['{', c, '}']),
            c if c.is_control() => tex.push(' '),
            c => tex.push(c),
        }
    }
    tex
}
