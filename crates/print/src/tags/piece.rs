//! Pieces to cut out of shared pages: tent cards, plain cards and place strips.

use super::{Instead, TagPrintError};
use crate::frame::PageFrame;
use crate::media::Media;
use crate::pack::{self, Spot};
use crate::paper::Stock;
use crate::sheet::{Mark, RectMm};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::size;

type Draw<'a> = Box<dyn Fn(Point2) -> Result<Vec<Mark>, TagPrintError> + 'a>;

pub struct CutPiece<'a> {
    pub size_mm: (f64, f64),
    pub name: String,
    /// Name of the piece in errors; `instead` is the advice they give.
    pub what: String,
    pub instead: Instead,
    /// Draws its marks, with its lower left corner at a point of the page.
    pub draw: Draw<'a>,
}

pub struct PiecePage {
    pub page: PageFrame,
    pub marks: Vec<Mark>,
    /// Name and area of each piece on the page.
    pub names: Vec<(String, RectMm)>,
}

/// Distributes pieces over the fewest pages, with the paper upright or across.
pub fn spread(pieces: &[CutPiece], media: Media) -> Result<Vec<PiecePage>, TagPrintError> {
    if pieces.is_empty() {
        return Ok(Vec::new());
    }
    let (page, spots) = placed(pieces, media)?;
    let mut pages = Vec::new();
    for number in 0..count(&spots) {
        // A roll is cut off below its lowest piece.
        let bottoms = spots.iter().filter(|spot| spot.page == number).map(|spot| spot.at[1]);
        let lowest = bottoms.fold(page.usable.top_mm, f64::min);
        pages.push(PiecePage {
            page: page.cut_off(media.paper, page.usable.top_mm - lowest)?,
            marks: Vec::new(),
            names: Vec::new(),
        });
    }
    for (piece, spot) in pieces.iter().zip(&spots) {
        let on = &mut pages[spot.page];
        // A page cut from a roll is lower than the planned one.
        let down = page.usable.top_mm - on.page.usable.top_mm;
        let at = [spot.at[0], spot.at[1] - down];
        on.marks.extend((piece.draw)(at)?);
        on.names.push((piece.name.clone(), RectMm::sized(at, piece.size_mm)));
    }
    Ok(pages)
}

/// Returns the place of each piece.
///
/// # Errors
/// Paper too small for the rulers or for a piece.
pub fn placed(pieces: &[CutPiece], media: Media) -> Result<(PageFrame, Vec<Spot>), TagPrintError> {
    let sizes: Vec<_> = pieces.iter().map(|piece| piece.size_mm).collect();
    let name = |thing: usize| {
        let piece = pieces.get(thing);
        piece.map_or((String::new(), Instead::Nothing), |piece| {
            (piece.what.clone(), piece.instead)
        })
    };
    packed(&sizes, media, name)
}

/// Returns the number of pages for pieces of some sizes.
pub fn pages(sizes: &[(f64, f64)], media: Media) -> Result<usize, TagPrintError> {
    let unnamed = |_| ("a card".to_owned(), Instead::Nothing);
    Ok(count(&packed(sizes, media, unnamed)?.1))
}

fn count(spots: &[Spot]) -> usize {
    spots.iter().map(|spot| spot.page + 1).max().unwrap_or(0)
}

fn packed(
    sizes: &[(f64, f64)],
    media: Media,
    name: impl Fn(usize) -> (String, Instead),
) -> Result<(PageFrame, Vec<Spot>), TagPrintError> {
    let mut best: Option<(PageFrame, Vec<Spot>)> = None;
    let mut refused = None;
    for page in media.both_ways()? {
        // Pieces stand in rows across a roll, so that it can be cut off below the last one.
        if page.setup.turned && matches!(media.paper, Stock::Roll { .. }) {
            continue;
        }
        match pack::tight(sizes, page.usable) {
            Ok(spots) if best.as_ref().is_none_or(|(_, held)| count(&spots) < count(held)) => {
                best = Some((page, spots))
            }
            Ok(_) => {}
            Err(thing) => refused = refused.or(Some((thing, page.usable_size()))),
        }
    }
    best.ok_or_else(|| {
        let (thing, free) = refused.unwrap_or_default();
        let (what, instead) = name(thing);
        TagPrintError::TooLarge {
            what,
            needed_mm: size(sizes.get(thing).copied().unwrap_or_default()),
            free_mm: size(free),
            instead,
        }
    })
}
