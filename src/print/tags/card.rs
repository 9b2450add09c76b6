//! Plain cards: one tag each, upright, inside a cut line.

use super::{LINE_MM, TagPrintError, captions, family_name, image_of, on_pages, packed};
use crate::print::lettering::{fitting_size_mm, number};
use crate::print::page::Media;
use crate::print::shapes::{Placement, black_modules};
use crate::print::sheet::{Anchor, BLACK, Mark, PointMm, RectMm, Sheet};
use crate::scene::{Scene, Tag};
use crate::tags::TagImage;

/// Below the tag, for its name.
const STRIP_MM: f64 = 7.0;
const TEXT_MM: f64 = 3.0;
const UP_MM: f64 = 3.0;

/// The pages with one card for each tag.
pub fn sheets(tags: &[&Tag], scene: &Scene, media: Media) -> Result<Vec<Sheet>, TagPrintError> {
    let images = tags.iter().map(|tag| image_of(tag)).collect::<Result<Vec<_>, _>>()?;
    let width = |i: usize| images[i].width_mm(tags[i].size_mm);
    let sizes: Vec<_> = (0..tags.len()).map(|i| (width(i), width(i) + STRIP_MM)).collect();
    if sizes.is_empty() {
        return Ok(Vec::new());
    }
    let (page, spots) = packed(&sizes, media, |i| format!("the card of tag {}", tags[i].id), "")?;
    let drawn = spots.iter().zip(tags.iter().zip(&images));
    let drawn = drawn.map(|(spot, (tag, image))| marks(tag, image, spot.at)).collect();
    let pages = on_pages(&spots, drawn);
    let how_to = [
        "Cut along the solid lines; the white around a tag belongs to it.",
        "Fix each card where the scene file says, with its triangle towards the tag's up direction.",
    ];
    let count = pages.len();
    let sheet = |(i, marks)| {
        page.sheet(
            marks,
            &captions(scene, media, how_to),
            &format!("cards {}/{count}", i + 1),
        )
    };
    Ok(pages.into_iter().enumerate().map(sheet).collect())
}

fn marks(tag: &Tag, image: &TagImage, at: PointMm) -> Vec<Mark> {
    let width = image.width_mm(tag.size_mm);
    let card = RectMm::new(at.x_mm, at.y_mm, at.x_mm + width, at.y_mm + STRIP_MM + width);
    let place = Placement {
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
    let mut marks = vec![Mark::Area {
        outlines,
        colour: BLACK,
    }];
    let name = format!(
        "id {} · {} · {} mm",
        tag.id,
        family_name(tag.family),
        number(tag.size_mm)
    );
    let size_mm = fitting_size_mm(&name, TEXT_MM, (width - UP_MM - 4.0).max(1.0));
    let baseline = (at.x_mm + 1.0, at.y_mm + 0.5 * (STRIP_MM - 0.7 * size_mm));
    marks.push(Mark::text(baseline, size_mm, Anchor::Left, name));
    marks.extend(cut_line(card));
    marks
}

fn cut_line(card: RectMm) -> [Mark; 4] {
    let (l, b, r, t) = (card.left_mm, card.bottom_mm, card.right_mm, card.top_mm);
    [((l, b), (r, b)), ((r, b), (r, t)), ((r, t), (l, t)), ((l, t), (l, b))]
        .map(|(from, to)| Mark::line(from, to, LINE_MM))
}
