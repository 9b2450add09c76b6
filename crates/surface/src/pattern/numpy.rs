//! Colours in arrays as NumPy saves them (`.npy`; NumPy documentation, "NPY format"): floats from 0 to 1, or bytes.

use std::io;

use image::RgbImage;
use npyz::{NpyFile, Order};

/// Size of the largest header: NumPy writes 64 to 192 bytes for such an array. The reader of headers works by recursion.
const MOST_HEADER_BYTES: u64 = 1024;
/// Amount by which values may leave 0 to 1, for rounding.
const ROUNDING: f32 = 1e-3;

/// First bytes of every such file.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads an image of red, green and blue planes, as PyTorch has it, or of such pixels.
///
/// # Errors
/// Another shape or kind of numbers, as a clause.
pub(crate) fn image(bytes: &[u8], most_side: u32) -> Result<RgbImage, String> {
    let (file, stored_bytes) = open(bytes)?;
    let shape = file.shape().to_vec();
    let sides = |a: u64, b: u64| (1..=u64::from(most_side)).contains(&a) && (1..=u64::from(most_side)).contains(&b);
    let ([height, width], is_planes) = match *shape.strip_prefix(&[1]).unwrap_or(&shape) {
        [3, h, w] if w != 3 && sides(h, w) => ([h as usize, w as usize], true),
        [h, w, 3] if h != 3 && sides(h, w) => ([h as usize, w as usize], false),
        _ => {
            return Err(format!(
                "its shape is {shape:?}, and images have 3, height, width or height, width, 3"
            ));
        }
    };
    let values = colours(file, width * height * 3, stored_bytes)?;
    let value = |x: usize, y: usize, channel: usize| match is_planes {
        true => values[(channel * height + y) * width + x],
        false => values[(y * width + x) * 3 + channel],
    };
    let pixel = |x: u32, y: u32| {
        let byte = |channel| (255.0 * value(x as usize, y as usize, channel).clamp(0.0, 1.0)).round() as u8;
        image::Rgb([0, 1, 2].map(byte))
    };
    Ok(RgbImage::from_fn(width as u32, height as u32, pixel))
}

/// Reads all numbers of a file, which must be `count` from 0 to 1 and nothing more.
pub(crate) fn colours(file: NpyFile<&[u8]>, count: usize, stored_bytes: usize) -> Result<Vec<f32>, String> {
    if file.order() == Order::Fortran {
        return Err("it is stored in Fortran order; save numpy.ascontiguousarray of it".into());
    }
    let size = file.dtype().num_bytes().unwrap_or_default();
    let values = values(file)?;
    if values.len() != count {
        return Err("it ends too early".into());
    }
    if stored_bytes > count * size {
        return Err("more follows its numbers: save one array a file".into());
    }
    let is_colour = |value: &&f32| (-ROUNDING..=1.0 + ROUNDING).contains(*value);
    match values.iter().find(|value| !is_colour(value)) {
        Some(value) => Err(format!("it has the value {value}, and colours are from 0 to 1")),
        None => Ok(values),
    }
}

/// Returns the file with its header read, and the number of bytes behind the header.
pub(crate) fn open(bytes: &[u8]) -> Result<(NpyFile<&[u8]>, usize), String> {
    let (magic, header) = match bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, a, b, ..] => (10, u64::from(u16::from_le_bytes([*a, *b]))),
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _, a, b, c, d, ..] => {
            (12, u64::from(u32::from_le_bytes([*a, *b, *c, *d])))
        }
        _ => return Err("it is no .npy file".into()),
    };
    if header > MOST_HEADER_BYTES {
        return Err(format!("its header has {header} bytes"));
    }
    let damaged = |e: io::Error| {
        format!(
            "its header is damaged: {}",
            e.to_string().lines().next().unwrap_or_default()
        )
    };
    let file = NpyFile::new(bytes).map_err(damaged)?;
    Ok((file, bytes.len().saturating_sub(magic + header as usize)))
}

/// Reads all numbers, 0 to 1; fewer where the file ends early.
fn values(file: NpyFile<&[u8]>) -> Result<Vec<f32>, String> {
    let kind = file.dtype();
    let file = match file.try_data::<f32>() {
        Ok(floats) => return converted(floats, |v| v),
        Err(file) => file,
    };
    let file = match file.try_data::<f64>() {
        Ok(doubles) => return converted(doubles, |v| v as f32),
        Err(file) => file,
    };
    match file.try_data::<u8>() {
        Ok(bytes) => converted(bytes, |v| f32::from(v) / 255.0),
        Err(_) => Err(format!(
            "its numbers are {}, and they must be float32, float64 or uint8",
            kind.descr()
        )),
    }
}

fn converted<T>(stored: impl Iterator<Item = io::Result<T>>, value: impl Fn(T) -> f32) -> Result<Vec<f32>, String> {
    let values: io::Result<_> = stored.map(|v| v.map(&value)).collect();
    values.map_err(|_| "it ends too early".into())
}
