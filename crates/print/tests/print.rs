//! The tests of this crate, linked once.

#[path = "print/board.rs"]
mod board;
#[path = "print/colour_chart_layout.rs"]
mod colour_chart_layout;
#[path = "print/colour_chart_light.rs"]
mod colour_chart_light;
#[path = "print/date.rs"]
mod date;
#[path = "print/layout.rs"]
mod layout;
#[path = "print/mat_seams.rs"]
mod mat_seams;
#[path = "print/output.rs"]
mod output;
#[path = "print/pack.rs"]
mod pack;
#[path = "print/paper.rs"]
mod paper;
#[path = "print/pdf.rs"]
mod pdf;
#[path = "print/plane.rs"]
mod plane;
#[path = "print/polygon.rs"]
mod polygon;
#[path = "print/printer.rs"]
mod printer;
#[path = "print/region.rs"]
mod region;
#[path = "print/seams.rs"]
mod seams;
#[path = "print/shapes.rs"]
mod shapes;
#[path = "print/stencil.rs"]
mod stencil;
#[path = "print/svg.rs"]
mod svg;
