//! The contact sheet: every chosen frame small, with where and how sharp it is.

use std::io::Cursor;

use image::{ImageFormat, Rgb, RgbImage, imageops};

use crate::keep::SavedFrame;
use scaleproof_core::geometry::angle::direction_text;
use scaleproof_photo::draw::{LabelAnchor, Lettering, label};

const GAP_PX: u32 = 8;
const LETTERS_PX: f64 = 15.0;
const WORDS_PX: u32 = 24;
const INK: Lettering = Lettering {
    colour: [29, 35, 43],
    ground: [255, 255, 255],
    size_px: LETTERS_PX,
};
/// Frames beside each other.
const ACROSS: usize = 4;
/// Maximum number of frames on the sheet; more could not be looked through.
const MOST: usize = 400;

/// Draws the sheet as a PNG, by bin and time; `None` without frames.
pub fn png(kept: &[SavedFrame]) -> Option<Vec<u8>> {
    let mut kept: Vec<&SavedFrame> = kept.iter().take(MOST).collect();
    kept.sort_by(|a, b| a.bin.cmp(&b.bin).then(a.frame.number.cmp(&b.frame.number)));
    let width = kept.iter().map(|one| one.thumbnail.width()).max()?;
    let height = kept.iter().map(|one| one.thumbnail.height()).max()?;
    let (columns, rows) = (kept.len().min(ACROSS), kept.len().div_ceil(ACROSS));
    let cell = [width + GAP_PX, height + WORDS_PX + GAP_PX];
    let size = [GAP_PX + columns as u32 * cell[0], GAP_PX + rows as u32 * cell[1]];
    let mut sheet = RgbImage::from_pixel(size[0], size[1], Rgb([255; 3]));
    for (i, one) in kept.iter().enumerate() {
        let at = [
            GAP_PX + (i % ACROSS) as u32 * cell[0],
            GAP_PX + (i / ACROSS) as u32 * cell[1],
        ];
        imageops::replace(&mut sheet, &one.thumbnail, at[0].into(), at[1].into());
        let place = [f64::from(at[0]), f64::from(at[1] + one.thumbnail.height())];
        label(&mut sheet, place, LabelAnchor::TopLeft, &words(one), INK);
    }
    let mut bytes = Vec::new();
    sheet.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).ok()?;
    Some(bytes)
}

fn words(one: &SavedFrame) -> String {
    let blur = one.measures.blur_px.map_or(String::new(), |px| format!(", {px:.1} px"));
    let pair = one
        .pair
        .map_or(String::new(), |(_, pair)| format!(", pair {:.1}°", pair.apart_deg));
    format!(
        "{}°, {:.2} s{blur}{pair}",
        direction_text(one.viewpoint.azimuth_deg, 1),
        one.frame.time_s
    )
}
