//! Small charts and plain pages, drawn uniformly wherever the program shows measurements: one against the other, or along a sweep.
//!
//! Colours are those of Okabe & Ito (2008), which people with colour blindness can distinguish.
//!
//! ```
//! use scaleproof_plot::{Drawing, Mark, colour};
//!
//! let bar = Mark::rect([5.0, 5.0], [20.0, 10.0]).filled(colour(0));
//! let drawing = Drawing { area: [0.0, 0.0, 90.0, 60.0], label: "a bar".to_owned(), marks: vec![bar] };
//! assert!(drawing.svg().contains("<rect x=\"5\" y=\"5\""));
//! assert!(drawing.pdf()?.starts_with(b"%PDF"));
//! # Ok::<(), scaleproof_plot::pdf::PdfError>(())
//! ```

mod axis; // scales, ticks and their labels
mod chart_pdf; // drawings as PDF
mod drawing; // marks with the visible part of their plane; several in a figure
pub mod lettering; // width of text
mod mark; // elements of charts
mod page; // plain HTML pages
mod panels; // many small charts of sweeps
pub mod pdf; // common parts of all PDFs
mod scatter; // dots over two axes
mod series; // names and colours of series
mod svg; // drawings as SVG

pub use axis::{PlotAxis, Scale, tick_label};
pub use drawing::{Drawing, Explained, figure};
pub use mark::{Anchor, Colour, Mark, Shape, Text};
pub use page::{html_page, plain_page};
pub use panels::{PlotLine, PlotPanel, panels};
pub use scatter::{Cloud, Dot, scatter, sector};
pub use series::{BLACK, FAINT, INK, NOTE, WHITE, colour, distinct};
pub use svg::markup;
