//! Conversions between 8-bit sRGB and linear light (IEC 61966-2-1): values 0 to 1, 1 is white.

use std::sync::LazyLock;

use palette::encoding::{FromLinear, IntoLinear, Srgb};

/// Returns the linear light of an sRGB value.
pub fn decode(srgb: f64) -> f64 {
    Srgb::into_linear(srgb)
}

/// Returns the sRGB value of linear light; values outside 0 to 1 are clipped, as every 8-bit image is.
pub fn encode(linear: f64) -> f64 {
    Srgb::from_linear(linear.clamp(0.0, 1.0))
}

/// Returns the derivative of [`decode`], which `palette` does not have.
pub fn decode_derivative(srgb: f64) -> f64 {
    if srgb <= 0.04045 {
        1.0 / 12.92
    } else {
        2.4 / 1.055 * ((srgb + 0.055) / 1.055).powf(1.4)
    }
}

/// Returns an 8-bit sRGB colour in linear light.
pub fn linear_of(rgb: [u8; 3]) -> [f64; 3] {
    static OF_BYTE: LazyLock<[f64; 256]> = LazyLock::new(|| std::array::from_fn(|v| decode(v as f64 / 255.0)));
    rgb.map(|v| OF_BYTE[usize::from(v)])
}

/// Returns Y of linear light in the primaries of sRGB (IEC 61966-2-1).
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Returns linear light as 8-bit sRGB, clipped.
pub fn rgb_of(linear: [f64; 3]) -> [u8; 3] {
    linear.map(|v| (255.0 * encode(v)).round() as u8)
}

/// Parses a colour of six hexadecimal digits, as in `808080` or `#808080`.
pub fn from_hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let is_plain = digits.len() == 6 && digits.chars().all(|c| c.is_ascii_hexdigit());
    let [_, r, g, b] = u32::from_str_radix(digits, 16).ok().filter(|_| is_plain)?.to_be_bytes();
    Some([r, g, b])
}

/// Writes a colour as six lower-case hexadecimal digits, as in `808080`; [`from_hex`] reads them.
pub fn to_hex(rgb: [u8; 3]) -> String {
    rgb.map(|v| format!("{v:02x}")).concat()
}
