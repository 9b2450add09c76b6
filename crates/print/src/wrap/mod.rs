//! Pattern or texture as five panels of a model: left, right, roof, front and rear, each at true size, cut to the model's outline.
//!
//! A surface belongs to the side nearest to its normal and is printed only on that panel; the panel is its projection along that axis. So each point
//! has the colour of [`WorldAligned`](scaleproof_surface::pattern::world_aligned::WorldAligned), and [`scaleproof_surface::pattern::world_aligned`]
//! defines the pattern's orientation on each side. The errors of the projection are reported: sloping surfaces are longer than their paper
//! ([`Panel::largest_stretch`]), and layers behind each other share one print ([`Panel::hidden_mm2`]).

mod cover;
mod draw;
mod panel;
mod printed;
mod region;
mod request;
mod seams;

pub(crate) use printed::moved_by_mm;
pub use printed::{SpreadPanel, Wrap};
pub use request::{BLEED_MM, WrapError, WrapRequest};

pub use draw::{CUT_ROOM_MM, EDGE_DASH_MM, EDGE_LINE_MM, cut_line, cutter_path, moved, wrap};
pub use panel::{Face, PRINTED, PaintedSurface, Panel};
pub use region::{Contour, Region, corners};
