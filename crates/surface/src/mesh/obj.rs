//! Wavefront OBJ: polygons with the materials that `usemtl` names, whose images stand in the library beside the file.

use std::collections::HashMap;
use std::str::SplitWhitespace;

use nalgebra::Point3;

use super::image::{ImageSource, Look};
use super::mtl::{self, Map};
use super::soup::{Corner, Soup, Trouble};
use super::text::{joined, lines};
use scaleproof_core::files;

/// Name of the material of faces before the first `usemtl`.
const NO_MATERIAL: &str = "none";
/// Size of the largest library: text of some lines a material.
const MOST_LIBRARY_BYTES: u64 = 16 << 20;

/// A corner of a face: its place and its texture coordinates, counted from 1.
type Indices = (i64, Option<i64>);

/// A polygon, the line that it stands on, and its material.
type Face<'a> = (Vec<Indices>, usize, &'a str);

/// Parsed lines of the file.
#[derive(Default)]
struct Lines<'a> {
    points: Vec<Point3<f64>>,
    coordinates: Vec<[f64; 2]>,
    faces: Vec<Face<'a>>,
    libraries: Vec<&'a str>,
}

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let text = String::from_utf8_lossy(bytes);
    let text = joined(&text);
    let file = Lines::parse(&text)?;
    let library = Library::read(&file.libraries, soup);
    // Most faces have the material of the one before.
    let mut current: Option<(&str, usize)> = None;
    for (face, line, name) in &file.faces {
        let map = library.maps.get(*name);
        let known = current.filter(|(known, _)| known == name).map(|(_, material)| material);
        let material = known.unwrap_or_else(|| soup.material(name, library.look(name)));
        current = Some((name, material));
        let placed = |(place, coordinates): &Indices| -> Result<Corner, Trouble> {
            let stored = coordinates.and_then(|i| numbered(&file.coordinates, i));
            let placed = stored.map(|uv| map.map_or(uv, |map| map.place(uv)));
            let count = file.points.len();
            let missing =
                || format!("the face on line {line} names corner {place}, and corners count from 1 to {count}");
            let point = numbered(&file.points, *place).ok_or_else(|| Trouble::Damaged(missing()))?;
            Ok((point, placed))
        };
        let corners: Result<Vec<_>, _> = face.iter().map(placed).collect();
        soup.face(&corners?, material, "on line", *line)?;
    }
    Ok(())
}

impl<'a> Lines<'a> {
    fn parse(text: &'a str) -> Result<Self, Trouble> {
        let mut file = Self::default();
        let mut material = NO_MATERIAL;
        for (i, line) in lines(text).enumerate() {
            let not_understood =
                |what: &str| Trouble::Damaged(format!("the {what} on line {} is not understood", i + 1));
            let line = line.trim();
            let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            match word.to_ascii_lowercase().as_str() {
                "v" => file.points.push(point(rest).ok_or_else(|| not_understood("vertex"))?),
                "vt" => file.coordinates.push(coordinates(rest)),
                "f" | "fo" => {
                    let counts = [file.points.len(), file.coordinates.len()];
                    let face: Option<Vec<_>> = rest.split_whitespace().map(|word| indices(word, counts)).collect();
                    let face = face.ok_or_else(|| not_understood("face"))?;
                    file.faces.push((face, i + 1, material));
                }
                "usemtl" => material = rest.trim(),
                "mtllib" => file.libraries.push(rest.trim()),
                "surf" => return Err(Trouble::damaged("it has free-form surfaces: export polygons")),
                _ => {}
            }
        }
        Ok(file)
    }
}

/// Parses three numbers of 32 bits; a fourth one alone divides them, and colours may follow instead.
fn point(text: &str) -> Option<Point3<f64>> {
    let mut words = text.split_whitespace();
    let number = |words: &mut SplitWhitespace| words.next()?.parse::<f32>().ok();
    let [x, y, z] = [number(&mut words)?, number(&mut words)?, number(&mut words)?];
    let rest: Vec<&str> = words.collect();
    let divisor = match rest[..] {
        [w] => w.parse().ok().filter(|w| *w != 0.0)?,
        _ => 1.0,
    };
    Some(Point3::new(x / divisor, y / divisor, z / divisor).map(f64::from))
}

/// Parses texture coordinates. A word that is no number becomes NaN: it is refused when a texture is laid on, and positions alone are whole.
fn coordinates(text: &str) -> [f64; 2] {
    let mut words = text.split_whitespace();
    let [u, v] = [words.next(), words.next().or(Some("0"))];
    [u, v].map(|word| word.and_then(|w| w.parse().ok()).unwrap_or(f64::NAN))
}

/// Parses `place/coordinates/normal`, of which the place alone is required. Numbers count from 1, or back from the line before.
fn indices(word: &str, [points, coordinates]: [usize; 2]) -> Option<Indices> {
    let mut parts = word.split('/');
    let index = |part: &str, count: usize| match part.parse::<i64>().ok()? {
        number @ 0.. => Some(number),
        number => number.checked_add(count as i64 + 1).filter(|number| *number > 0),
    };
    let place = index(parts.next()?, points)?;
    let coordinates = match parts.next() {
        None | Some("") => None,
        // One before the first is no coordinate, as number 0 is.
        Some(part) => Some(index(part, coordinates).or_else(|| part.parse::<i64>().is_ok().then_some(0))?),
    };
    Some((place, coordinates))
}

/// Returns the element with a number that counts from 1.
fn numbered<T: Copy>(elements: &[T], number: i64) -> Option<T> {
    elements.get(usize::try_from(number.checked_sub(1)?).ok()?).copied()
}

/// Contents of the material libraries.
#[derive(Default)]
struct Library {
    maps: HashMap<String, Map>,
    /// First line that names a library which cannot be read.
    unread: Option<String>,
}

impl Library {
    /// Reads libraries in the mesh's own folder only; without one the mesh has its places and names still.
    fn read(lines: &[&str], soup: &Soup) -> Self {
        let mut library = Self::default();
        for line in lines {
            for name in names(line, soup) {
                let read = match ImageSource::beside(&soup.folder, name) {
                    ImageSource::File(path) => files::read_at_most(&path, MOST_LIBRARY_BYTES).ok(),
                    _ => None,
                };
                match read {
                    Some(bytes) => library
                        .maps
                        .extend(mtl::maps(&String::from_utf8_lossy(&bytes), &soup.folder)),
                    None => _ = library.unread.get_or_insert_with(|| (*line).to_owned()),
                }
            }
        }
        library
    }

    fn look(&self, material: &str) -> Option<Look> {
        match (self.maps.get(material), &self.unread) {
            (Some(map), _) => Some(map.look.clone()),
            (None, Some(name)) => Some(Look::plain(ImageSource::Refused(format!(
                "its material library '{name}' is not a file beside the mesh"
            )))),
            (None, None) => None,
        }
    }
}

/// Returns the files that a line names: one with blanks, or several.
fn names<'a>(line: &'a str, soup: &Soup) -> Vec<&'a str> {
    if soup.folder.join(line).is_file() {
        vec![line]
    } else {
        line.split_whitespace().collect()
    }
}
