//! A painted model as few flat pieces that hands can glue: true size, the texture on them, letters on both sides of every seam, nested on
//! the fewest sheets.
//!
//! [`crate::unwrap`] says what the pieces are. One file each: a piece in its plane (`flat`), where pieces meet (`seams`), glue tabs, the signs
//! beside them (`labels`), their places on sheets (`nest`, `pages`), the sheets (`draw`), and the first page with its exploded views. [`painted`]
//! makes stencils of them instead.

mod cover;
mod draw;
mod exploded;
mod flat;
mod labels;
mod nest;
mod pages;
pub mod painted;
mod pen;
mod seams;
mod tabs;

pub use draw::pieces;
pub use flat::Piece;
pub use nest::Place;
pub use seams::Seam;

pub use crate::unwrap::UnwrapError;
use crate::unwrap::{LeftOut, LeftOutReason, UnwrapRequest, Unwrapped, unwrap};
use scaleproof_core::geometry::length::BadLength;
use scaleproof_core::spelling::count;
use scaleproof_print::print::SheetError;
use scaleproof_print::print::date::Date;
use scaleproof_print::print::frame::PageFrame;
use scaleproof_print::print::paper::{Orientation, Stock};
use scaleproof_print::print::printer::Printer;
use scaleproof_print::print::raster::RasterError;
use scaleproof_print::print::sheet::Sheet;
use scaleproof_print::print::template::{Front, LayoutRequest, TemplateError, TemplateRequest};
use scaleproof_print::print::wrap::Region;
use scaleproof_surface::mesh::Mesh;

/// How far the texture runs on beyond a piece's outline.
const BLEED_MM: f64 = 2.0;
/// Around a piece: bleed, a label and some air.
const AROUND_MM: f64 = 12.0;

/// Why no pieces were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PiecesError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Template(#[from] TemplateError),
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error(transparent)]
    Unwrap(#[from] UnwrapError),
    #[error("piece {piece} does not fit on a sheet with its letters; use larger paper")]
    TooLarge { piece: usize },
}

/// What to print. All lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecesRequest {
    pub most_pieces: Option<usize>,
    pub mean_stretch: f64,
    pub stretch_99: f64,
    pub dpi: f64,
    /// Width of the glue tabs; `None`: none.
    pub tabs_mm: Option<f64>,
    /// How the captions call the texture, and facts about it.
    pub name: String,
    pub facts: String,
    /// The model is 1:`scale`; only the captions use it.
    pub scale: f64,
    pub date: Option<Date>,
    pub paper: Stock,
    pub margin_mm: f64,
    pub printer: Printer,
}

impl PiecesRequest {
    /// What the document is called.
    pub fn title(&self) -> String {
        format!("Pieces of {}", self.name)
    }

    fn unwrap(&self, fits_mm: [f64; 2]) -> UnwrapRequest {
        UnwrapRequest {
            most_pieces: self.most_pieces,
            mean_stretch: self.mean_stretch,
            stretch_99: self.stretch_99,
            fits_mm: Some(fits_mm),
            hidden_too: false,
        }
    }

    /// What the captions are made of.
    fn template(&self) -> TemplateRequest {
        TemplateRequest {
            tile_mm: 1.0,
            scale: self.scale,
            pattern_name: self.name.clone(),
            front: Front::None,
            date: self.date,
            layout: LayoutRequest {
                size_mm: (1.0, 1.0),
                paper: self.paper,
                orientation: Orientation::Auto,
                overlap_mm: 0.0,
                bleed_mm: 0.0,
                margin_mm: self.margin_mm,
                printer: self.printer,
            },
        }
    }
}

/// The pieces of a model, drawn.
#[derive(Debug, Clone)]
pub struct PrintedPieces {
    pub pieces: Vec<Piece>,
    pub seams: Vec<Seam>,
    /// Where each piece lies on the sheets.
    pub places: Vec<Place>,
    /// Each piece with its tabs, in its plane: what is cut out.
    pub cut: Vec<Region>,
    pub frame: PageFrame,
    pub left_out: Vec<LeftOut>,
    pub visible_mm2: f64,
    pub mean_stretch: f64,
    pub stretch_99: f64,
    pub largest_stretch: f64,
    /// Length of the seams that have no letter on one of their sides.
    pub unlettered_mm: f64,
    /// The first page, then the sheets, as the printer needs them.
    pub pages: Vec<Sheet>,
}

impl PrintedPieces {
    /// A name for each page, where it becomes a file of its own.
    pub fn page_names(&self) -> Vec<String> {
        let sheets = (1..self.pages.len()).map(|sheet| format!("sheet-{sheet}"));
        ["assembly".to_owned()].into_iter().chain(sheets).collect()
    }

    /// How many sheets carry pieces.
    pub fn sheets(&self) -> usize {
        pages::sheets(&self.places)
    }

    pub fn surface_mm2(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.surface_mm2).sum()
    }

    /// Length of everything that is cut.
    pub fn cut_mm(&self) -> f64 {
        self.cut.iter().map(Region::border_mm).sum()
    }

    /// The share of the visible paint that is on pieces.
    pub fn visible_share(&self) -> f64 {
        self.surface_mm2() / self.visible_mm2.max(f64::MIN_POSITIVE)
    }

    /// One sentence a fact.
    pub fn facts(&self) -> Vec<String> {
        let mut facts = vec![
            format!(
                "{} on {}: {} of paint, {:.1} % of what can be seen",
                count(self.pieces.len(), "piece"),
                count(self.sheets(), "sheet"),
                cm2(self.surface_mm2()),
                100.0 * self.visible_share()
            ),
            format!(
                "stretch (mm on the surface for 1 mm on paper, or the inverse): mean {:.3}, 99th percentile {:.3}, largest {:.2}",
                self.mean_stretch, self.stretch_99, self.largest_stretch
            ),
            format!(
                "{:.1} m to cut, {} with letters",
                self.cut_mm() / 1000.0,
                count(self.seams.len(), "seam")
            ),
        ];
        facts.extend(left_out_facts(&self.left_out));
        facts
    }
}

/// An area in the unit of the facts.
fn cm2(mm2: f64) -> String {
    format!("{:.1} cm²", mm2 / 100.0)
}

/// A sentence for each part of the paint that is on no piece and can be seen.
fn left_out_facts(parts: &[LeftOut]) -> impl Iterator<Item = String> {
    let seen = parts.iter().filter(|part| part.surface_mm2 >= 0.5);
    seen.map(|part| format!("left out: {} {}", cm2(part.surface_mm2), reason(part.reason)))
}

/// Why paint is on no piece, after its area.
pub fn reason(reason: LeftOutReason) -> &'static str {
    match reason {
        LeftOutReason::Hidden => "that cannot be seen from outside",
        LeftOutReason::NoArea => "of triangles without area or that are there twice",
        LeftOutReason::TooSmall => "of small parts, to stay within the number of pieces",
    }
}

/// Cuts the paint of some materials (by index; all if there are none) of a mesh in the model frame into pieces that fit on the paper, and
/// flattens them. `progress` is called with the share that is done.
///
/// # Errors
/// Bounds that no pieces keep, and whatever refuses the paper.
pub fn flattened(
    (mesh, materials): (&Mesh, &[usize]),
    request: &PiecesRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Unwrapped, PiecesError> {
    let fits_mm = draw::fits_mm(request)?;
    Ok(unwrap(mesh, materials, &request.unwrap(fits_mm), progress)?)
}
