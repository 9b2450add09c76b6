//! Small charts and plain pages, drawn uniformly wherever the program shows measurements: one against the other, or along a sweep.
//!
//! Colours are those of Okabe & Ito (2008), which people with colour blindness can distinguish.
//!
//! - here: the elements of charts ([`Mark`]), charts ([`scatter()`], [`panels()`], [`figure()`]), written as SVG and PDF ([`Drawing`]), and pages;
//! - [`lettering`]: width of text, of charts and sheets alike; [`pdf`]: common parts of all PDFs.
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

mod axis;
mod chart_pdf;
mod drawing;
pub mod lettering;
mod mark;
mod page;
mod panels;
pub mod pdf;
mod scatter;
mod svg;

pub use axis::{PlotAxis, Scale, tick_label};
pub use drawing::{Drawing, Explained, figure};
pub use mark::{Anchor, Colour, Mark, Shape, Text};
pub use page::{html_page, plain_page};
pub use panels::{PlotLine, PlotPanel, panels};
pub use scatter::{Cloud, Dot, scatter, sector};
pub use svg::markup;

/// Colours of the series, in their order; an eleventh series starts over. The last two are Paul Tol's wine and grey.
#[rustfmt::skip]
const COLOURS: [u32; 10] = [
    0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x000000, 0x8c6d00, 0x882255, 0x9a9a9a,
];
pub const BLACK: Colour = Colour(0x000000);
pub const WHITE: Colour = Colour(0xffffff);
/// Colour of primary text.
pub const INK: Colour = Colour(0x1b1f24);
/// Colour of explanatory text.
pub const NOTE: Colour = Colour(0x5b6573);
/// Colour of grid lines.
pub const FAINT: Colour = Colour(0xd7dce2);

pub fn colour(series: usize) -> Colour {
    Colour(COLOURS[series % COLOURS.len()])
}

/// Returns each distinct name once, in the order of first occurrence.
pub fn distinct<T: PartialEq>(names: impl IntoIterator<Item = T>) -> Vec<T> {
    names.into_iter().fold(Vec::new(), |mut known, name| {
        if !known.contains(&name) {
            known.push(name);
        }
        known
    })
}
