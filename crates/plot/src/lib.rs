//! Small SVG charts and plain pages, drawn the same wherever the program shows measurements: one against the other, or along a sweep.
//!
//! Colours are those of Okabe & Ito (2008), which people with colour blindness can distinguish.
//!
//! - here: charts ([`scatter()`], [`panels()`]) and pages;
//! - [`chart_pdf`]: such a chart as a PDF for a paper;
//! - [`lettering`]: how wide text is, of charts and sheets alike; [`pdf`]: what all PDFs have.
//!
//! ```
//! use scaleproof_plot::chart_pdf::pdf_of_svg;
//!
//! let svg = "<svg width='90' height='60'><rect x='5' y='5' width='20' height='10' fill='#0072b2'/></svg>";
//! assert!(pdf_of_svg("a bar", svg)?.starts_with(b"%PDF"));
//! # Ok::<(), scaleproof_plot::pdf::PdfError>(())
//! ```

mod axis;
pub mod chart_pdf;
mod drawing;
pub mod lettering;
mod page;
mod panels;
pub mod pdf;
mod scatter;

pub use axis::{PlotAxis, Scale, tick_label};
pub use drawing::{Drawing, Explained, figure};
pub use page::{html_page, plain_page};
pub use panels::{PlotLine, PlotPanel, panels};
pub use scatter::{Cloud, Dot, scatter, sector};

/// Colours of the series, in their order; an eleventh series starts over. The last two are Paul Tol's wine and grey.
const COLOURS: [&str; 10] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d00", "#882255", "#9a9a9a",
];
const INK: &str = "#1d232b";
const FAINT: &str = "#d7dce2";
const NOTE: &str = "#5b6573";

pub fn colour(series: usize) -> &'static str {
    COLOURS[series % COLOURS.len()]
}

/// Each of some names once, in the order in which they come.
pub fn distinct<T: PartialEq>(names: impl IntoIterator<Item = T>) -> Vec<T> {
    names.into_iter().fold(Vec::new(), |mut known, name| {
        if !known.contains(&name) {
            known.push(name);
        }
        known
    })
}

/// A tenth of a pixel is all a screen shows; fewer digits, smaller files.
fn round(v: f64) -> f64 {
    (v * 10.0).round() / 10.0
}

fn document(width: f64, height: f64, label: &str, content: &maud::Markup) -> String {
    let svg = maud::html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {width} {height}")) width=(width) height=(height) role="img"
            aria-label=(label) font-family="DejaVu Sans, Verdana, sans-serif" {
            rect width="100%" height="100%" fill="#fff" {}
            (content)
        }
    };
    svg.into_string()
}
