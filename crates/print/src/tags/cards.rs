//! Drawing of cards: plain ones, one tag each, upright, inside a cut line; tent cards, cut lines solid, fold lines dashed, a tag on each face.

use super::piece::CutPiece;
use super::tent::{FlatTag, Fold, Net, SIDE_MM, Tent};
use super::{Instead, LINE_MM, TagPrintError, image_of};
use crate::shapes::{TagPlacement, black_modules};
use crate::sheet::{BLACK, Mark, RectMm, TextAnchor, sides};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::{fitting_size_mm, number};
use scaleproof_pose::scene::Tag;
use scaleproof_pose::tags::TagImage;

const TEXT_MM: f64 = 3.0;
/// Height of the strip below the tag of a plain card, for its name.
const STRIP_MM: f64 = 7.0;
const PLAIN_UP_MM: f64 = 3.0;
const TITLE_MM: f64 = 7.0;
const LEADING_MM: f64 = 4.2;
const UP_MM: f64 = 4.0;
/// Length of the mark at the middle of a face's foot; the tag's white ring begins above it.
const MIDDLE_MM: f64 = 1.5;
const DASH_MM: (f64, f64) = (3.0, 2.0);

pub fn plain<'a>(tags: &[&'a Tag]) -> Result<Vec<CutPiece<'a>>, TagPrintError> {
    let piece = |tag: &&'a Tag| {
        let (tag, image) = (*tag, image_of(tag)?);
        let width = image.width_mm(tag.size_mm);
        Ok(CutPiece {
            size_mm: (width, width + STRIP_MM),
            name: format!("id {}", tag.id),
            what: format!("the card of tag {}", tag.id),
            instead: Instead::Nothing,
            draw: Box::new(move |at| Ok(plain_marks(tag, &image, at))),
        })
    };
    tags.iter().map(piece).collect()
}

fn plain_marks(tag: &Tag, image: &TagImage, at: Point2) -> Vec<Mark> {
    let width = image.width_mm(tag.size_mm);
    let card = RectMm::new(at[0], at[1], at[0] + width, at[1] + STRIP_MM + width);
    let centre = [at[0] + width / 2.0, at[1] + STRIP_MM + width / 2.0];
    let place = TagPlacement::new(image, tag.size_mm, centre, [1.0, 0.0]);
    let mut outlines = black_modules(image.modules(), &place);
    outlines.push(place.up_mark(
        width / 2.0 - PLAIN_UP_MM / 2.0 - 1.0,
        -width / 2.0 - 0.5 * (STRIP_MM + PLAIN_UP_MM),
        PLAIN_UP_MM,
    ));
    let name = format!("id {} · {} · {} mm", tag.id, tag.family.name(), number(tag.size_mm));
    let size_mm = fitting_size_mm(&name, TEXT_MM, (width - PLAIN_UP_MM - 4.0).max(1.0));
    let baseline = [at[0] + 1.0, at[1] + 0.5 * (STRIP_MM - 0.7 * size_mm)];
    let mut marks = vec![
        Mark::black(outlines),
        Mark::text(baseline, size_mm, TextAnchor::Left, name),
    ];
    marks.extend(Mark::outline(&card.outline(), LINE_MM, BLACK));
    marks
}

/// Returns the cards of some tents; tent `i` is named T`i + 1`.
pub fn tents(tents: &[Tent]) -> Vec<CutPiece<'_>> {
    let piece = |(i, tent): (usize, &'_ Tent)| {
        let (net, tent) = (tent.net(), tent.clone());
        let [a, b] = [tent.tags[0].id, tent.tags[1].id];
        CutPiece {
            size_mm: (net.width_mm, net.height_mm),
            name: format!("T{}", i + 1),
            what: format!("tent card T{} (tags {a} and {b})", i + 1),
            instead: Instead::PlainCards,
            draw: Box::new(move |at| tent_marks(i + 1, &tent, &net, at)),
        }
    };
    tents.iter().enumerate().map(piece).collect()
}

/// Draws one card whose flat frame begins at `at` on the page.
fn tent_marks(number: usize, tent: &Tent, net: &Net, at: Point2) -> Result<Vec<Mark>, TagPrintError> {
    let mut marks = Vec::new();
    for flat in &net.tags {
        marks.push(tag_marks(flat, net, at)?);
        marks.extend(face_text(number, flat, at));
    }
    marks.extend(base_text(number, tent, net, at));
    let tab = "glue to the inside of the base";
    // The tab narrows towards its edge; its text keeps clear of the slants.
    let tab_size = (TEXT_MM, 0.7 * net.width_mm);
    let tab_at = [at[0] + net.width_mm / 2.0, at[1] + 0.5 * net.folds[0].y_mm - 1.0];
    marks.push(Mark::fitted(tab_at, tab_size, TextAnchor::Centre, tab));
    marks.extend(lines(net, at));
    Ok(marks)
}

fn tag_marks(flat: &FlatTag, net: &Net, at: Point2) -> Result<Mark, TagPrintError> {
    let image = image_of(&flat.tag)?;
    let centre = [at[0] + flat.centre_mm.x, at[1] + flat.centre_mm.y];
    let place = TagPlacement::new(&image, flat.tag.size_mm, centre, flat.right.into());
    let mut outlines = black_modules(image.modules(), &place);
    // The up mark is beside the tag, in the middle of the card's free strip.
    let mark = TagPlacement {
        centre: [at[0] + net.width_mm - SIDE_MM / 2.0, place.centre[1]],
        ..place
    };
    outlines.push(mark.up_mark(0.0, -UP_MM / 2.0, UP_MM));
    Ok(Mark::black(outlines))
}

/// Draws the card's name and the tag's id, in the strip to the left of the tag.
fn face_text(number: usize, flat: &FlatTag, at: Point2) -> Vec<Mark> {
    let lines = [format!("T{number}"), "id".to_owned(), flat.tag.id.to_string()];
    let x = at[0] + SIDE_MM / 2.0;
    let middle = at[1] + flat.centre_mm.y + 0.5 * LEADING_MM;
    let place = |(i, line): (usize, String)| {
        let at = [x, middle - i as f64 * LEADING_MM];
        Mark::fitted(at, (TEXT_MM, SIDE_MM - 2.0), TextAnchor::Centre, line)
    };
    lines.into_iter().enumerate().map(place).collect()
}

/// Draws the description of the card on its base.
fn base_text(number: usize, tent: &Tent, net: &Net, at: Point2) -> Vec<Mark> {
    let [a, b] = &tent.tags;
    let family = |tag: &Tag| format!("{} · {} mm", tag.family.name(), mm(tag.size_mm));
    let [family_a, family_b] = [a, b].map(family);
    let families = if family_a == family_b {
        family_a
    } else {
        format!("{family_a}; {family_b}")
    };
    let lines = [
        (TITLE_MM, format!("T{number}")),
        (TEXT_MM, format!("tags {} and {}", a.id, b.id)),
        (TEXT_MM, families),
        (TEXT_MM, format!("faces at {}° to the ground", mm(tent.tilt_deg))),
    ];
    let middle = [
        at[0] + net.width_mm / 2.0,
        at[1] + net.folds[2].y_mm + tent.base_mm / 2.0,
    ];
    let place = |(i, (size_mm, line)): (usize, (f64, String))| {
        let size_mm = fitting_size_mm(&line, size_mm, net.width_mm - 4.0).min(0.15 * tent.base_mm.max(7.0));
        let baseline = middle[1] + (1.0 - i as f64) * LEADING_MM.min(tent.base_mm / 5.0);
        Mark::text([middle[0], baseline], size_mm, TextAnchor::Centre, line)
    };
    lines.into_iter().enumerate().map(place).collect()
}

fn mm(value: f64) -> String {
    number((value * 100.0).round() / 100.0)
}

/// Draws cut lines around the card, fold lines across it.
fn lines(net: &Net, at: Point2) -> Vec<Mark> {
    let page = |[x, y]: [f64; 2]| [at[0] + x, at[1] + y];
    let line = |from, to, dash_mm| Mark::stroke([page(from), page(to)], LINE_MM, dash_mm, BLACK);
    let (tab, w, h) = (net.tab, net.width_mm, net.height_mm);
    let fold = |fold: Fold| line([0.0, fold.y_mm], [w, fold.y_mm], Some(DASH_MM));
    let folds = net.folds.map(fold);
    let around = [tab[0], tab[1], tab[2], [w, h], [0.0, h], tab[3]];
    let cuts = sides(&around).map(|(from, to)| line(*from, *to, None));
    // Middles of the faces' feet, to be aligned with the marks on the ground.
    let feet = [(net.folds[0].y_mm, MIDDLE_MM), (net.folds[2].y_mm, -MIDDLE_MM)];
    let middles = feet.map(|(y, up)| line([w / 2.0, y], [w / 2.0, y + up], None));
    cuts.chain(folds).chain(middles).collect()
}
