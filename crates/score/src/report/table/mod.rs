//! Tables of typed cells, and their writers.

pub mod cell; // a value with its interval and remark
pub mod html; // as HTML
pub mod model; // rows of cells below named columns
pub mod records; // as CSV and JSON, every number in full
pub mod tex; // as a `tabular`
pub mod text; // as lines of plain text

pub use cell::{Cell, Value};
pub use model::{Alignment, Column, Table};
