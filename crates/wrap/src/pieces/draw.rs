//! The sheets: each piece where it was nested, its texture, its lines and its signs.

use std::convert::Infallible;
use std::sync::Arc;

use image::RgbImage;

use super::flat::Piece;
use super::labels::{self, Signs};
use super::nest::Place;
use super::pages::{cover_frame, frames, furniture, nested, shape, sheet, sheet_frames};
use super::pen::{HALO_MM, LINE_MM, Pen};
use super::seams;
use super::tabs::{self, Tabs};
use super::{AROUND_MM, BLEED_MM, PiecesError, PiecesRequest, PrintedPieces, Room, cover, pages};
use crate::unwrap::Unwrapped;
use scaleproof_core::geometry::length;
use scaleproof_core::workers;
use scaleproof_print::print::frame::PageFrame;
use scaleproof_print::print::printer;
use scaleproof_print::print::raster::{self, FlatPaint, PixelGrid};
use scaleproof_print::print::sheet::{Mark, RectMm, WHITE};
use scaleproof_print::print::template::{Captions, cell_mm, check_scale};
use scaleproof_print::print::wrap::{CUT_ROOM_MM, EDGE_DASH_MM, EDGE_LINE_MM, Region, cut_line, moved};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::texture::Texture;

/// From the outline to the middle of the halo, which begins where the line to cut ends.
const CUT_HALO_MM: f64 = 0.45;
const FOLD_DASH_MM: (f64, f64) = (1.5, 1.0);

/// What a piece may measure so that it fits on one of the pages with all that stands around it.
///
/// # Errors
/// Tabs that are none, and paper too small for rulers.
pub fn fits_mm(request: &PiecesRequest) -> Result<[f64; 2], PiecesError> {
    let tabs_mm = request.tabs_mm.map(length::tab_mm).transpose()?;
    pages::fits_mm(request, room(tabs_mm).around_mm)
}

fn room(tabs_mm: Option<f64>) -> Room {
    Room {
        bleed_mm: BLEED_MM,
        around_mm: AROUND_MM + tabs_mm.unwrap_or(0.0),
    }
}

/// Draws everything.
pub fn pieces(
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
    let shapes: Vec<Region> = outlines
        .iter()
        .zip(&signs.signs)
        .map(|(o, s)| shape(&o.ink, s))
        .collect();
    let (frame, places) = nested(&shapes, &frames, furniture)?;
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
                pen: Pen {
                    piece: &made.pieces[i],
                    pose: place.pose,
                },
                outlines: &outlines[i],
                tabs: &tabs.tabs[i],
                signs: &signs.signs[i],
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

/// Outlines of a piece in its plane.
struct Outlines {
    /// What is printed of the texture.
    printed: Region,
    /// What is printed at all: the texture and the tabs.
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
    pen: Pen<'a>,
    outlines: &'a Outlines,
    tabs: &'a Tabs,
    signs: &'a Signs,
}

impl Drawing<'_> {
    fn marks(&self, image: Option<&PlacedImage>) -> Vec<Mark> {
        let on_page = |region: &Region| region.moved(|p| self.pen.pose.at(p));
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
            self.pen
                .piece
                .folds
                .iter()
                .map(|ends| self.pen.line(*ends, EDGE_LINE_MM, Some(EDGE_DASH_MM))),
        );
        marks.extend(
            self.tabs
                .folds
                .iter()
                .map(|ends| self.pen.line(*ends, LINE_MM, Some(FOLD_DASH_MM))),
        );
        marks.extend(halo(&cut));
        marks.extend(cut_line(&cut, [0.0; 2]));
        marks.push(Mark::Cut {
            outlines: moved(cut.contours(), [0.0; 2]),
            is_piece: true,
        });
        for tick in &self.signs.ticks {
            marks.extend(self.pen.tick(*tick));
        }
        marks.extend(self.signs.labels.iter().flat_map(|label| self.pen.label(label)));
        marks
    }
}
