//! The sheets: each piece where it was nested, its texture, its lines and its signs.

use std::convert::Infallible;
use std::sync::Arc;

use image::RgbImage;

use super::flat::Piece;
use super::labels::{self, Label, NUMBER_RING_MM, Signs};
use super::nest::{self, Place};
use super::seams;
use super::tabs::{self, Tabs};
use super::{AROUND_MM, BLEED_MM, PiecesError, PiecesRequest, PrintedPieces, Room, cover};
use crate::geometry::{distance, length};
use crate::mesh::Mesh;
use crate::print::frame::{CROP_STRIP_MM, FOOTER_MM, PageFrame, PageSetup};
use crate::print::lettering::{CAP_HEIGHT, fitting_size_mm};
use crate::print::paper::{MAX_SIDE_MM, Stock};
use crate::print::printer;
use crate::print::raster::{self, FlatPaint, PixelGrid, Pose};
use crate::print::ruler;
use crate::print::sheet::{BLACK, Mark, PointMm, RectMm, Sheet, TextAnchor, WHITE};
use crate::print::template::layout::{cut_from_roll, roll_page};
use crate::print::template::{Captions, cell_mm, check_scale, rulers};
use crate::print::wrap::{CUT_ROOM_MM, EDGE_DASH_MM, EDGE_LINE_MM, Point, Region, cut_line, moved};
use crate::texture::Texture;
use crate::unwrap::Unwrapped;
use crate::workers;

const LETTER_MM: f64 = 3.0;
const NUMBER_MM: f64 = 3.8;
const LINE_MM: f64 = 0.15;
/// Under a line that crosses the bleed, so that it shows on any colour.
const HALO_MM: f64 = 0.45;
/// From the outline to the middle of the halo, which begins where the line to cut ends.
const CUT_HALO_MM: f64 = 0.45;
const FOLD_DASH_MM: (f64, f64) = (1.5, 1.0);
const SHEET_MM: f64 = 5.0;
const SHEET_WIDTH_MM: f64 = 22.0;

/// Draws everything.
pub(crate) fn pieces(
    mesh: &Mesh,
    flat: &Unwrapped,
    texture: &Texture,
    request: &PiecesRequest,
) -> Result<PrintedPieces, PiecesError> {
    check_scale(request.scale)?;
    if let Texture::Tile(tile) = texture {
        cell_mm(&tile.pattern, &request.template().tiled(tile.tile_mm()))?;
    }
    raster::check(request.dpi, 0.0)?;
    let tabs_mm = request.tabs_mm.map(length::tab_mm).transpose()?;
    let room = room(tabs_mm);
    let frames = frames(request)?;
    let pieces: Vec<Piece> = flat
        .charts
        .iter()
        .map(|chart| Piece::new(chart, &flat.points_mm))
        .collect();
    let seams = seams::seams(&pieces);
    let tabs = tabs::tabs(&pieces, &seams, tabs_mm);
    let outlines: Vec<Outlines> = pieces
        .iter()
        .zip(&tabs.tabs)
        .map(|(p, t)| Outlines::new(p, t))
        .collect();
    let inks: Vec<Region> = outlines.iter().map(|o| o.ink.clone()).collect();
    let signs = labels::signs(&pieces, &seams, &inks, &tabs.sides, &room);
    let shapes: Vec<Region> = outlines.iter().zip(&signs.signs).map(|(o, s)| shape(o, s)).collect();
    let (frame, places) = nested(&shapes, &frames)?;
    let sheet_frames = sheet_frames(&frame, &shapes, &places, request)?;
    raster::check(request.dpi, boxes_mm2(&pieces, &places))?;
    let all: Vec<usize> = (0..pieces.len()).collect();
    let images = workers::map(
        &all,
        || Ok::<_, Infallible>(()),
        |_, i| {
            let frame = &sheet_frames[places[*i].page];
            Ok(image_of((mesh, texture), &pieces[*i], &places[*i], frame, request.dpi))
        },
        || (),
    );
    let images = match images {
        Ok(images) => images,
        Err(never) => match never {},
    };
    let mut made = PrintedPieces {
        cut: outlines.iter().map(|o| o.cut.clone()).collect(),
        unlettered_mm: signs.unlettered_mm,
        left_out: flat.left_out.clone(),
        visible_mm2: flat.visible_mm2,
        mean_stretch: flat.mean_stretch,
        stretch_99: flat.stretch_99,
        largest_stretch: flat.largest_stretch,
        pages: Vec::new(),
        pieces,
        seams,
        places,
        frame,
    };
    let captions = Captions::of_image(&request.template(), &request.facts);
    let mut pages = vec![cover::cover(&made, &cover_frame(&frame, request)?, &captions)];
    for (page, frame) in sheet_frames.iter().enumerate() {
        let mut marks = Vec::new();
        for (i, place) in made.places.iter().enumerate().filter(|(_, place)| place.page == page) {
            let drawing = Drawing {
                piece: &made.pieces[i],
                outlines: &outlines[i],
                tabs: &tabs.tabs[i],
                signs: &signs.signs[i],
                pose: place.pose,
            };
            marks.extend(drawing.marks(images[i].as_ref()));
        }
        pages.push(sheet(frame, marks, &captions, (page, sheet_frames.len())));
    }
    let stretch = frame.setup.stretch();
    made.pages = pages
        .into_iter()
        .map(|page| printer::corrected_one(page, stretch))
        .collect();
    Ok(made)
}

/// The page upright and across, as far as the paper allows; of a roll only across it.
fn frames(request: &PiecesRequest) -> Result<Vec<PageFrame>, PiecesError> {
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

fn room(tabs_mm: Option<f64>) -> Room {
    Room {
        bleed_mm: BLEED_MM,
        around_mm: AROUND_MM + tabs_mm.unwrap_or(0.0),
    }
}

/// What a piece may measure so that it fits on one of the pages with all that stands around it.
///
/// # Errors
/// Tabs that are none, and paper too small for rulers.
pub(crate) fn fits_mm(request: &PiecesRequest) -> Result<[f64; 2], PiecesError> {
    let room = room(request.tabs_mm.map(length::tab_mm).transpose()?);
    let size = |frame: &PageFrame| {
        [frame.usable.width_mm(), frame.usable.height_mm()].map(|mm| (mm - 2.0 * room.around_mm - 4.0).max(0.0))
    };
    let sizes = frames(request)?.into_iter().map(|frame| size(&frame));
    Ok(sizes
        .max_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1])))
        .unwrap_or_default())
}

/// Outlines of a piece in its plane.
struct Outlines {
    /// What is printed of the texture.
    printed: Region,
    /// The same and the tabs.
    ink: Region,
    /// What is cut out: the piece and its tabs.
    cut: Region,
}

impl Outlines {
    fn new(piece: &Piece, tabs: &Tabs) -> Self {
        let grown = piece.region.grown(BLEED_MM);
        if tabs.region.is_empty() {
            let (ink, cut) = (grown.clone(), piece.region.clone());
            return Self {
                printed: grown,
                ink,
                cut,
            };
        }
        Self {
            ink: grown.or(&tabs.region.grown(CUT_ROOM_MM)),
            // Beyond a fold there is no cut that could miss, and the tab keeps clean for its letter.
            printed: grown.without(&tabs.region.without(&piece.region.grown(0.3))),
            cut: piece.region.or(&tabs.region),
        }
    }
}

/// Everything of a piece that needs paper of its own, in its plane.
fn shape(outlines: &Outlines, signs: &Signs) -> Region {
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
    outlines.ink.or(&Region::union(signs))
}

/// The pieces on whichever way round the page needs fewer sheets.
fn nested(shapes: &[Region], frames: &[PageFrame]) -> Result<(PageFrame, Vec<Place>), PiecesError> {
    let tried = frames.iter().map(|frame| {
        let places = nest::nest(shapes, frame.printable, &furniture(frame));
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
fn furniture(frame: &PageFrame) -> [RectMm; 3] {
    const AIR_MM: f64 = 2.0;
    let (printable, usable) = (frame.printable, frame.usable);
    let end = ruler::LENGTH_MM + 2.0 * AIR_MM;
    [
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
fn sheet_frames(
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
fn cover_frame(frame: &PageFrame, request: &PiecesRequest) -> Result<PageFrame, PiecesError> {
    const ROLL_MM: f64 = 280.0;
    match request.paper {
        Stock::Cut(_) => Ok(*frame),
        Stock::Roll { width_mm } => Ok(PageFrame::new(
            cut_from_roll(width_mm, ROLL_MM, &frame.setup),
            frame.setup,
        )?),
    }
}

/// The area of the boxes around all pieces as they lie.
fn boxes_mm2(pieces: &[Piece], places: &[Place]) -> f64 {
    let area = |(piece, place): (&Piece, &Place)| {
        let (low, high) = piece.region.moved(|p| place.pose.at(p)).bounds().unwrap_or_default();
        (high[0] - low[0] + 2.0 * BLEED_MM) * (high[1] - low[1] + 2.0 * BLEED_MM)
    };
    pieces.iter().zip(places).map(area).sum()
}

type PlacedImage = (Arc<RgbImage>, RectMm);

fn image_of(
    (mesh, texture): (&Mesh, &Texture),
    piece: &Piece,
    place: &Place,
    frame: &PageFrame,
    dpi: f64,
) -> Option<PlacedImage> {
    let paint = FlatPaint::new(mesh, texture, &piece.triangles, &piece.region, BLEED_MM);
    let grid = PixelGrid::new(frame.page.height_mm, dpi);
    let (image, area) = paint.image(&place.pose, grid, BLEED_MM, frame.whole())?;
    Some((Arc::new(image), area))
}

fn sheet(frame: &PageFrame, mut marks: Vec<Mark>, captions: &Captions, (page, pages): (usize, usize)) -> Sheet {
    marks.extend(rulers(frame));
    marks.extend(captions.marks(frame.printable));
    let label = format!("{} of {pages}", page + 1);
    let size_mm = fitting_size_mm(&label, SHEET_MM, SHEET_WIDTH_MM);
    let at = (frame.printable.right_mm, frame.printable.bottom_mm + 0.8);
    marks.push(Mark::text(at, size_mm, TextAnchor::Right, label));
    frame.sheet(frame.whole(), frame.whole(), marks)
}

/// White along the outer side of the line that is cut, so that it shows on a dark texture.
fn halo(cut: &Region) -> Vec<Mark> {
    let around = cut.grown(CUT_HALO_MM);
    let outlines = moved(around.contours(), [0.0; 2]);
    let lines = outlines.iter().flat_map(|o| o.iter().zip(o.iter().cycle().skip(1)));
    lines
        .map(|(from, to)| Mark::Line {
            from: *from,
            to: *to,
            width_mm: HALO_MM,
            dash_mm: None,
            colour: WHITE,
        })
        .collect()
}

/// One piece on its sheet.
struct Drawing<'a> {
    piece: &'a Piece,
    outlines: &'a Outlines,
    tabs: &'a Tabs,
    signs: &'a Signs,
    pose: Pose,
}

impl Drawing<'_> {
    fn marks(&self, image: Option<&PlacedImage>) -> Vec<Mark> {
        let on_page = |region: &Region| region.moved(|p| self.pose.at(p));
        let cut = on_page(&self.outlines.cut);
        let mut marks = Vec::new();
        if let Some((image, area)) = image {
            marks.push(Mark::Clipped {
                to: moved(on_page(&self.outlines.printed).contours(), [0.0; 2]),
                marks: vec![Mark::Image {
                    image: Arc::clone(image),
                    area: *area,
                }],
            });
        }
        marks.extend(
            self.piece
                .folds
                .iter()
                .map(|ends| self.line(*ends, EDGE_LINE_MM, Some(EDGE_DASH_MM))),
        );
        marks.extend(
            self.tabs
                .folds
                .iter()
                .map(|ends| self.line(*ends, LINE_MM, Some(FOLD_DASH_MM))),
        );
        marks.extend(halo(&cut));
        marks.extend(cut_line(&cut, [0.0; 2]));
        marks.push(Mark::Cut {
            outlines: moved(cut.contours(), [0.0; 2]),
            is_piece: true,
        });
        for tick in &self.signs.ticks {
            marks.extend(self.haloed([self.off_line(tick[0], tick[1]), tick[1]]));
        }
        marks.extend(self.signs.labels.iter().flat_map(|label| self.label(label)));
        marks
    }

    /// A little away from the border, so that nothing stays on the piece.
    fn off_line(&self, border: Point, to: Point) -> Point {
        let share = 0.4 / distance(border, to).max(0.4);
        [0, 1].map(|axis| border[axis] + share * (to[axis] - border[axis]))
    }

    fn place(&self, p: Point) -> PointMm {
        let [x, y] = self.pose.at(p);
        PointMm::new(x, y)
    }

    fn line(&self, ends: [Point; 2], width_mm: f64, dash_mm: Option<(f64, f64)>) -> Mark {
        let [from, to] = ends.map(|p| self.place(p));
        Mark::Line {
            from,
            to,
            width_mm,
            dash_mm,
            colour: BLACK,
        }
    }

    fn haloed(&self, ends: [Point; 2]) -> [Mark; 2] {
        let [from, to] = ends.map(|p| self.place(p));
        [(HALO_MM, WHITE), (LINE_MM, BLACK)].map(|(width_mm, colour)| Mark::Line {
            from,
            to,
            width_mm,
            dash_mm: None,
            colour,
        })
    }

    fn label(&self, label: &Label) -> Vec<Mark> {
        let away = distance(label.at, label.names);
        let mut marks = Vec::new();
        let on_tab = away < BLEED_MM + label.radius_mm;
        let rim = if label.is_number {
            NUMBER_RING_MM
        } else {
            label.radius_mm
        };
        if away - rim > BLEED_MM + 1.0 && !on_tab {
            let share = (away - rim) / away;
            let end = [0, 1].map(|axis| label.names[axis] + share * (label.at[axis] - label.names[axis]));
            marks.extend(self.haloed([self.off_line(label.names, label.at), end]));
        }
        if label.is_number {
            marks.extend(self.ring(label.at));
        }
        let most = if label.is_number { NUMBER_MM } else { LETTER_MM };
        let size_mm = fitting_size_mm(&label.text, most, 1.7 * rim);
        let at = self.place(label.at);
        let baseline = at.y_mm - if label.is_number { 0.5 * CAP_HEIGHT } else { 0.28 } * size_mm;
        marks.push(Mark::text(
            (at.x_mm, baseline),
            size_mm,
            TextAnchor::Centre,
            label.text.clone(),
        ));
        marks
    }

    /// The ring around a number, with the arrow that points up on the model.
    fn ring(&self, at: Point) -> Vec<Mark> {
        const CORNERS: usize = 32;
        let polar = |radius: f64, angle: f64| {
            let (s, c) = angle.sin_cos();
            [at[0] + radius * c, at[1] + radius * s]
        };
        let corner = |i: usize| polar(NUMBER_RING_MM, std::f64::consts::TAU * i as f64 / CORNERS as f64);
        let mut marks: Vec<Mark> = (0..CORNERS)
            .map(|i| self.line([corner(i), corner(i + 1)], LINE_MM, None))
            .collect();
        let up = self.piece.up[1].atan2(self.piece.up[0]);
        let arrow = [
            polar(NUMBER_RING_MM + 1.3, up),
            polar(NUMBER_RING_MM, up + 0.35),
            polar(NUMBER_RING_MM, up - 0.35),
        ];
        marks.push(Mark::Area {
            outlines: vec![arrow.map(|p| self.place(p)).to_vec()],
            colour: BLACK,
        });
        marks
    }
}
