//! Report files of scores, for people and programs: HTML, LaTeX, JSON, CSV, COCO.
//!
//! Figures become [`tables`] of typed cells and [`charts`]; writers turn these into pages, TeX, CSV, JSON and lines of a screen.

pub mod charts; // drawings, and their SVG and PDF files
mod comparison_files; // the files of a comparison
pub mod csv; // files for spreadsheets
mod error; // reasons why a report cannot be written
mod evaluation; // an evaluation of patterns
mod evaluation_files; // the files of an evaluation
mod export; // photos with truth boxes for other programs
pub mod findings; // a run and its comparisons with a base
pub mod html; // pages
pub mod json; // files for programs
pub mod latex; // tables for a paper
mod provenance; // origin of the figures
pub mod run; // content of a run's report
mod run_files; // the files of a run's report
mod stale; // files of an earlier report
pub mod table; // tables of typed cells, and their writers
pub mod tables; // the tables, one file each
pub mod text; // tables and sentences for a screen
pub mod words; // sentences

pub use comparison_files::write_comparison;
pub use csv::comparison::render as comparison_csv;
pub use csv::figures::render as figures_csv;
pub use csv::photos::render as photos_csv;
pub use error::ReportError;
pub use evaluation::Evaluation;
pub use evaluation_files::write_evaluation;
pub use export::{ExportFormat, check_export, export};
pub use findings::Findings;
pub use html::comparison::render as comparison_html;
pub use json::comparison::{ComparisonPage, comparison_json};
pub use json::summary::{SummaryPage, summary_json};
pub(crate) use provenance::Provenance;
pub use run::RunReport;
pub use run_files::write;
pub use text::comparison::{comparison_table, further_comparison};
pub use text::evaluation::evaluation_tables;
pub use text::run::{further_tables, summary_table};
pub use words::counted::{box_labels, counted};
pub use words::looks::standing;
pub use words::paired::briefly;
pub use words::truth::truth_boxes;
