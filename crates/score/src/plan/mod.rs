//! Plans of experiments: the number of views that show a drop, and plans that are sealed before the photos.

pub mod deviations; // deviations of a comparison from its plan
pub mod judged; // plans that the hit rate decides
pub mod planned_views; // views that are missing or repeated
pub mod sealed; // the plan and its file
pub mod sequential; // views that a sequential comparison takes, by simulation
pub mod spread; // scatter of the confidence from view to view
pub mod views_needed; // views that show a drop, by simulation

pub use sealed::{Aim, Endpoint, SealedDetector, SealedFile, SealedPlan, Stopping};
pub use sequential::{Expected, SEQUENTIAL_ROWS, SequentialPlan, sequential_plan};
pub use spread::{FewViews, Observed, Spread, SpreadFrom};
pub use views_needed::{PLAN_EXPERIMENTS, PLAN_SEED, PlanError, Question, ViewsNeeded};
