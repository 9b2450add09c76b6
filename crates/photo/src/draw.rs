//! Lines, outlines and labels in images. Pixel (0, 0) is the centre of the top-left pixel.
//!
//! Whatever lies outside the image, or is no number, is simply not drawn. Same input, same pixels.

use ab_glyph::{Font, FontRef, Glyph, ScaleFont, point};
use image::{Rgb, RgbImage};

/// DejaVu Sans, Latin-1 only; where it comes from and its licence are in `print/fonts`.
const FONT: &[u8] = scaleproof_core::FONT;

/// Space around a label's text, by the size of its letters.
const MARGIN: f64 = 0.3;

/// An sRGB colour, 8 bit.
pub type DrawColour = [u8; 3];

/// What a line looks like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    pub colour: DrawColour,
    pub width_px: f64,
}

/// What a label looks like: letters of a colour on a ground, their height from the tallest to the lowest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lettering {
    pub colour: DrawColour,
    pub ground: DrawColour,
    pub size_px: f64,
}

/// Where a label stands relative to its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LabelAnchor {
    /// The place is the label's top-left corner.
    TopLeft,
    /// The place is the label's bottom-left corner: a label that sits on a box.
    BottomLeft,
    /// The place is the label's centre.
    Centre,
}

/// The line width and the height of letters, px, that are readable when an image is seen whole on a screen.
pub fn readable_px(image: &RgbImage) -> (f64, f64) {
    let longest = f64::from(image.width().max(image.height()));
    ((longest / 700.0).max(1.5), (longest / 70.0).max(11.0))
}

/// A straight line.
pub fn line(image: &mut RgbImage, from: [f64; 2], to: [f64; 2], pen: Pen) {
    let Some([from, to]) = clipped(image, from, to, pen.width_px) else {
        return;
    };
    let along = [to[0] - from[0], to[1] - from[1]];
    // Walks along the longer axis, and covers a short run across it.
    let major = usize::from(along[1].abs() > along[0].abs());
    let minor = 1 - major;
    let slope = if along[major] == 0.0 {
        0.0
    } else {
        along[minor] / along[major]
    };
    let half = pen.width_px / 2.0;
    let reach = (half + 1.0) * (1.0 + slope * slope).sqrt();
    let (start, end) = (from[major].min(to[major]), from[major].max(to[major]));
    for m in (start - half - 1.0).floor() as i64..=(end + half + 1.0).ceil() as i64 {
        let middle = from[minor] + slope * ((m as f64).clamp(start, end) - from[major]);
        for n in (middle - reach).floor() as i64..=(middle + reach).ceil() as i64 {
            let mut at = [m; 2];
            at[minor] = n;
            let distance = distance_to(from, to, at.map(|v| v as f64));
            blend(image, at, pen.colour, half + 0.5 - distance);
        }
    }
}

/// Lines from each corner to the next, and from the last to the first.
pub fn polygon(image: &mut RgbImage, corners: &[[f64; 2]], pen: Pen) {
    for (i, corner) in corners.iter().enumerate() {
        line(image, *corner, corners[(i + 1) % corners.len()], pen);
    }
}

/// The outline of an upright rectangle between two opposite corners.
pub fn rectangle(image: &mut RgbImage, one: [f64; 2], other: [f64; 2], pen: Pen) {
    polygon(image, &[one, [other[0], one[1]], other, [one[0], other[1]]], pen);
}

/// Text on a ground, moved as far as it takes to lie inside the image, and cut where it is larger than that. `\n` starts a new
/// line; a letter outside Latin-1 becomes a question mark.
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
    for glyph in glyphs(text, lettering.size_px) {
        let Some(outlined) = glyph.outlined() else { continue };
        let corner = outlined.px_bounds().min;
        outlined.draw(|x, y, covered| {
            let x = left + i64::from(x) + (f64::from(corner.x) + margin).round() as i64;
            let y = top + i64::from(y) + (f64::from(corner.y) + margin / 2.0).round() as i64;
            blend(image, [x, y], lettering.colour, covered.into());
        });
    }
}

/// Width and height that a label takes, px.
pub fn label_size_px(text: &str, size_px: f64) -> [f64; 2] {
    let Some(font) = font() else { return [0.0; 2] };
    let scaled = font.as_scaled(size_px as f32);
    let width = |line: &str| {
        line.chars()
            .map(|c| f64::from(scaled.h_advance(font.glyph_id(shown(c)))))
            .sum::<f64>()
    };
    let widest = text.lines().map(width).fold(0.0, f64::max);
    let lines = text.lines().count() as f64;
    [
        widest + 2.0 * MARGIN * size_px,
        lines * line_height(size_px) + MARGIN * size_px,
    ]
}

/// From line to line, px.
fn line_height(size_px: f64) -> f64 {
    1.15 * size_px
}

/// Left, top, width and height of a label in whole pixels, inside the image; the top-left is kept where it is too large. `None`
/// where the place is no number.
fn placed(image: &RgbImage, at: [f64; 2], anchor: LabelAnchor, text: &str, size_px: f64) -> Option<[i64; 4]> {
    let [width, height] = label_size_px(text, size_px).map(f64::ceil);
    let [left, top] = match anchor {
        LabelAnchor::TopLeft => at,
        LabelAnchor::BottomLeft => [at[0], at[1] - height],
        LabelAnchor::Centre => [at[0] - width / 2.0, at[1] - height / 2.0],
    };
    let inside = |start: f64, length: f64, side: u32| start.min(f64::from(side) - length).max(0.0).round() as i64;
    let is_number = left.is_finite() && top.is_finite() && size_px > 0.0 && size_px < 10_000.0;
    is_number.then(|| {
        [
            inside(left, width, image.width()),
            inside(top, height, image.height()),
            width as i64,
            height as i64,
        ]
    })
}

/// A letter at its place in a label without margins.
struct Placed {
    font: FontRef<'static>,
    glyph: Glyph,
}

impl Placed {
    fn outlined(self) -> Option<ab_glyph::OutlinedGlyph> {
        self.font.outline_glyph(self.glyph)
    }
}

fn glyphs(text: &str, size_px: f64) -> Vec<Placed> {
    let Some(font) = font() else { return Vec::new() };
    let scaled = font.as_scaled(size_px as f32);
    let mut placed = Vec::new();
    for (row, line) in text.lines().enumerate() {
        let (mut x, y) = (0.0, scaled.ascent() + (row as f64 * line_height(size_px)) as f32);
        for c in line.chars() {
            let id = font.glyph_id(shown(c));
            let glyph = id.with_scale_and_position(size_px as f32, point(x, y));
            placed.push(Placed {
                font: font.clone(),
                glyph,
            });
            x += scaled.h_advance(id);
        }
    }
    placed
}

/// The font is part of the program, so that it is always there; a test holds it.
fn font() -> Option<FontRef<'static>> {
    FontRef::try_from_slice(FONT).ok()
}

/// Only what the font has.
fn shown(c: char) -> char {
    match c {
        ' '..='~' | '\u{a1}'..='\u{ff}' | '…' => c,
        _ => '?',
    }
}

/// A line's part within reach of the image (Liang & Barsky 1984).
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

/// From a point to the nearest point of a line segment.
fn distance_to(from: [f64; 2], to: [f64; 2], at: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let [x, y] = [at[0] - from[0], at[1] - from[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let t = if squared > 0.0 {
        ((x * along[0] + y * along[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (x - t * along[0]).hypot(y - t * along[1])
}

/// Mixes a colour into a pixel by how much of it is covered; nothing outside the image.
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

#[cfg(test)]
mod tests {
    use super::*;

    const PEN: Pen = Pen {
        colour: [255, 0, 0],
        width_px: 3.0,
    };
    const LETTERS: Lettering = Lettering {
        colour: [255; 3],
        ground: [0, 0, 200],
        size_px: 20.0,
    };

    fn painted(image: &RgbImage) -> Vec<[u32; 2]> {
        let is_painted = |(_, _, p): &(u32, u32, &Rgb<u8>)| p.0 != [0; 3];
        image
            .enumerate_pixels()
            .filter(is_painted)
            .map(|(x, y, _)| [x, y])
            .collect()
    }

    #[test]
    fn a_line_covers_its_width_and_ends_where_it_should() {
        let mut image = RgbImage::new(60, 40);
        line(&mut image, [10.0, 20.0], [49.0, 20.0], PEN);
        for x in 10..50 {
            let column: Vec<u8> = (18..23).map(|y| image.get_pixel(x, y).0[0]).collect();
            assert_eq!(column, [0, 255, 255, 255, 0], "column {x}");
        }
        assert!(painted(&image).iter().all(|[x, _]| (8..=51).contains(x)));
    }

    #[test]
    fn a_slanted_line_is_as_heavy_as_its_length_and_width_say() {
        let mut image = RgbImage::new(200, 200);
        line(&mut image, [20.0, 30.0], [170.0, 140.0], PEN);
        let ink: f64 = image.pixels().map(|p| f64::from(p.0[0]) / 255.0).sum();
        let expected = 150f64.hypot(110.0) * 3.0 + std::f64::consts::PI * 1.5 * 1.5;
        assert!((ink / expected - 1.0).abs() < 0.02, "{ink} of {expected}");
    }

    #[test]
    fn what_is_far_outside_or_no_number_is_not_drawn_and_takes_no_time() {
        let mut image = RgbImage::new(60, 40);
        line(&mut image, [-1e12, -1e12], [1e12, -1e12], PEN);
        line(&mut image, [f64::NAN, 3.0], [5.0, 5.0], PEN);
        label(&mut image, [f64::INFINITY, 0.0], LabelAnchor::Centre, "text", LETTERS);
        assert!(painted(&image).is_empty());
        line(&mut image, [-1e9, 20.0], [1e9, 20.0], PEN);
        assert_eq!(painted(&image).len(), 3 * 60, "it crosses the whole image");
        polygon(&mut image, &[], PEN);
    }

    #[test]
    fn a_label_stays_inside_and_has_the_size_it_says() {
        for (at, anchor) in [
            ([1e6, 1e6], LabelAnchor::TopLeft),
            ([-50.0, 3.0], LabelAnchor::BottomLeft),
            ([100.0, 50.0], LabelAnchor::Centre),
        ] {
            let mut image = RgbImage::new(200, 100);
            label(&mut image, at, anchor, "azimuth 45°\n± 0.1", LETTERS);
            let [width, height] = label_size_px("azimuth 45°\n± 0.1", 20.0).map(f64::ceil);
            assert_eq!(painted(&image).len() as f64, width * height);
            assert!(image.pixels().any(|p| p.0 == [255; 3]), "there are letters");
        }
    }

    /// The label's border has the ground's colour: no letter leaves its ground.
    #[test]
    fn the_letters_lie_within_their_ground() {
        let mut image = RgbImage::new(400, 100);
        label(&mut image, [20.0, 20.0], LabelAnchor::TopLeft, "ÄgjÅ|Wy,", LETTERS);
        let letters: Vec<_> = image.enumerate_pixels().filter(|(_, _, p)| p.0[0] > 60).collect();
        let [width, height] = label_size_px("ÄgjÅ|Wy,", 20.0).map(|v| v.ceil() as u32);
        assert!(letters.len() > 200);
        assert!(
            letters
                .iter()
                .all(|(x, y, _)| (20..20 + width).contains(x) && (20..20 + height).contains(y))
        );
    }

    #[test]
    fn every_printable_letter_has_a_glyph() {
        let font = font().expect("the font is part of the program");
        for c in (' '..='~').chain('\u{a1}'..='\u{ff}').chain(['…']) {
            assert_ne!(font.glyph_id(c).0, 0, "{c:?}");
        }
        assert_eq!(shown('漢'), '?');
    }
}
