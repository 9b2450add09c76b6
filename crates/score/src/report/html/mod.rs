//! Pages: a frame, sections, and what they have in common.

pub mod charts; // charts with their legends
pub mod comparison; // comparison.html
pub mod contact; // every photo with its boxes
pub mod defences; // defended photos
pub mod evaluation; // evaluation.html
pub mod filters; // filters above the photos
pub mod first; // first screen
pub mod misses; // outcomes as bars
pub mod notes; // method, photos left out, definitions, provenance
pub mod page; // frame of a page
pub mod pairs; // photos of a comparison side by side
pub mod parts; // tables, legends and small charts
pub mod patterns; // patterns and photos of the textures
pub mod run; // report.html
pub mod strip; // base and texture side by side

pub use run::render;
