//! Printing in true millimetres as PDF or SVG: templates, paint stencils, tags, boards, patches, the colour chart.
//!
//! Sheets are planned in the millimetres measured on paper, and drawn as vectors.
//!
//! ```
//! use scaleproof_print::print::media::Media;
//! use scaleproof_print::print::paper::{Orientation, Paper};
//! use scaleproof_print::print::template::{Front, LayoutRequest, TemplateRequest, template};
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

pub mod colour_chart;
pub mod print;
