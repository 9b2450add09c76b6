//! Unit tests of charts and lettering.

#[path = "plot/axis.rs"]
mod axis;
#[path = "plot/chart_pdf.rs"]
mod chart_pdf;
#[path = "plot/lettering.rs"]
mod lettering;
#[path = "plot/scatter.rs"]
mod scatter;
