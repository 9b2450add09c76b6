//! Printing in true millimetres as PDF or SVG: templates, paint stencils, tags, boards, patches, the colour chart.
//!
//! Everything printed is drawn as vectors on [`sheet::Sheet`]s, in the millimetres measured on paper, and [`output`] writes them to files by
//! [`pdf`] or [`svg`].
//!
//! One file or folder per kind of print, each with its request and its error: [`template`], [`paint`], [`wrap`], [`patch`], [`tags`], `board`,
//! [`chart`], [`check`]. Shared parts: [`page`], [`paper`], [`printer`], `frame`, `ruler`, `shapes`.
//!
//! ```
//! use scaleproof_print::media::Media;
//! use scaleproof_print::paper::{Orientation, Paper};
//! use scaleproof_print::template::{Front, LayoutRequest, TemplateRequest, template};
//! use scaleproof_surface::pattern::Pattern;
//!
//! let request = TemplateRequest {
//!     tile_mm: 118.0,
//!     scale: 10.0,
//!     pattern_name: "random".into(),
//!     front: Front::Left,
//!     layout: LayoutRequest {
//!         size_mm: (600.0, 300.0),
//!         media: Media::new(Paper::A4),
//!         orientation: Orientation::Auto,
//!         overlap_mm: 8.0,
//!         bleed_mm: 2.0,
//!     },
//! };
//! let made = template(&Pattern::random(16, 1)?, &request)?;
//! assert!(made.pages.len() > 6, "a first page, and six sheets of A4");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod colour_chart; // the colour chart: its layout, and reading it in a photo
mod error; // reasons why there is no sheet

#[cfg(feature = "full")]
pub mod board; // calibration boards
pub mod buckets; // spatial index of items in a plane
pub mod chart; // the colour chart on a sheet
pub mod check; // the page by which a printer is measured
pub mod date; // dates of the captions
pub mod frame; // areas of a page: printable, usable, rulers
pub mod media; // paper, printer and date of a print
pub mod output; // sheets as files: one PDF, or an SVG each
pub mod pack; // rectangles packed on pages
pub mod page; // pages with rulers and captions around free content
pub mod paint; // paint by number, and stencils
pub mod paper; // sizes of paper and rolls
pub mod patch; // finished patches for the panels of a model
pub mod pdf; // sheets as PDF
pub mod polygon; // convex polygons cut by triangles and cells
pub mod printer; // the measured scale of a printer, and its correction
pub mod raster; // a painted surface as pixels of a page
pub mod ruler; // the 100 mm rulers
pub mod shapes; // filled outlines: tags, strokes, triangles
pub mod sheet; // a page and the marks on it, in millimetres
pub mod svg; // sheets as SVG
pub mod tags; // tags of a scene: tent cards, ground mat, plain cards
pub mod template; // a repeated pattern on sheets to cut and glue
pub mod wrap; // five panels of a model

pub use error::SheetError;
