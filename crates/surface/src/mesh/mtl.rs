//! The material library of a Wavefront OBJ: the image of each material (`map_Kd`).

use std::collections::HashMap;
use std::path::Path;

use super::image::{ImageSource, Look, Wrap};
use super::text::{joined, lines};

/// Options of a map that take one word each; of `-mm` two.
const ONE_WORD: [&str; 9] = [
    "-blendu", "-blendv", "-bm", "-boost", "-cc", "-clamp", "-imfchan", "-texres", "-type",
];

/// The image of a material, and where coordinates lie in it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map {
    pub look: Look,
    scale: [f64; 2],
    offset: [f64; 2],
}

impl Map {
    /// Returns the place of a coordinate of the mesh in the image.
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.scale[0] * u + self.offset[0], self.scale[1] * v + self.offset[1]]
    }

    /// Parses the text after `map_Kd`: options, then the file's name, blanks included.
    fn parse(text: &str, folder: &Path) -> Self {
        let (mut scale, mut offset, mut wrap) = ([1.0; 2], [0.0; 2], Wrap::Repeat);
        let mut rest = text.trim();
        while rest.starts_with('-') {
            let (option, after) = first_word(rest);
            rest = after;
            match option {
                "-o" => pair(&mut rest, &mut offset),
                "-s" => pair(&mut rest, &mut scale),
                "-t" => pair(&mut rest, &mut [0.0; 2]),
                "-mm" => rest = first_word(first_word(rest).1).1,
                "-clamp" => {
                    let (value, after) = first_word(rest);
                    if value == "on" {
                        wrap = Wrap::ClampToEdge;
                    }
                    rest = after;
                }
                _ if ONE_WORD.contains(&option) => rest = first_word(rest).1,
                // A file's name may begin with a dash.
                _ => {
                    rest = &text[text.len() - after.len() - option.len()..];
                    break;
                }
            }
        }
        Self {
            look: Look {
                wrap: [wrap; 2],
                ..Look::plain(ImageSource::beside(folder, rest.trim()))
            },
            scale,
            offset,
        }
    }
}

fn first_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Parses up to three numbers, of which the third is a depth that images do not have.
fn pair(rest: &mut &str, numbers: &mut [f64; 2]) {
    for i in 0..3 {
        let (word, after) = first_word(rest);
        let Ok(number) = word.parse() else { return };
        if let Some(place) = numbers.get_mut(i) {
            *place = number;
        }
        *rest = after;
    }
}

/// Returns the maps of the materials of a library; the last of a name counts.
pub(super) fn maps(text: &str, folder: &Path) -> HashMap<String, Map> {
    let mut maps = HashMap::new();
    let mut name = None;
    for line in lines(&joined(text)) {
        match first_word(line) {
            (word, rest) if word.eq_ignore_ascii_case("newmtl") => name = Some(rest.trim().to_owned()),
            (word, rest) if word.eq_ignore_ascii_case("map_Kd") => {
                if let Some(name) = &name {
                    maps.insert(name.clone(), Map::parse(rest, folder));
                }
            }
            _ => {}
        }
    }
    maps
}
