//! Tables of the reports, one file each.

pub mod azimuth; // drop of the hit rate in each direction
pub mod by_detector; // rows grouped by detector
pub mod conditions; // figures by a condition
pub mod defended; // differences on defended photos
pub mod effects; // effect of each texture on each detector
pub mod figures; // AP, hit rate and confidence
pub mod looks; // a sequential comparison
pub mod order; // order of the textures here and there
pub mod outcomes; // hits and misses
pub mod papers; // figures that papers compare
pub mod patterns; // the paper's tables of an evaluation
pub mod protocol; // table of a protocol
pub mod run; // all tables of a run
pub mod survival; // severities at which a drop is shown
pub mod taken; // labels given to the model
pub mod transfer; // pattern × detector

pub(crate) use azimuth::by_azimuth;
pub(crate) use conditions::conditions;
pub(crate) use defended::defended;
pub(crate) use effects::effects;
pub(crate) use figures::{figures, figures_of_screen};
pub(crate) use looks::looks;
pub(crate) use order::order;
pub(crate) use outcomes::outcomes;
pub(crate) use papers::papers;
pub(crate) use patterns::{by_pattern, differences};
pub(crate) use protocol::protocol;
pub use run::{ACROSS, RunTables};
pub(crate) use survival::survival;
pub(crate) use taken::taken;
pub(crate) use transfer::transferred;
