//! Two textures against each other on paired photos: differences with intervals, exact tests, and "too few photos to tell".

pub mod control; // a second round of the base, which withholds effects
pub(crate) mod decide; // findings on many detectors and textures, tested together
pub mod definitions; // words of a comparison
pub mod detectable; // smallest drop that would have been shown
pub mod differences; // differences of one detector with their intervals
pub mod error; // variants that cannot be compared
pub mod moved; // change of a drop that is measured in another way
pub mod pairs; // pairs of photos by place and bin
pub(crate) mod ranking; // order of the variants against that in other photos
pub(crate) mod sequential; // a look after every pair, or every place
pub mod textures; // every variant against the base

pub use control::check_control;
pub(crate) use decide::{LEAST_SEEN, LEVEL, decide_families, missing};
pub use decide::{MOST_HIT, decide};
pub use definitions::comparison_definitions;
pub use differences::difference;
pub(crate) use differences::view;
pub use error::CompareError;
pub use moved::moved_drops;
pub(crate) use pairs::{Cell, Pair, clusters, pair, pairs, some_pairs};
pub use ranking::ranking;
pub use sequential::{decide_by_looks, most_telling, sequential};
pub(crate) use textures::compare_set;
pub use textures::{compare, compare_with, paired, paired_control, paired_photos};
