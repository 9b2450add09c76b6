//! PLY, text or binary of either byte order. It has no materials: all is `ply`.

use std::io::Cursor;

use nalgebra::Point3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Property};

use super::{MAX_TRIANGLES, Soup, Trouble, corner};

/// Vertices, faces and whatever else the header announces: a closed surface has half as many vertices as triangles, separate
/// triangles three each.
const MAX_ELEMENTS: usize = 4 * MAX_TRIANGLES;
const MATERIAL: &str = "ply";

pub(super) fn read(bytes: &[u8], soup: &mut Soup) -> Result<(), Trouble> {
    let material = soup.material(MATERIAL);
    let parser = Parser::<DefaultElement>::new();
    let mut file = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut file).map_err(Trouble::damaged)?;
    // Elements without properties take no bytes: a header alone could ask for any number of them.
    let announced = header.elements.values().map(|element| element.count);
    if announced.fold(0, usize::saturating_add) > MAX_ELEMENTS {
        return Err(Trouble::TooManyTriangles);
    }
    let payload = parser.read_payload(&mut file, &header).map_err(Trouble::damaged)?;
    let elements = |name: &str| payload.get(name).map_or(&[][..], Vec::as_slice);
    let points: Result<Vec<_>, _> = elements("vertex").iter().map(point).collect();
    let points = points?;
    for face in elements("face") {
        let list = face
            .get("vertex_indices")
            .or_else(|| face.get("vertex_index"))
            .and_then(whole_numbers)
            .ok_or_else(|| Trouble::damaged("a face has no list vertex_indices of whole numbers"))?;
        let corners: Result<Vec<_>, _> = list.into_iter().map(|i| corner(&points, i)).collect();
        soup.fan(&corners?, material)?;
    }
    Ok(())
}

fn point(vertex: &DefaultElement) -> Result<Point3<f64>, Trouble> {
    let coordinate = |name: &str| match vertex.get(name) {
        Some(Property::Float(value)) => Ok(f64::from(*value)),
        Some(Property::Double(value)) => Ok(*value),
        _ => Err(Trouble::Damaged(format!(
            "a vertex has no {name} of type float or double"
        ))),
    };
    Ok(Point3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?))
}

/// `None` for anything but a list of whole numbers from 0 on.
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
