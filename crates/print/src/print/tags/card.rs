//! Plain cards: one tag each, upright, inside a cut line.

use super::piece::CutPiece;
use super::{Instead, LINE_MM, TagPrintError, family_name, image_of};
use crate::print::shapes::{TagPlacement, black_modules};
use crate::print::sheet::{Mark, PointMm, RectMm, TextAnchor};
use scaleproof_plot::lettering::{fitting_size_mm, number};
use scaleproof_pose::scene::Tag;
use scaleproof_pose::tags::TagImage;

/// Below the tag, for its name.
const STRIP_MM: f64 = 7.0;
const TEXT_MM: f64 = 3.0;
const UP_MM: f64 = 3.0;

/// The card of each tag.
pub fn pieces<'a>(tags: &[&'a Tag]) -> Result<Vec<CutPiece<'a>>, TagPrintError> {
    let piece = |tag: &&'a Tag| {
        let (tag, image) = (*tag, image_of(tag)?);
        let width = image.width_mm(tag.size_mm);
        Ok(CutPiece {
            size_mm: (width, width + STRIP_MM),
            name: format!("id {}", tag.id),
            what: format!("the card of tag {}", tag.id),
            instead: Instead::Nothing,
            draw: Box::new(move |at| Ok(marks(tag, &image, at))),
        })
    };
    tags.iter().map(piece).collect()
}

fn marks(tag: &Tag, image: &TagImage, at: PointMm) -> Vec<Mark> {
    let width = image.width_mm(tag.size_mm);
    let card = RectMm::new(at.x_mm, at.y_mm, at.x_mm + width, at.y_mm + STRIP_MM + width);
    let place = TagPlacement {
        centre: PointMm::new(at.x_mm + width / 2.0, at.y_mm + STRIP_MM + width / 2.0),
        right: [1.0, 0.0],
        module_mm: tag.size_mm / image.border_modules() as f64,
    };
    let mut outlines = black_modules(image.modules(), &place);
    outlines.push(place.up_mark(
        width / 2.0 - UP_MM / 2.0 - 1.0,
        -width / 2.0 - 0.5 * (STRIP_MM + UP_MM),
        UP_MM,
    ));
    let name = format!(
        "id {} · {} · {} mm",
        tag.id,
        family_name(tag.family),
        number(tag.size_mm)
    );
    let size_mm = fitting_size_mm(&name, TEXT_MM, (width - UP_MM - 4.0).max(1.0));
    let baseline = (at.x_mm + 1.0, at.y_mm + 0.5 * (STRIP_MM - 0.7 * size_mm));
    let mut marks = vec![
        Mark::black(outlines),
        Mark::text(baseline, size_mm, TextAnchor::Left, name),
    ];
    marks.extend(Mark::outline(&card.outline(), LINE_MM));
    marks
}
