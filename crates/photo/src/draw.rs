//! Drawing of lines, outlines and labels in images. Pixel (0, 0) is the centre of the top-left pixel.
//!
//! Anything outside the image, or at a position that is not finite, is not drawn. Same input, same pixels.

use ab_glyph::{Font, FontRef, OutlinedGlyph, ScaleFont, point};
use image::Rgb;
pub use image::RgbImage;
use scaleproof_core::geometry::to_segment;

/// Space around a label's text, relative to the font size.
const MARGIN: f64 = 0.3;

/// sRGB colour, 8 bit.
pub type DrawColour = [u8; 3];

/// Colour and width of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    pub colour: DrawColour,
    pub width_px: f64,
}

/// Appearance of a label: colours of text and ground, and the height of letters including descenders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lettering {
    pub colour: DrawColour,
    pub ground: DrawColour,
    pub size_px: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LabelAnchor {
    /// Top-left corner of the label.
    TopLeft,
    /// Bottom-left corner of the label: for a label on top of a box.
    BottomLeft,
    /// Centre of the label.
    Centre,
}

/// Returns the line width and the height of letters, px, that are legible when the whole image is shown on a screen.
pub fn readable_px(image: &RgbImage) -> (f64, f64) {
    let longest = f64::from(image.width().max(image.height()));
    ((longest / 700.0).max(1.5), (longest / 70.0).max(11.0))
}

pub fn line(image: &mut RgbImage, from: [f64; 2], to: [f64; 2], pen: Pen) {
    let Some([from, to]) = clipped(image, from, to, pen.width_px) else {
        return;
    };
    let along = [to[0] - from[0], to[1] - from[1]];
    // Walks along the longer axis, and covers a short run across it.
    let major = usize::from(along[1].abs() > along[0].abs());
    let minor = 1 - major;
    let is_point = along[major] == 0.0;
    let slope = if is_point { 0.0 } else { along[minor] / along[major] };
    let half = pen.width_px / 2.0;
    let reach = (half + 1.0) * (1.0 + slope * slope).sqrt();
    let (start, end) = (from[major].min(to[major]), from[major].max(to[major]));
    for m in (start - half - 1.0).floor() as i64..=(end + half + 1.0).ceil() as i64 {
        let middle = from[minor] + slope * ((m as f64).clamp(start, end) - from[major]);
        for n in (middle - reach).floor() as i64..=(middle + reach).ceil() as i64 {
            let mut at = [m; 2];
            at[minor] = n;
            let distance = to_segment(at.map(|v| v as f64), [from, to]);
            blend(image, at, pen.colour, half + 0.5 - distance);
        }
    }
}

/// Draws lines from each corner to the next, and from the last to the first.
pub fn polygon(image: &mut RgbImage, corners: &[[f64; 2]], pen: Pen) {
    for (i, corner) in corners.iter().enumerate() {
        line(image, *corner, corners[(i + 1) % corners.len()], pen);
    }
}

/// Draws the outline of an upright rectangle between two opposite corners.
pub fn rectangle(image: &mut RgbImage, one: [f64; 2], other: [f64; 2], pen: Pen) {
    polygon(image, &[one, [other[0], one[1]], other, [one[0], other[1]]], pen);
}

/// Draws text on a ground, moved as far as needed to lie inside the image, and clipped if it is larger. `\n` starts a new line; a letter outside
/// Latin-1 becomes a question mark.
pub fn label(image: &mut RgbImage, at: [f64; 2], anchor: LabelAnchor, text: &str, lettering: Lettering) {
    let Some([left, top, width, height]) = placed(image, at, anchor, text, lettering.size_px) else {
        return;
    };
    for y in top..(top + height).min(image.height().into()) {
        for x in left..(left + width).min(image.width().into()) {
            blend(image, [x, y], lettering.ground, 1.0);
        }
    }
    let margin = MARGIN * lettering.size_px;
    for outlined in glyphs(text, lettering.size_px) {
        let corner = outlined.px_bounds().min;
        outlined.draw(|x, y, covered| {
            let x = left + i64::from(x) + (f64::from(corner.x) + margin).round() as i64;
            let y = top + i64::from(y) + (f64::from(corner.y) + margin / 2.0).round() as i64;
            blend(image, [x, y], lettering.colour, covered.into());
        });
    }
}

/// Returns width and height of a label, px.
pub fn label_size_px(text: &str, size_px: f64) -> [f64; 2] {
    let Some(font) = font() else { return [0.0; 2] };
    let scaled = font.as_scaled(size_px as f32);
    let advance = |c: char| f64::from(scaled.h_advance(font.glyph_id(shown(c))));
    let width = |line: &str| line.chars().map(advance).sum::<f64>();
    let widest = text.lines().map(width).fold(0.0, f64::max);
    let lines = text.lines().count() as f64;
    [
        widest + 2.0 * MARGIN * size_px,
        lines * line_height(size_px) + MARGIN * size_px,
    ]
}

/// Returns the distance from line to line, px.
fn line_height(size_px: f64) -> f64 {
    1.15 * size_px
}

/// Returns left, top, width and height of a label in whole pixels, moved inside the image; if it is too large, its top-left corner is kept. `None` if
/// the position is not finite.
fn placed(image: &RgbImage, at: [f64; 2], anchor: LabelAnchor, text: &str, size_px: f64) -> Option<[i64; 4]> {
    let [width, height] = label_size_px(text, size_px).map(f64::ceil);
    let [left, top] = match anchor {
        LabelAnchor::TopLeft => at,
        LabelAnchor::BottomLeft => [at[0], at[1] - height],
        LabelAnchor::Centre => [at[0] - width / 2.0, at[1] - height / 2.0],
    };
    let inside = |start: f64, length: f64, side: u32| start.min(f64::from(side) - length).max(0.0).round() as i64;
    let is_number = left.is_finite() && top.is_finite() && size_px > 0.0 && size_px < 10_000.0;
    let corner = [inside(left, width, image.width()), inside(top, height, image.height())];
    is_number.then(|| [corner[0], corner[1], width as i64, height as i64])
}

/// Returns the letters of a label at their positions, without margins; blanks have no outline.
fn glyphs(text: &str, size_px: f64) -> Vec<OutlinedGlyph> {
    let Some(font) = font() else { return Vec::new() };
    let scaled = font.as_scaled(size_px as f32);
    let mut outlined = Vec::new();
    for (row, line) in text.lines().enumerate() {
        let (mut x, y) = (0.0, scaled.ascent() + (row as f64 * line_height(size_px)) as f32);
        for c in line.chars() {
            let id = font.glyph_id(shown(c));
            outlined.extend(font.outline_glyph(id.with_scale_and_position(size_px as f32, point(x, y))));
            x += scaled.h_advance(id);
        }
    }
    outlined
}

/// Returns DejaVu Sans, Latin-1 only; its origin and licence are in `print/fonts`. It is part of the program, so it is always available; a test
/// checks this.
fn font() -> Option<FontRef<'static>> {
    FontRef::try_from_slice(scaleproof_core::FONT).ok()
}

fn shown(c: char) -> char {
    match c {
        ' '..='~' | '\u{a1}'..='\u{ff}' | '…' => c,
        _ => '?',
    }
}

/// Clips a line to the neighbourhood of the image (Liang & Barsky 1984).
fn clipped(image: &RgbImage, from: [f64; 2], to: [f64; 2], width_px: f64) -> Option<[[f64; 2]; 2]> {
    if !from.iter().chain(&to).all(|v| v.is_finite()) || !(0.0..10_000.0).contains(&width_px) {
        return None;
    }
    let margin = width_px + 2.0;
    let sides = [f64::from(image.width()), f64::from(image.height())];
    let along = [to[0] - from[0], to[1] - from[1]];
    let (mut enter, mut leave) = (0.0, 1.0);
    for axis in 0..2 {
        let bounds = [-margin - from[axis], sides[axis] + margin - from[axis]];
        if along[axis] == 0.0 {
            if bounds[0] > 0.0 || bounds[1] < 0.0 {
                return None;
            }
            continue;
        }
        let [one, other] = bounds.map(|b| b / along[axis]);
        enter = one.min(other).max(enter);
        leave = one.max(other).min(leave);
    }
    let at = |t: f64| [from[0] + t * along[0], from[1] + t * along[1]];
    (enter <= leave).then(|| [at(enter), at(leave)])
}

/// Blends a colour into a pixel by its covered share; does nothing outside the image.
fn blend(image: &mut RgbImage, [x, y]: [i64; 2], colour: DrawColour, covered: f64) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
        return;
    };
    let covered = covered.clamp(0.0, 1.0);
    if let Some(Rgb(pixel)) = image.get_pixel_mut_checked(x, y) {
        for (channel, paint) in pixel.iter_mut().zip(colour) {
            *channel = (f64::from(*channel) * (1.0 - covered) + f64::from(paint) * covered).round() as u8;
        }
    }
}
