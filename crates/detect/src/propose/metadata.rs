//! Metadata that Ultralytics' exporter writes into an ONNX file beside the network: `names`, `imgsz`, `task`, `license`. Source: the
//! Ultralytics documentation of its export mode.

use ort::session::Session;

/// The entries that a manifest can use; each absent where the file has none.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Metadata {
    /// Labels in the order of their numbers.
    pub names: Option<Vec<String>>,
    /// Width, height.
    pub size_px: Option<[u32; 2]>,
    /// `detect`, `segment`, `pose`, …
    pub task: Option<String>,
    pub licence: Option<String>,
    /// Width and height of the anchors of each grid, in the order of the strides, as `[[[10, 14], [23, 27]], [[81, 82], [135, 169]]]`.
    pub anchors: Option<Vec<Vec<[f32; 2]>>>,
}

impl Metadata {
    pub(super) fn from_session(session: &Session) -> Metadata {
        let Ok(metadata) = session.metadata() else {
            return Metadata::default();
        };
        let entry = |key: &str| metadata.custom(key).filter(|v| !v.trim().is_empty());
        Metadata {
            names: entry("names").and_then(|text| python_names(&text)),
            size_px: entry("imgsz").and_then(|text| height_and_width(&text)),
            task: entry("task"),
            licence: entry("license"),
            anchors: entry("anchors").and_then(|text| serde_json::from_str(&text).ok()),
        }
    }
}

/// Width and height from `[480, 640]`, which has the height first.
pub fn height_and_width(text: &str) -> Option<[u32; 2]> {
    match serde_json::from_str::<Vec<u32>>(text).ok()?[..] {
        [height, width] => Some([width, height]),
        _ => None,
    }
}

/// The strings of a Python dictionary of numbers and strings, `{0: 'person', 1: "driver's seat"}`, numbered from 0 without gaps.
pub fn python_names(text: &str) -> Option<Vec<String>> {
    let mut rest = text.trim().strip_prefix('{')?.trim_start();
    let mut names = Vec::new();
    while let Some((number, after)) = rest.split_once(':') {
        if number.trim().trim_matches(['\'', '"']).parse() != Ok(names.len()) {
            return None;
        }
        let (name, after) = quoted(after.trim_start())?;
        names.push(name);
        rest = after.trim_start().trim_start_matches(',').trim_start();
    }
    (rest == "}" && !names.is_empty()).then_some(names)
}

/// A string in single or double quotes, with backslash escapes of quotes and backslashes; and what follows it.
fn quoted(text: &str) -> Option<(String, &str)> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    let mut name = String::new();
    let mut characters = text.char_indices().skip(1);
    while let Some((i, c)) = characters.next() {
        match c {
            '\\' => name.push(characters.next()?.1),
            c if c == quote => return Some((name, &text[i + 1..])),
            c => name.push(c),
        }
    }
    None
}
