//! Tables for a paper, in booktabs' style.

pub mod comments; // comments that explain the numbers
pub mod comparison; // comparison.tex
pub mod defences; // defences.tex
pub mod evaluation; // evaluation.tex
pub mod markup; // texts, numbers and rows in TeX
pub mod protocol; // protocol.tex
pub mod run; // table.tex

pub use comparison::comparison;
pub use run::table;
