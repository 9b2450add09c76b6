//! What is cut out of shared pages: tent cards, plain cards and place strips.

use super::{Instead, LINE_MM, TagPrintError};
use crate::print::pack::{self, Spot};
use crate::print::page::{FreePage, Media};
use crate::print::paper::Stock;
use crate::print::sheet::{Mark, PointMm, RectMm};
use scaleproof_plot::lettering::size;

type Draw<'a> = Box<dyn Fn(PointMm) -> Result<Vec<Mark>, TagPrintError> + 'a>;

/// One thing to cut out.
pub struct CutPiece<'a> {
    pub size_mm: (f64, f64),
    /// What the map calls it.
    pub name: String,
    /// What an error calls it, and what else could be done then.
    pub what: String,
    pub instead: Instead,
    /// Its marks, with its lower left corner at a place of the page.
    pub draw: Draw<'a>,
}

/// A page with pieces.
pub struct PiecePage {
    pub page: FreePage,
    pub marks: Vec<Mark>,
    /// What lies where: name and area.
    pub names: Vec<(String, RectMm)>,
}

/// Spreads pieces over the fewest pages, the paper used upright or across.
///
/// # Errors
/// Paper too small for the rulers or for a piece, and whatever the drawing refuses.
pub fn spread(pieces: &[CutPiece], media: Media) -> Result<Vec<PiecePage>, TagPrintError> {
    if pieces.is_empty() {
        return Ok(Vec::new());
    }
    let (page, spots) = placed(pieces, media)?;
    let mut pages: Vec<PiecePage> = (0..count(&spots))
        .map(|number| cut_off(page, media, number, &spots))
        .collect::<Result<_, _>>()?;
    for (piece, spot) in pieces.iter().zip(&spots) {
        let on = &mut pages[spot.page];
        // A page that was cut off a roll is lower than the one that was planned on.
        let down = page.0.usable.top_mm - on.page.0.usable.top_mm;
        let at = PointMm::new(spot.at.x_mm, spot.at.y_mm - down);
        let (width, height) = piece.size_mm;
        let area = RectMm::new(at.x_mm, at.y_mm, at.x_mm + width, at.y_mm + height);
        on.marks.extend((piece.draw)(at)?);
        on.names.push((piece.name.clone(), area));
    }
    Ok(pages)
}

/// Where each piece lies.
fn placed(pieces: &[CutPiece], media: Media) -> Result<(FreePage, Vec<Spot>), TagPrintError> {
    let sizes: Vec<_> = pieces.iter().map(|piece| piece.size_mm).collect();
    let name = |thing: usize| {
        pieces.get(thing).map_or((String::new(), Instead::Nothing), |piece| {
            (piece.what.clone(), piece.instead)
        })
    };
    packed(&sizes, media, name)
}

/// Refuses pieces that are larger than the paper.
///
/// # Errors
/// As [`spread`].
pub fn check(pieces: &[CutPiece], media: Media) -> Result<(), TagPrintError> {
    placed(pieces, media).map(|_| ())
}

/// How many pages things of some sizes take.
///
/// # Errors
/// As [`spread`].
pub fn pages(sizes: &[(f64, f64)], media: Media) -> Result<usize, TagPrintError> {
    let unnamed = |_| ("a card".to_owned(), Instead::Nothing);
    if sizes.is_empty() {
        Ok(0)
    } else {
        Ok(count(&packed(sizes, media, unnamed)?.1))
    }
}

fn count(spots: &[Spot]) -> usize {
    spots.iter().map(|spot| spot.page + 1).max().unwrap_or(0)
}

/// One page, on a roll no longer than its pieces need.
fn cut_off(page: FreePage, media: Media, number: usize, spots: &[Spot]) -> Result<PiecePage, TagPrintError> {
    let bottoms = spots.iter().filter(|spot| spot.page == number).map(|spot| spot.at.y_mm);
    let lowest = bottoms.fold(page.0.usable.top_mm, f64::min);
    Ok(PiecePage {
        page: page.shortened(media, page.0.usable.top_mm - lowest)?,
        marks: Vec::new(),
        names: Vec::new(),
    })
}

fn packed(
    sizes: &[(f64, f64)],
    media: Media,
    name: impl Fn(usize) -> (String, Instead),
) -> Result<(FreePage, Vec<Spot>), TagPrintError> {
    let mut best: Option<(FreePage, Vec<Spot>)> = None;
    let mut refused = None;
    for page in FreePage::both_ways(media)? {
        // Things stand in rows across a roll, so that it can be cut off below the last one.
        if page.0.setup.turned && matches!(media.paper, Stock::Roll { .. }) {
            continue;
        }
        match pack::tight(sizes, page.0.usable) {
            Ok(spots) => {
                if best.as_ref().is_none_or(|(_, held)| count(&spots) < count(held)) {
                    best = Some((page, spots));
                }
            }
            Err(thing) => refused = refused.or(Some((thing, page.0.usable))),
        }
    }
    best.ok_or_else(|| {
        let (thing, area) = refused.unwrap_or((0, RectMm::new(0.0, 0.0, 0.0, 0.0)));
        let (what, instead) = name(thing);
        TagPrintError::TooLarge {
            what,
            needed_mm: size(sizes.get(thing).copied().unwrap_or_default()),
            free_mm: size((area.width_mm(), area.height_mm())),
            instead,
        }
    })
}

/// Solid lines around what is cut out.
pub fn cut_line(area: RectMm) -> [Mark; 4] {
    let (l, b, r, t) = (area.left_mm, area.bottom_mm, area.right_mm, area.top_mm);
    [((l, b), (r, b)), ((r, b), (r, t)), ((r, t), (l, t)), ((l, t), (l, b))]
        .map(|(from, to)| Mark::line(from, to, LINE_MM))
}
