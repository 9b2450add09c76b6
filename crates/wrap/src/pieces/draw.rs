//! Drawing of the sheets: each piece at its nested place, its texture, its lines and its signs.

use std::sync::Arc;

use image::RgbImage;

use super::flat::Piece;
use super::labels::{self, Signs};
use super::nest::Place;
use super::pages::{cover_frame, frames, furniture, nested, shape, sheet, sheet_frames};
use super::pen::{HALO_MM, LINE_MM, Pen, cut};
use super::seams;
use super::tabs::{self, Tabs};
use super::{AROUND_MM, BLEED_MM, PiecesError, PiecesRequest, PrintedPieces, cover, pages};
use crate::unwrap::Unwrapped;
use scaleproof_core::geometry::length;
use scaleproof_core::workers;
use scaleproof_print::printer;
use scaleproof_print::raster::{self, FlatPaint, PixelGrid};
use scaleproof_print::sheet::{Mark, RectMm, WHITE};
use scaleproof_print::template::{Captions, cell_mm, check_scale};
use scaleproof_print::wrap::{CUT_ROOM_MM, EDGE_DASH_MM, EDGE_LINE_MM, Region, moved};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::texture::Texture;

/// Distance from the outline to the middle of the halo, which begins at the outer side of the cutting line.
const CUT_HALO_MM: f64 = 0.45;
const FOLD_DASH_MM: (f64, f64) = (1.5, 1.0);

/// Returns the largest size of a piece that fits on one of the pages with everything around it.
pub fn fits_mm(request: &PiecesRequest) -> Result<[f64; 2], PiecesError> {
    let tabs_mm = request.tabs_mm.map(length::tab_mm).transpose()?;
    pages::fits_mm(request, AROUND_MM + tabs_mm.unwrap_or(0.0))
}

/// Draws flattened pieces of a mesh.
pub fn pieces(
    mesh: &Mesh,
    flat: &Unwrapped,
    texture: &Texture,
    request: &PiecesRequest,
) -> Result<PrintedPieces, PiecesError> {
    check_scale(request.sheets.scale)?;
    if let Texture::Tile(tile) = texture {
        cell_mm(&tile.pattern, &request.template().tiled(tile.tile_mm()))?;
    }
    raster::check(request.sheets.dpi, 0.0)?;
    let tabs_mm = request.tabs_mm.map(length::tab_mm).transpose()?;
    let frames = frames(request)?;
    let pieces = Piece::all(flat);
    let seams = seams::seams(&pieces);
    let (tabs, sides) = tabs::tabs(&pieces, &seams, tabs_mm);
    let with_tabs = pieces.iter().zip(&tabs);
    let outlines: Vec<Outlines> = with_tabs.map(|(p, t)| Outlines::new(p, t)).collect();
    let inks: Vec<Region> = outlines.iter().map(|o| o.ink.clone()).collect();
    let around_mm = AROUND_MM + tabs_mm.unwrap_or(0.0);
    let (signs, unlettered_mm) = labels::signs(&pieces, &seams, &inks, &sides, around_mm);
    let shapes: Vec<Region> = inks.iter().zip(&signs).map(|(ink, s)| shape(ink, s)).collect();
    let (frame, places) = nested(&shapes, &frames, furniture)?;
    let sheet_frames = sheet_frames(&frame, &shapes, &places, request)?;
    let boxes_mm2 = pieces.iter().zip(&places).map(|(piece, place)| {
        let (low, high) = piece.region.moved(|p| place.pose.at(p)).bounds().unwrap_or_default();
        (high[0] - low[0] + 2.0 * BLEED_MM) * (high[1] - low[1] + 2.0 * BLEED_MM)
    });
    raster::check(request.sheets.dpi, boxes_mm2.sum())?;
    let all: Vec<usize> = (0..pieces.len()).collect();
    let mut drawn = workers::each(&all, |i| {
        let (piece, Place { page, pose }) = (&pieces[*i], places[*i]);
        let frame = &sheet_frames[page];
        let paint = FlatPaint::new(mesh, texture, &piece.triangles, &piece.region, BLEED_MM);
        let grid = PixelGrid::new(frame.page.height_mm, request.sheets.dpi);
        let image = paint.image(&pose, grid, BLEED_MM, frame.whole());
        marks(&Pen { piece, pose }, &outlines[*i], &tabs[*i], &signs[*i], image)
    });
    let mut made = PrintedPieces {
        cut: outlines.iter().map(|o| o.cut.clone()).collect(),
        unlettered_mm,
        flat: flat.clone(),
        pages: Vec::new(),
        pieces,
        seams,
        places,
        frame,
    };
    let captions = Captions::of_image(&request.template(), &request.sheets.facts);
    let mut pages = vec![cover::cover(&made, &cover_frame(&frame, request)?, &captions)];
    for (page, frame) in sheet_frames.iter().enumerate() {
        let here = made
            .places
            .iter()
            .zip(&mut drawn)
            .filter(|(place, _)| place.page == page);
        let on_page = here.flat_map(|(_, marks)| std::mem::take(marks)).collect();
        pages.push(sheet(frame, on_page, &captions, (page, sheet_frames.len())));
    }
    let stretch = frame.setup.stretch();
    let corrected = |page| printer::corrected_one(page, stretch);
    made.pages = pages.into_iter().map(corrected).collect();
    Ok(made)
}

struct Outlines {
    printed: Region,
    /// Printed area: the texture and the tabs.
    ink: Region,
    /// Area to cut out: the piece and its tabs.
    cut: Region,
}

impl Outlines {
    fn new(piece: &Piece, tabs: &Tabs) -> Self {
        let grown = piece.region.grown(BLEED_MM);
        if tabs.region.is_empty() {
            return Self {
                ink: grown.clone(),
                printed: grown,
                cut: piece.region.clone(),
            };
        }
        Self {
            ink: grown.or(&tabs.region.grown(CUT_ROOM_MM)),
            // No cut follows a fold, so no bleed is needed there, and the tab stays clean for its letter.
            printed: grown.without(&tabs.region.without(&piece.region.grown(0.3))),
            cut: piece.region.or(&tabs.region),
        }
    }
}

/// Draws one piece on its sheet; `image` is its texture with its area there.
fn marks(pen: &Pen, outlines: &Outlines, tabs: &Tabs, signs: &Signs, image: Option<(RgbImage, RectMm)>) -> Vec<Mark> {
    let cut_out = pen.region(&outlines.cut);
    let mut marks = Vec::new();
    if let Some((image, area)) = image {
        let image = Arc::new(image);
        marks.push(Mark::Clipped {
            to: moved(pen.region(&outlines.printed).contours(), [0.0; 2]),
            marks: vec![Mark::Image { image, area }],
        });
    }
    let folds = pen.piece.folds.iter();
    marks.extend(folds.map(|ends| pen.line(*ends, EDGE_LINE_MM, Some(EDGE_DASH_MM))));
    let folds = tabs.folds.iter();
    marks.extend(folds.map(|ends| pen.line(*ends, LINE_MM, Some(FOLD_DASH_MM))));
    // White along the outer side of the cutting line, so that the line is visible on a dark texture.
    let halo = moved(cut_out.grown(CUT_HALO_MM).contours(), [0.0; 2]);
    marks.extend(halo.iter().flat_map(|outline| Mark::outline(outline, HALO_MM, WHITE)));
    marks.extend(cut(&cut_out));
    marks.extend(pen.signs(signs));
    marks
}
