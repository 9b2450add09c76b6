//! Figures from photos, poses and detections: matching, average precision, hit rates, comparisons with intervals, and the [`report`].
//!
//! ```
//! use std::path::Path;
//! use scaleproof_detect::Manifest;
//! use scaleproof_score::report::summary_table;
//! use scaleproof_score::{EvaluatedDetector, Options, score};
//! use scaleproof_session::Session;
//!
//! // With the detections that were recorded with the stored photos.
//! let session = Session::open(Path::new("../../captures/skyline"))?;
//! let class = &session.scene.model.class;
//! let detector = EvaluatedDetector::recorded(Manifest::named("yolox_nano")?, &[&session.folder], class)?;
//! let scores = score(vec![session], vec![detector], &Options::default(), || ())?;
//! println!("{}", summary_table(&scores));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod compare; // textures against the base on paired photos: differences, intervals, findings
mod error; // reasons why a run cannot finish
mod evaluated; // a detector that a run evaluates, and where its detections come from
pub mod figures; // values of each photo, rates, average precision, drops; cautions beside them
mod labelled; // AP on photos whose objects are all labelled
pub mod observe; // tags, detections and previews of photos, cached
mod plan; // number of views that show a drop; plans sealed before the photos
pub mod report; // HTML, LaTeX, JSON, CSV and COCO files of a run, and its tables on a screen
pub mod robustness; // the same comparisons on corrupted and defended photos
pub mod run; // the run over all photos, whole or in shards

pub use compare::{
    CompareError, MOST_HIT, check_control, compare, compare_with, comparison_definitions, decide, decide_by_looks,
    most_telling, moved_drops, paired, paired_control, paired_photos, ranking, sequential,
};
pub use error::ScoreError;
pub use evaluated::{DetectionSource, EvaluatedDetector, EvaluatedDetectorError, evaluated_detectors, runtime};
pub use figures::{
    AppliedSettings, Asr, BASE_LOST, BASE_VARIANT, BinFigures, CellFigures, ClusteredBy, Compared, Comparison,
    ConditionFigures, ConfidenceBin, Control, CorruptedRow, Course, Criteria, Curves, Decision, DefenceCard, Defences,
    DefendedRow, Difference, Drop, Effect, Figures, Finding, GroupBy, HIT_CONFIDENCE, HitRateFrom, InPlacesLikeThese,
    MATCH_IOU, NotScored, PairedDifference, PhotoOutcome, PlanCheck, Protocol, ProtocolTable, RELIABILITY_FLOOR,
    Ranking, RankingFinding, RankingRow, Rate, Reliability, Robustness, ScoredPhoto, Scores, Sequential,
    SequentialFinding, Settings, Summary, Survival, TagMark, TexturePattern, Thresholds, TransferDrop, TransferRow,
    UNDEFENDED, Verdict, apricot_ap, curves, disagreements, protocol_table, rates_as_armory, reliability, transfer,
};
pub use labelled::{Averages, LEAST_GAIN, LabelledError, LabelledPhotos, Trial, Trials, labelled_photos, trials};
pub use observe::{Cache, NotScoredReason, Options};
pub use plan::{
    Aim, Endpoint, Expected, FewViews, Observed, PLAN_EXPERIMENTS, PLAN_SEED, PlanError, Question, SEQUENTIAL_ROWS,
    SealedDetector, SealedFile, SealedPlan, SequentialPlan, Spread, SpreadFrom, Stopping, ViewsNeeded, sequential_plan,
};
pub use robustness::{Corruption, Defending, SEVERITIES, check_changeable, under_corruption, under_defences};
pub use run::{
    SessionFiles, TimedPhoto, check_recordings, explained, merge, not_scored, observe, record, score, shard,
    timed_photos,
};
pub use scaleproof_core::ap::{ApDefinition, ImageBoxes, average_precision, average_precision_as, over_ious};
