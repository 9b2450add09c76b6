//! Charts over the image: coverage, residuals, uncertainty. One SVG unit is one pixel of the photos.

use maud::{Markup, html};

use crate::calibrate::result::{COVERAGE, Calibration};
use scaleproof_core::geometry::convex_hull;
use scaleproof_core::statistics::upper_median;

const DOT: &str = "#c62f3b";

/// Draws the corners that were seen, on the grid of their counts, and the region they span.
pub(super) fn coverage(found: &Calibration) -> Markup {
    let (w, h) = size(found);
    let most = f64::from(found.coverage.iter().copied().max().unwrap_or(1).max(1));
    let (cell_w, cell_h) = (w / COVERAGE as f64, h / COVERAGE as f64);
    let seen = found.coverage.iter().filter(|n| **n > 0).count();
    let body = html! {
        @for (i, count) in found.coverage.iter().enumerate() {
            @let (x, y) = ((i % COVERAGE) as f64 * cell_w, (i / COVERAGE) as f64 * cell_h);
            rect x=(px(x)) y=(px(y)) width=(px(cell_w)) height=(px(cell_h)) fill=(blue(f64::from(*count) / most * 0.6)) stroke="#d7dce2" {}
        }
        (region(found))
        @for [x, y] in found.photos.iter().flat_map(|p| &p.corners_px) {
            circle cx=(px(x + 0.5)) cy=(px(y + 0.5)) r=(px(w / 320.0)) fill=(DOT) {}
        }
    };
    let corners: usize = found.photos.iter().map(|p| p.corners_px.len()).sum();
    let note = format!(
        "{corners} corners, seen in {seen} of {} cells. Dashed: the region they span; outside it the camera is extrapolated.",
        COVERAGE * COVERAGE
    );
    figure(found, "Coverage", &note, &body)
}

pub(super) fn residuals(found: &Calibration) -> Markup {
    let (w, _) = size(found);
    let residuals = found.photos.iter().flat_map(|p| &p.residuals_px);
    let lengths: Vec<f64> = residuals.map(|[x, y]| x.hypot(*y)).collect();
    let usual = upper_median(&lengths).unwrap_or(1.0).max(1e-6);
    let times = round_to_one_digit(w / 45.0 / usual);
    let body = html! {
        @for photo in &found.photos {
            @for ([x, y], [dx, dy]) in photo.corners_px.iter().zip(&photo.residuals_px) {
                @let (x, y) = (x + 0.5, y + 0.5);
                line x1=(px(x)) y1=(px(y)) x2=(px(x + dx * times)) y2=(px(y + dy * times)) stroke="#1f77b4" stroke-width=(px(w / 640.0)) {}
                circle cx=(px(x)) cy=(px(y)) r=(px(w / 500.0)) fill="#1b1f24" {}
            }
        }
    };
    let note = format!(
        "From where the camera expects a corner's place towards where it was seen, {times} times enlarged; the median is {usual:.3} px. \
         Neighbours that point the same way are what the model does not explain."
    );
    figure(found, "Residuals", &note, &body)
}

pub(super) fn uncertainty(found: &Calibration) -> Markup {
    let (w, h) = size(found);
    let map = &found.map;
    let (cell_w, cell_h) = (w / f64::from(map.columns), h / f64::from(map.rows));
    let known: Vec<f64> = map.cells.iter().filter_map(|c| c.sigma_px).collect();
    let most = known.iter().copied().fold(1e-9, f64::max);
    let digits = if most < 0.1 { 3 } else { 2 };
    let body = html! {
        @for cell in &map.cells {
            @let (x, y) = (cell.px[0] + 0.5, cell.px[1] + 0.5);
            @let share = cell.sigma_px.map_or(0.0, |s| s / most);
            rect x=(px(x - cell_w / 2.0)) y=(px(y - cell_h / 2.0)) width=(px(cell_w + 0.5)) height=(px(cell_h + 0.5))
                fill=(if cell.sigma_px.is_some() { blue(share) } else { "#e8e8e8".to_owned() }) {}
            text x=(px(x)) y=(px(y + cell_h * 0.1)) text-anchor="middle" font-size=(px(cell_w * 0.3)) fill=(if share > 0.55 { "#fff" } else { "#1b1f24" }) {
                (cell.sigma_px.map_or_else(|| "–".to_owned(), |s| format!("{s:.digits$}")))
            }
        }
        (region(found))
    };
    let note = "Standard deviation in px of where a far point is projected, what a turn of the camera undoes taken out; dashed as above. \
                A small model looks surer than it is where no corner was seen.";
    figure(found, "Projection uncertainty", note, &body)
}

fn figure(found: &Calibration, title: &str, note: &str, body: &Markup) -> Markup {
    let (w, h) = size(found);
    html! {
        figure {
            h3 { (title) }
            svg viewBox=(format!("0 0 {w} {h}")) role="img" aria-label=(title) { (body) }
            figcaption.note { (note) }
        }
    }
}

/// Draws the convex hull of all corners.
fn region(found: &Calibration) -> Markup {
    let corners = found.photos.iter().flat_map(|p| p.corners_px.iter().copied()).collect();
    let point = |[x, y]: [f64; 2]| format!("{:.1},{:.1}", x + 0.5, y + 0.5);
    let points: Vec<String> = convex_hull(corners).into_iter().map(point).collect();
    let (w, _) = size(found);
    let dash = format!("{0:.0} {0:.0}", w / 80.0);
    html! {
        polygon points=(points.join(" ")) fill="none" stroke="#1b1f24" stroke-width=(px(w / 400.0)) stroke-dasharray=(dash) {}
    }
}

fn size(found: &Calibration) -> (f64, f64) {
    (f64::from(found.camera.width), f64::from(found.camera.height))
}

/// Returns a colour from white to a dark blue.
fn blue(share: f64) -> String {
    let share = share.clamp(0.0, 1.0);
    let [r, g, b] = [18.0, 72.0, 128.0].map(|to| (255.0 + (to - 255.0) * share).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn round_to_one_digit(v: f64) -> f64 {
    let power = 10f64.powf(v.log10().floor());
    (v / power).round() * power
}

fn px(v: f64) -> f64 {
    (v * 10.0).round() / 10.0
}
