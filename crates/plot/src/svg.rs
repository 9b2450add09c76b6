//! Writing of drawings as SVG: inline in a page, and as a file of its own.

use maud::{Markup, PreEscaped, html};

use super::drawing::Drawing;
use super::mark::{Mark, Shape, Text};
use super::series::WHITE;

impl Drawing {
    /// Returns the SVG for a page, whose style sets its size by the class.
    pub fn inline(&self, class: Option<&str>) -> Markup {
        let [left, top, width, height] = self.area;
        html! {
            svg class=[class] viewBox=(format!("{left} {top} {width} {height}")) role="img" aria-label=(self.label) { (markup(&self.marks)) }
        }
    }

    /// Returns an SVG file, on white.
    pub fn svg(&self) -> String {
        let [left, top, width, height] = self.area;
        let ground = Mark::rect([left, top], [width, height]).filled(WHITE);
        let svg = html! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("{left} {top} {width} {height}")) width=(width) height=(height) role="img"
                aria-label=(self.label) font-family="DejaVu Sans, Verdana, sans-serif" {
                (markup(&[ground])) (markup(&self.marks))
            }
        };
        svg.into_string()
    }
}

/// Returns the content of an `svg` element.
pub fn markup(marks: &[Mark]) -> Markup {
    PreEscaped(marks.iter().map(element).collect())
}

fn element(mark: &Mark) -> String {
    let mut inside = html! { @if let Some(title) = &mark.title { title { (title) } } };
    let (name, place) = match &mark.shape {
        Shape::Line([[x1, y1], [x2, y2]]) => ("line", format!("x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"")),
        Shape::Polyline(points) => ("polyline", format!("{} stroke-linejoin=\"round\"", through(points))),
        Shape::Polygon(points) => ("polygon", through(points)),
        Shape::Rect([x, y], [w, h]) => ("rect", format!("x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"")),
        Shape::Circle([x, y], radius) => ("circle", format!("cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"")),
        Shape::Text(text) => {
            inside = html! { (inside) (text.words) };
            ("text", lettering(text))
        }
        Shape::Group([x, y], marks) => {
            inside = html! { (inside) (markup(marks)) };
            ("g", format!("transform=\"translate({x} {y})\""))
        }
    };
    format!("<{name} {place}{}>{}</{name}>", paint(mark), inside.0)
}

fn through(points: &[[f64; 2]]) -> String {
    let corners: Vec<String> = points.iter().map(|[x, y]| format!("{x},{y}")).collect();
    format!("points=\"{}\"", corners.join(" "))
}

fn lettering(text: &Text) -> String {
    let ([x, y], size) = (text.at, text.size);
    let anchor = ["start", "middle", "end"][text.anchor as usize];
    let weight = if text.is_bold { " font-weight=\"600\"" } else { "" };
    let angle = if text.is_upright {
        format!(" transform=\"rotate(-90 {x} {y})\"")
    } else {
        String::new()
    };
    format!("x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{weight}{angle}")
}

fn paint(mark: &Mark) -> String {
    let mut paint = match (mark.fill, &mark.shape) {
        (Some(colour), _) => format!(" fill=\"{colour}\""),
        (None, Shape::Line(_) | Shape::Group(..)) => String::new(),
        _ => " fill=\"none\"".to_owned(),
    };
    if mark.opacity < 1.0 {
        paint += &format!(" fill-opacity=\"{}\"", mark.opacity);
    }
    if let Some((colour, width)) = mark.stroke {
        let dashes = if mark.is_dashed {
            " stroke-dasharray=\"4 3\""
        } else {
            ""
        };
        let order = if let Shape::Text(_) = mark.shape {
            " paint-order=\"stroke\""
        } else {
            ""
        };
        paint += &format!(" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}{order}");
    }
    paint
}
