//! Sentences and words of the reports.

pub mod certainty; // how effects were decided, and why rates have no interval
pub mod counted; // labels that count as the model
pub mod direction; // sides of the model
pub mod looks; // a sequential comparison
pub mod numbers; // numbers and p values
pub mod paired; // effects and drops on paired photos
pub mod paper; // sentences for a paper
pub mod truth; // sources of the truth boxes
pub mod verdict; // findings in a sentence for each texture
pub(crate) use counted::other_label;
pub(crate) use direction::side;
pub(crate) use looks::{figures, unit};
pub use numbers::{number, p_value};
pub use paired::briefly;
pub use truth::truth_boxes;
