//! Figures of a run, from the values of each photo up: outcomes, rates, average precision, drops, and the cautions beside them.

pub mod caution; // sentences on what weakens a figure
pub mod comparison; // result of a comparison: differences with intervals, looks, control
pub mod criteria; // choices that a figure depends on, and the definitions beside it
pub(crate) mod curves; // precision over recall, and hits by confidence
pub mod defences; // result of a run on defended photos
pub mod detector_view; // a detector's outcomes and boxes in the photos of a run
pub mod disagreement; // sentences on AP and hit rate that disagree
pub mod finding; // effect of a texture on a detector, and the p values behind it
pub mod grouping; // groups of photos by a condition
pub mod near_copies; // photos that show one moment
pub mod outcome; // outcome of one detector on one photo
pub mod photo; // values of one photo, or the reason why it has none
pub mod protocol; // protocols of papers and benchmarks
pub mod protocol_table; // the table that a protocol's paper prints
pub(crate) mod ranking; // agreement of two orders of the variants
pub mod reliability; // confidence against correctness
pub mod robustness; // result of a run on corrupted photos
pub mod scores; // result of a run
pub mod settings; // settings of a file by which photos are located and AP is computed
pub mod summary; // figures per detector and variant
pub mod texture_pattern; // patterns of the textures
pub mod thresholds; // thresholds from which a detection counts
pub(crate) mod transfer; // drops of each texture on every detector
pub mod variants; // the base, and patterns that were not optimised

pub use comparison::{
    BinHits, ClusteredBy, Compared, Comparison, Control, Course, Decision, Difference, Hits, PlanCheck, Sequential,
    SequentialFinding,
};
pub(crate) use comparison::{PairedView, Sums};
pub use criteria::Criteria;
pub use curves::{Curves, HitRateFrom, curves};
pub use defences::{DefenceCard, Defences, DefendedRow, UNDEFENDED};
pub(crate) use detector_view::{ClusteredAp, DetectorView};
pub use disagreement::disagreements;
pub use finding::{Effect, Finding, InPlacesLikeThese};
pub use grouping::GroupBy;
pub(crate) use near_copies::identical_photos;
pub use outcome::{PhotoOutcome, Verdict};
pub(crate) use photo::nothing_scored;
pub use photo::{NotScored, ScoredPhoto, TagMark};
pub use protocol::Protocol;
pub use protocol_table::{ProtocolTable, apricot_ap, protocol_table, rates_as_armory};
pub use ranking::{RankedVariant, Ranking, RankingFinding, RankingRow};
pub use reliability::{ConfidenceBin, RELIABILITY_FLOOR, Reliability, reliability};
pub use robustness::{BASE_LOST, CorruptedRow, PairedDifference, Robustness, Survival};
pub(crate) use scores::ScoredSet;
pub use scores::Scores;
pub use settings::{AppliedSettings, Settings};
pub use summary::{Asr, BinFigures, CellFigures, ConditionFigures, Drop, Figures, Rate, Summary};
pub use texture_pattern::TexturePattern;
pub use thresholds::{HIT_CONFIDENCE, MATCH_IOU, Thresholds};
pub use transfer::{TransferDrop, TransferRow, transfer};
pub use variants::BASE_VARIANT;
pub(crate) use variants::{is_control, variants};
