//! PLY, text or binary of either byte order. It has no materials: all is `ply`. Images stand in comments.

use std::io::Cursor;

use nalgebra::Point3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Property};

use super::image::{ImageSource, Look};
use super::soup::{MAX_TRIANGLES, Soup, Trouble, corner};

/// Largest number of vertices, faces and other elements of the header: a closed surface has half as many vertices as triangles, separate triangles
/// three each.
const MAX_ELEMENTS: usize = 4 * MAX_TRIANGLES;
const MATERIAL: &str = "ply";

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let parser = Parser::<DefaultElement>::new();
    let mut file = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut file).map_err(Trouble::damaged)?;
    // Elements without properties take no bytes: a header alone could ask for any number of them.
    let announced = header.elements.values().map(|element| element.count);
    if announced.fold(0, usize::saturating_add) > MAX_ELEMENTS {
        return Err(Trouble::TooManyTriangles);
    }
    let payload = parser.read_payload(&mut file, &header).map_err(Trouble::damaged)?;
    let rest = bytes.get(file.into_inner().position() as usize..).unwrap_or_default();
    if !rest.iter().all(|byte| byte.is_ascii_whitespace() || *byte == 0) {
        let more = rest.len();
        return Err(Trouble::Damaged(format!(
            "{more} bytes follow the elements that it announces"
        )));
    }
    let elements = |name: &str| payload.get(name).map_or(&[][..], Vec::as_slice);
    let points: Result<Vec<_>, _> = elements("vertex").iter().map(point).collect();
    let points = points?;
    let of_vertices: Vec<_> = elements("vertex").iter().map(coordinates_of_vertex).collect();
    let comments = header.comments.iter();
    let names = comments.filter_map(|line| line.trim().strip_prefix("TextureFile"));
    let images: Vec<_> = names
        .map(|name| ImageSource::beside(&soup.folder, name.trim()))
        .collect();
    for (number, face) in elements("face").iter().enumerate() {
        let list = face
            .get("vertex_indices")
            .or_else(|| face.get("vertex_index"))
            .and_then(whole_numbers)
            .ok_or_else(|| Trouble::damaged("a face has no list vertex_indices of whole numbers"))?;
        let of_face = face.get("texcoord").and_then(floats).unwrap_or_default();
        let of_corner = |i: usize, vertex: usize| match of_face.as_chunks::<2>().0.get(i) {
            Some(pair) => Some(*pair),
            None => of_vertices.get(vertex).copied().flatten(),
        };
        let corners = list.into_iter().enumerate();
        let corners: Result<Vec<_>, _> = corners
            .map(|(i, vertex)| Ok((corner(&points, vertex)?, of_corner(i, vertex))))
            .collect();
        let image = images.get(face.get("texnumber").and_then(whole_number).unwrap_or(0));
        let material = soup.material(MATERIAL, image.cloned().map(Look::plain));
        soup.face(&corners?, material, "with number", number)?;
    }
    Ok(())
}

/// Returns the coordinates of a vertex by any of the names that programs give them, v up.
fn coordinates_of_vertex(vertex: &DefaultElement) -> Option<[f64; 2]> {
    let names = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
    let value = |name: &str| float(vertex.get(name)?);
    names.into_iter().find_map(|[u, v]| Some([value(u)?, value(v)?]))
}

/// Returns a number of any type.
fn float(property: &Property) -> Option<f64> {
    Some(match property {
        Property::Float(value) => f64::from(*value),
        Property::Double(value) => *value,
        Property::Char(value) => f64::from(*value),
        Property::UChar(value) => f64::from(*value),
        Property::Short(value) => f64::from(*value),
        Property::UShort(value) => f64::from(*value),
        Property::Int(value) => f64::from(*value),
        Property::UInt(value) => f64::from(*value),
        _ => return None,
    })
}

fn floats(list: &Property) -> Option<Vec<f64>> {
    match list {
        Property::ListFloat(numbers) => Some(numbers.iter().copied().map(f64::from).collect()),
        Property::ListDouble(numbers) => Some(numbers.clone()),
        _ => None,
    }
}

fn whole_number(property: &Property) -> Option<usize> {
    match property {
        Property::Char(number) => (*number).try_into().ok(),
        Property::UChar(number) => Some((*number).into()),
        Property::Short(number) => (*number).try_into().ok(),
        Property::UShort(number) => Some((*number).into()),
        Property::Int(number) => (*number).try_into().ok(),
        Property::UInt(number) => (*number).try_into().ok(),
        _ => None,
    }
}

fn point(vertex: &DefaultElement) -> Result<Point3<f64>, Trouble> {
    let coordinate = |name: &str| {
        let value = vertex.get(name).and_then(float);
        value.ok_or_else(|| Trouble::Damaged(format!("a vertex has no number {name}")))
    };
    Ok(Point3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?))
}

/// Returns a list of whole numbers from 0 on; `None` for anything else.
fn whole_numbers(list: &Property) -> Option<Vec<usize>> {
    fn all<T: Copy + TryInto<usize>>(numbers: &[T]) -> Option<Vec<usize>> {
        numbers.iter().map(|n| (*n).try_into().ok()).collect()
    }
    match list {
        Property::ListChar(numbers) => all(numbers),
        Property::ListUChar(numbers) => all(numbers),
        Property::ListShort(numbers) => all(numbers),
        Property::ListUShort(numbers) => all(numbers),
        Property::ListInt(numbers) => all(numbers),
        Property::ListUInt(numbers) => all(numbers),
        _ => None,
    }
}
