//! Pages on which pieces are nested: their frames, and the place of each piece.

use super::labels::{Label, Signs};
use super::nest::{self, Place};
use super::{PiecesError, PiecesRequest};
use scaleproof_core::geometry::{Point2, circle, distance, offset};
use scaleproof_print::frame::{CROP_STRIP_MM, FOOTER_MM, PageFrame};
use scaleproof_print::paper::Stock;
use scaleproof_print::ruler;
use scaleproof_print::sheet::{Mark, RectMm, Sheet, TextAnchor};
use scaleproof_print::template::Captions;
use scaleproof_print::wrap::Region;

const SHEET_MM: f64 = 5.0;
const SHEET_WIDTH_MM: f64 = 22.0;

/// Returns the page upright and across, as far as the paper allows; for a roll only across it.
pub fn frames(request: &PiecesRequest) -> Result<Vec<PageFrame>, PiecesError> {
    let media = request.sheets.media;
    Ok(match media.paper {
        Stock::Cut(_) => media.both_ways()?,
        Stock::Roll { .. } => vec![media.frame(false)?],
    })
}

/// Returns the successful results, or the first error if there is none.
fn good_ones<T, E>(results: impl Iterator<Item = Result<T, E>>) -> Result<Vec<T>, E> {
    let (good, bad): (Vec<_>, Vec<_>) = results.partition(Result::is_ok);
    match bad.into_iter().find_map(Result::err) {
        Some(error) if good.is_empty() => Err(error),
        _ => Ok(good.into_iter().flatten().collect()),
    }
}

/// Returns the largest size of a piece that fits on one of the pages with `around_mm` on all sides.
pub fn fits_mm(request: &PiecesRequest, around_mm: f64) -> Result<[f64; 2], PiecesError> {
    let size = |frame: &PageFrame| {
        [frame.usable.width_mm(), frame.usable.height_mm()].map(|mm| (mm - 2.0 * around_mm - 4.0).max(0.0))
    };
    let sizes = frames(request)?.into_iter().map(|frame| size(&frame));
    Ok(sizes
        .max_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1])))
        .unwrap_or_default())
}

/// Returns the part of a piece's plane that needs paper of its own: its ink and its signs.
pub fn shape(ink: &Region, signs: &Signs) -> Region {
    let disc = |label: &Label| circle(label.at, label.radius_mm * 1.02, 16).collect::<Vec<Point2>>();
    let bar = |[a, b]: [Point2; 2]| {
        let length = distance(a, b).max(f64::MIN_POSITIVE);
        let aside = [0.3 * (a[1] - b[1]) / length, 0.3 * (b[0] - a[0]) / length];
        [(a, -1.0), (b, -1.0), (b, 1.0), (a, 1.0)]
            .map(|(p, sign)| offset(p, aside, sign))
            .to_vec()
    };
    let lines = signs.leaders().chain(signs.ticks.iter().copied());
    ink.or(&Region::union(
        signs.labels.iter().map(disc).chain(lines.map(bar)).collect(),
    ))
}

/// Nests the pieces on the page orientation that needs fewer sheets.
pub fn nested(
    shapes: &[Region],
    frames: &[PageFrame],
    taken: impl Fn(&PageFrame) -> Vec<RectMm>,
) -> Result<(PageFrame, Vec<Place>), PiecesError> {
    let tried = frames.iter().map(|frame| {
        let places = nest::nest(shapes, frame.printable, &taken(frame));
        places
            .map(|places| (*frame, places))
            .map_err(|i| PiecesError::TooLarge { piece: i + 1 })
    });
    let best = good_ones(tried)?.into_iter().min_by_key(|(_, places)| sheets(places));
    best.ok_or(PiecesError::TooLarge { piece: 1 })
}

/// Returns the areas of a page taken by rulers and captions.
pub fn furniture(frame: &PageFrame) -> Vec<RectMm> {
    const AIR_MM: f64 = 2.0;
    let (printable, usable) = (frame.printable, frame.usable);
    let end = ruler::LENGTH_MM + 2.0 * AIR_MM;
    [
        (printable.right_mm, printable.bottom_mm + FOOTER_MM + AIR_MM),
        (usable.left_mm + end, usable.bottom_mm - CROP_STRIP_MM + AIR_MM),
        (usable.left_mm - CROP_STRIP_MM + AIR_MM, usable.bottom_mm + end),
    ]
    .map(|(right, top)| RectMm::new(printable.left_mm, printable.bottom_mm, right, top))
    .to_vec()
}

/// Returns each sheet's frame; for a roll, as long as its pieces.
pub fn sheet_frames(
    frame: &PageFrame,
    shapes: &[Region],
    places: &[Place],
    request: &PiecesRequest,
) -> Result<Vec<PageFrame>, PiecesError> {
    let top = |page: usize| {
        let on_page = places.iter().zip(shapes).filter(|(place, _)| place.page == page);
        let tops = on_page.filter_map(|(place, shape)| Some(shape.moved(|p| place.pose.at(p)).bounds()?.1[1]));
        tops.fold(0.0, f64::max)
    };
    let one = |page: usize| frame.cut_off(request.sheets.media.paper, top(page) - frame.usable.bottom_mm);
    Ok((0..sheets(places)).map(one).collect::<Result<_, _>>()?)
}

pub fn sheets(places: &[Place]) -> usize {
    places.iter().map(|place| place.page + 1).max().unwrap_or(0)
}

/// Returns the first page's frame: as the sheets', for a roll as long as needed.
pub fn cover_frame(frame: &PageFrame, request: &PiecesRequest) -> Result<PageFrame, PiecesError> {
    const ROLL_MM: f64 = 280.0;
    Ok(frame.cut_off(request.sheets.media.paper, ROLL_MM)?)
}

/// Returns one page with its marks, rulers, captions, and page number.
pub fn sheet(frame: &PageFrame, marks: Vec<Mark>, captions: &Captions, (page, pages): (usize, usize)) -> Sheet {
    let mut sheet = captions.sheet(frame, marks);
    let at = [frame.printable.right_mm, frame.printable.bottom_mm + 0.8];
    let label = format!("{} of {pages}", page + 1);
    let room = (SHEET_MM, SHEET_WIDTH_MM);
    sheet.marks.push(Mark::fitted(at, room, TextAnchor::Right, label));
    sheet
}
