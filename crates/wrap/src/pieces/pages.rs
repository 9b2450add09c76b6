//! The pages that pieces are nested on: their frames, and where each piece lies.

use super::labels::{Label, Signs};
use super::nest::{self, Place};
use super::{PiecesError, PiecesRequest};
use scaleproof_core::geometry::distance;
use scaleproof_plot::lettering::fitting_size_mm;
use scaleproof_print::print::frame::{CROP_STRIP_MM, FOOTER_MM, PageFrame, PageSetup};
use scaleproof_print::print::paper::{MAX_SIDE_MM, Stock};
use scaleproof_print::print::ruler;
use scaleproof_print::print::sheet::{Mark, RectMm, Sheet, TextAnchor};
use scaleproof_print::print::template::layout::{cut_from_roll, roll_page};
use scaleproof_print::print::template::{Captions, rulers};
use scaleproof_print::print::wrap::{Point, Region};

const SHEET_MM: f64 = 5.0;
const SHEET_WIDTH_MM: f64 = 22.0;

/// The page upright and across, as far as the paper allows; of a roll only across it.
pub fn frames(request: &PiecesRequest) -> Result<Vec<PageFrame>, PiecesError> {
    let frame = |turned: bool| {
        let setup = PageSetup {
            margin_mm: request.margin_mm,
            printer: request.printer,
            turned,
        };
        let page = match request.paper {
            Stock::Cut(paper) if turned => paper.landscape(),
            Stock::Cut(paper) => paper.portrait(),
            Stock::Roll { width_mm } => roll_page(width_mm, MAX_SIDE_MM, turned),
        };
        PageFrame::new(page, setup)
    };
    let turns: &[bool] = match request.paper {
        Stock::Cut(_) => &[false, true],
        Stock::Roll { .. } => &[false],
    };
    let (good, bad): (Vec<_>, Vec<_>) = turns.iter().map(|turned| frame(*turned)).partition(Result::is_ok);
    match (good.is_empty(), bad.into_iter().find_map(Result::err)) {
        (true, Some(error)) => Err(error.into()),
        _ => Ok(good.into_iter().flatten().collect()),
    }
}

/// What a piece may measure so that it fits on one of the pages with all that stands around it.
///
/// # Errors
/// Paper too small for rulers.
pub fn fits_mm(request: &PiecesRequest, around_mm: f64) -> Result<[f64; 2], PiecesError> {
    let size = |frame: &PageFrame| {
        [frame.usable.width_mm(), frame.usable.height_mm()].map(|mm| (mm - 2.0 * around_mm - 4.0).max(0.0))
    };
    let sizes = frames(request)?.into_iter().map(|frame| size(&frame));
    Ok(sizes
        .max_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1])))
        .unwrap_or_default())
}

/// Everything of a piece that needs paper of its own, in its plane: its ink and its signs.
pub fn shape(ink: &Region, signs: &Signs) -> Region {
    let disc = |label: &Label| {
        let corner = |i: usize| {
            let (s, c) = (f64::from(i as u32) * std::f64::consts::TAU / 16.0).sin_cos();
            let radius = label.radius_mm * 1.02;
            [label.at[0] + radius * c, label.at[1] + radius * s]
        };
        (0..16).map(corner).collect::<Vec<Point>>()
    };
    let bar = |[a, b]: [Point; 2]| {
        let length = distance(a, b).max(f64::MIN_POSITIVE);
        let aside = [0.3 * (a[1] - b[1]) / length, 0.3 * (b[0] - a[0]) / length];
        let beside = |p: Point, sign: f64| [p[0] + sign * aside[0], p[1] + sign * aside[1]];
        vec![beside(a, -1.0), beside(b, -1.0), beside(b, 1.0), beside(a, 1.0)]
    };
    let leaders = signs.labels.iter().map(|label| bar([label.names, label.at]));
    let ticks = signs.ticks.iter().map(|tick| bar(*tick));
    let signs = signs.labels.iter().map(disc).chain(leaders).chain(ticks).collect();
    ink.or(&Region::union(signs))
}

/// The pieces on whichever way round the page needs fewer sheets.
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
    let (good, bad): (Vec<_>, Vec<_>) = tried.partition(Result::is_ok);
    let sheets = |(_, places): &(PageFrame, Vec<Place>)| places.iter().map(|place| place.page).max();
    let best = good.into_iter().flatten().min_by_key(sheets);
    let error = bad.into_iter().find_map(Result::err);
    best.ok_or(error.unwrap_or(PiecesError::TooLarge { piece: 1 }))
}

/// What rulers and captions take of a page.
pub fn furniture(frame: &PageFrame) -> Vec<RectMm> {
    const AIR_MM: f64 = 2.0;
    let (printable, usable) = (frame.printable, frame.usable);
    let end = ruler::LENGTH_MM + 2.0 * AIR_MM;
    vec![
        RectMm::new(
            printable.left_mm,
            printable.bottom_mm,
            printable.right_mm,
            printable.bottom_mm + FOOTER_MM + AIR_MM,
        ),
        RectMm::new(
            printable.left_mm,
            printable.bottom_mm,
            usable.left_mm + end,
            usable.bottom_mm - CROP_STRIP_MM + AIR_MM,
        ),
        RectMm::new(
            printable.left_mm,
            printable.bottom_mm,
            usable.left_mm - CROP_STRIP_MM + AIR_MM,
            usable.bottom_mm + end,
        ),
    ]
}

/// Each sheet's frame; of a roll, as long as its pieces.
pub fn sheet_frames(
    frame: &PageFrame,
    shapes: &[Region],
    places: &[Place],
    request: &PiecesRequest,
) -> Result<Vec<PageFrame>, PiecesError> {
    let pages = places.iter().map(|place| place.page + 1).max().unwrap_or(0);
    let top = |page: usize| {
        let on_page = places.iter().zip(shapes).filter(|(place, _)| place.page == page);
        let tops = on_page.filter_map(|(place, shape)| Some(shape.moved(|p| place.pose.at(p)).bounds()?.1[1]));
        tops.fold(0.0, f64::max)
    };
    let one = |page: usize| match request.paper {
        Stock::Cut(_) => Ok(*frame),
        Stock::Roll { width_mm } => {
            let length = top(page) - frame.usable.bottom_mm;
            Ok(PageFrame::new(
                cut_from_roll(width_mm, length, &frame.setup),
                frame.setup,
            )?)
        }
    };
    (0..pages).map(one).collect()
}

/// The first page's frame: as the sheets', of a roll as long as it takes.
pub fn cover_frame(frame: &PageFrame, request: &PiecesRequest) -> Result<PageFrame, PiecesError> {
    const ROLL_MM: f64 = 280.0;
    match request.paper {
        Stock::Cut(_) => Ok(*frame),
        Stock::Roll { width_mm } => Ok(PageFrame::new(
            cut_from_roll(width_mm, ROLL_MM, &frame.setup),
            frame.setup,
        )?),
    }
}

/// One page: what is on it, rulers, captions, and which page it is.
pub fn sheet(frame: &PageFrame, mut marks: Vec<Mark>, captions: &Captions, (page, pages): (usize, usize)) -> Sheet {
    marks.extend(rulers(frame));
    marks.extend(captions.marks(frame.printable));
    let label = format!("{} of {pages}", page + 1);
    let size_mm = fitting_size_mm(&label, SHEET_MM, SHEET_WIDTH_MM);
    let at = (frame.printable.right_mm, frame.printable.bottom_mm + 0.8);
    marks.push(Mark::text(at, size_mm, TextAnchor::Right, label));
    frame.sheet(frame.whole(), frame.whole(), marks)
}
