//! STL, binary or text. It has no materials: all is `solid`.

use std::borrow::Cow;
use std::io::Cursor;

use nalgebra::Point3;

use super::{Soup, Trouble};

const MATERIAL: &str = "solid";
/// A binary file: a header, the count, and so many bytes a triangle.
const HEADER: usize = 80;
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let material = soup.material(MATERIAL, None);
    // A text file begins with "solid", but so do binary ones of some programs: those are known by their length.
    let mut file = Cursor::new(Cow::from(bytes));
    if is_binary(bytes) && bytes.starts_with(b"solid") {
        file.get_mut().to_mut()[..5].fill(b' ');
    }
    for triangle in stl_io::create_stl_reader(&mut file).map_err(Trouble::damaged)? {
        let corners = triangle.map_err(Trouble::damaged)?.vertices.map(|vertex| {
            let [x, y, z] = vertex.0;
            (Point3::new(f64::from(x), f64::from(y), f64::from(z)), None)
        });
        soup.triangle(corners, material)?;
    }
    Ok(())
}

fn is_binary(bytes: &[u8]) -> bool {
    let Some(count) = bytes.get(HEADER..).and_then(|rest| rest.first_chunk::<4>()) else {
        return false;
    };
    let triangles = u32::from_le_bytes(*count) as usize;
    bytes.len() == HEADER + 4 + triangles * TRIANGLE
}
