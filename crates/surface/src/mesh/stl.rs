//! STL, binary or text, of any number of solids. It has no materials: all is `solid`.

use nalgebra::Point3;

use super::soup::{Soup, Trouble};
use super::text::{BYTE_ORDER_MARK, lines};

const SOLID: &str = "solid";
const MATERIAL: &str = SOLID;
/// Layout of a binary file: a header, the count, and so many bytes a triangle: the normal, three corners of three 32-bit floats, two bytes more.
const HEADER: usize = 80;
const TRIANGLE: usize = 50;
const NORMAL: usize = 12;

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    match binary(bytes) {
        // A text file begins with "solid", but so do binary ones of some programs: those are known by their length.
        Some((triangles, [])) => read_binary(triangles, soup),
        _ if is_text(bytes) => read_text(&String::from_utf8_lossy(bytes), soup),
        Some((triangles, rest)) if rest.iter().all(|byte| *byte == 0) => read_binary(triangles, soup),
        Some((triangles, rest)) => Err(Trouble::Damaged(format!(
            "{} bytes follow the {} triangles that it announces",
            rest.len(),
            triangles.len() / TRIANGLE
        ))),
        None => Err(Trouble::damaged("it ends before the last triangle that it announces")),
    }
}

/// Returns the triangles of a binary file, and what follows them; `None` where it is too short.
fn binary(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (count, rest) = bytes.get(HEADER..)?.split_first_chunk::<4>()?;
    rest.split_at_checked((u32::from_le_bytes(*count) as usize).checked_mul(TRIANGLE)?)
}

/// Returns true if the first word is `solid`, in any case, after blanks or a byte order mark, and no byte is 0.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(BYTE_ORDER_MARK.as_bytes()).unwrap_or(bytes);
    let word = start.trim_ascii_start().get(..SOLID.len());
    word.is_some_and(|word| word.eq_ignore_ascii_case(SOLID.as_bytes())) && !bytes.contains(&0)
}

fn read_binary(triangles: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let material = soup.material(MATERIAL, None);
    for triangle in triangles.as_chunks::<TRIANGLE>().0 {
        let (numbers, _) = triangle[NORMAL..].as_chunks::<4>();
        let number = |i: usize| f64::from(f32::from_le_bytes(numbers[i]));
        let corner = |i: usize| (Point3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)), None);
        soup.triangle([corner(0), corner(1), corner(2)], material)?;
    }
    Ok(())
}

/// Reads words with white space between them; names fill the rest of their line.
fn read_text(text: &str, soup: &mut Soup) -> Result<(), Trouble> {
    let material = soup.material(MATERIAL, None);
    let (mut corners, mut is_open) = (Vec::new(), false);
    for (i, line) in lines(text).enumerate() {
        let not_understood = || Trouble::Damaged(format!("line {} is not understood", i + 1));
        let mut words = line.split_whitespace();
        while let Some(word) = words.next() {
            let mut point = || {
                let mut number = || words.next()?.parse::<f32>().ok().map(f64::from);
                Some(Point3::new(number()?, number()?, number()?))
            };
            match word.to_ascii_lowercase().as_str() {
                "solid" | "endsolid" => {
                    is_open = word.len() == SOLID.len();
                    if words.any(|word| word.eq_ignore_ascii_case("facet")) {
                        return Err(not_understood());
                    }
                }
                "normal" => drop(point().ok_or_else(not_understood)?),
                "vertex" => corners.push((point().ok_or_else(not_understood)?, None)),
                "endloop" => {
                    let triangle = std::mem::take(&mut corners).try_into();
                    soup.triangle(triangle.map_err(|_| not_understood())?, material)?;
                }
                "facet" | "outer" | "loop" | "endfacet" => {}
                _ => return Err(not_understood()),
            }
        }
    }
    match is_open || !corners.is_empty() {
        true => Err(Trouble::damaged("it ends before its last solid does")),
        false => Ok(()),
    }
}
