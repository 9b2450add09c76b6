//! Comparisons on photos that are corrupted or defended, to find out whether an effect survives.

pub mod changed_photo; // detections in a corrupted or defended photo
pub mod changes; // changed photos against the same photos unchanged
pub mod check; // check before a run
pub mod condition; // corruptions and defences as conditions
pub mod corrupt; // photos corrupted by published amounts
pub mod corrupted; // comparisons at every severity
pub mod defended; // comparisons under every defence
pub mod joined; // detections of several crops of one photo
pub mod rerun; // the detectors once more, on changed photos

pub(crate) use changed_photo::PhotoUnderConditions;
pub use check::check_changeable;
pub use condition::Defending;
pub(crate) use condition::{Condition, per_condition};
pub use corrupt::{Corruption, SEVERITIES};
pub use corrupted::under_corruption;
pub use defended::under_defences;
pub(crate) use rerun::Rerun;
