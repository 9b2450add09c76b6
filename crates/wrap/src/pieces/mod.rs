//! Printing of a painted model as few flat pieces to glue: true size, with the texture, letters on both sides of every seam, nested on the fewest
//! sheets.
//!
//! [`crate::unwrap`] cuts and flattens the pieces. One file each: a piece in its plane (`flat`), seams between pieces (`seams`), glue tabs, the signs
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
use scaleproof_print::SheetError;
use scaleproof_print::frame::PageFrame;
use scaleproof_print::raster::RasterError;
use scaleproof_print::sheet::Sheet;
use scaleproof_print::template::{TemplateError, TemplateRequest};
use scaleproof_print::wrap::{Region, WrapRequest};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::world_aligned::Side;

/// Extension of the texture beyond a piece's outline.
const BLEED_MM: f64 = 2.0;
/// Room around a piece: bleed, a label and some air.
const AROUND_MM: f64 = 12.0;

/// Reason why no pieces were printed.
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

#[derive(Debug, Clone, PartialEq)]
pub struct PiecesRequest {
    /// Bounds of the pieces; their maximum size is replaced by the paper's.
    pub unwrap: UnwrapRequest,
    /// Width of the glue tabs, mm; `None` for no tabs.
    pub tabs_mm: Option<f64>,
    /// Sheets as for panels. No piece extends over several sheets, so the overlap is ignored.
    pub sheets: WrapRequest,
}

impl PiecesRequest {
    pub fn title(&self) -> String {
        format!("Pieces of {}", self.sheets.name)
    }

    /// Cuts and flattens the paint of some materials of a mesh into pieces of at most this size.
    fn unwrapped(
        &self,
        (mesh, materials): (&Mesh, &[usize]),
        fits_mm: [f64; 2],
        progress: &mut dyn FnMut(f64),
    ) -> Result<Unwrapped, PiecesError> {
        let request = UnwrapRequest {
            fits_mm: Some(fits_mm),
            ..self.unwrap.clone()
        };
        Ok(unwrap(mesh, materials, &request, progress)?)
    }

    fn template(&self) -> TemplateRequest {
        self.sheets.template(Side::Front, (1.0, 1.0))
    }
}

#[derive(Debug, Clone)]
pub struct PrintedPieces {
    pub pieces: Vec<Piece>,
    pub seams: Vec<Seam>,
    pub places: Vec<Place>,
    /// Area to cut out of each piece with its tabs, in its plane.
    pub cut: Vec<Region>,
    pub frame: PageFrame,
    pub flat: Unwrapped,
    /// Length of the seams without a letter on one of their sides.
    pub unlettered_mm: f64,
    /// The first page, then the sheets, corrected for the printer.
    pub pages: Vec<Sheet>,
}

impl PrintedPieces {
    /// Returns a name for each page, used if it becomes a file of its own.
    pub fn page_names(&self) -> Vec<String> {
        let sheets = (1..self.pages.len()).map(|sheet| format!("sheet-{sheet}"));
        ["assembly".to_owned()].into_iter().chain(sheets).collect()
    }

    pub fn sheets(&self) -> usize {
        pages::sheets(&self.places)
    }

    /// Returns the length of all cuts.
    pub fn cut_mm(&self) -> f64 {
        self.cut.iter().map(Region::border_mm).sum()
    }

    pub fn visible_share(&self) -> f64 {
        self.flat.surface_mm2() / self.flat.visible_mm2.max(f64::MIN_POSITIVE)
    }

    pub fn facts(&self) -> Vec<String> {
        let mut facts = vec![
            format!(
                "{} on {}: {} of paint, {:.1} % of what can be seen",
                count(self.pieces.len(), "piece"),
                count(self.sheets(), "sheet"),
                cm2(self.flat.surface_mm2()),
                100.0 * self.visible_share()
            ),
            format!(
                "stretch (mm on the surface for 1 mm on paper, or the inverse): mean {:.3}, 99th percentile {:.3}, largest {:.2}",
                self.flat.mean_stretch, self.flat.stretch_99, self.flat.largest_stretch
            ),
            format!(
                "{:.1} m to cut, {} with letters",
                self.cut_mm() / 1000.0,
                count(self.seams.len(), "seam")
            ),
        ];
        facts.extend(left_out_facts(&self.flat.left_out));
        facts
    }
}

/// Formats an area in the unit of the facts.
fn cm2(mm2: f64) -> String {
    format!("{:.1} cm²", mm2 / 100.0)
}

/// Returns a sentence for each part of the paint that is on no piece and visible.
fn left_out_facts(parts: &[LeftOut]) -> impl Iterator<Item = String> {
    let seen = parts.iter().filter(|part| part.surface_mm2 >= 0.5);
    seen.map(|part| format!("left out: {} {}", cm2(part.surface_mm2), reason(part.reason)))
}

/// Returns the reason why paint is on no piece, as a clause after its area.
pub fn reason(reason: LeftOutReason) -> &'static str {
    match reason {
        LeftOutReason::Hidden => "that cannot be seen from outside",
        LeftOutReason::NoArea => "of triangles without area or that are there twice",
        LeftOutReason::TooSmall => "of small parts, to stay within the number of pieces",
    }
}

/// Cuts the paint of some materials (by index; all if there are none) of a mesh in the model frame into pieces that fit on the paper, and flattens
/// them. `progress` is called with the share done.
pub fn flattened(
    surface: (&Mesh, &[usize]),
    request: &PiecesRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Unwrapped, PiecesError> {
    request.unwrapped(surface, draw::fits_mm(request)?, progress)
}
