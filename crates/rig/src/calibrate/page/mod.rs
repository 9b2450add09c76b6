//! The calibration as one self-contained page; no script, no link to anywhere.

mod charts;

use maud::{Markup, html};

use super::result::Calibration;
use super::summary::numbers;
use scaleproof_plot::plain_page;

pub fn page(found: &Calibration) -> String {
    let camera = &found.camera;
    let lead = html! {
        (found.photos.len()) " photos of " (camera.width) "×" (camera.height) " px"
        @if !found.left_out.is_empty() { ", " (found.left_out.len()) " left out" }
        @if let Some(board) = &found.board { "; " (board.line()) } @else { "; the tags of a scene" } "."
    };
    let content = html! {
        (headline(found))
        @for caution in &found.cautions { p.banner { "Note: " (caution.0) "." } }
        section { h2 { "Camera" } (camera_table(found)) }
        section { h2 { "Which model" } (ladder(found)) }
        section {
            h2 { "Over the image" }
            div.charts { (charts::coverage(found)) (charts::residuals(found)) (charts::uncertainty(found)) }
        }
        section { h2 { "Photos" } (photos(found)) (left_out(found)) }
    };
    plain_page(
        "Camera calibration",
        &lead,
        &content,
        "Pixel (0, 0) is the centre of the top-left pixel.",
    )
}

fn headline(found: &Calibration) -> Markup {
    let (c, s) = (&found.camera, &found.sigmas);
    let focal = match (c.fx == c.fy, s[0], s[1]) {
        (true, sigma, _) => format!("{:.2} ± {sigma:.2} px", c.fx),
        (false, x, y) => format!("{:.2} ± {x:.2}, {:.2} ± {y:.2} px", c.fx, c.fy),
    };
    let centre = if s[2] > 0.0 {
        format!("{:.2} ± {:.2}, {:.2} ± {:.2} px", c.cx, s[2], c.cy, s[3])
    } else {
        format!("{:.1}, {:.1} px (held)", c.cx, c.cy)
    };
    html! {
        div.figures {
            div { span { "focal length" } b { (focal) } }
            div { span { "principal point" } b { (centre) } }
            div { span { "error on unseen corners" } b { (format!("{:.3} px", found.chosen_model().held_out_px)) } }
            div { span { "model" } b { (found.chosen_model().model.name()) } }
        }
    }
}

fn camera_table(found: &Calibration) -> Markup {
    let rows = html! {
        @for (name, value, sigma, unit) in numbers(found) {
            tr {
                td { (name) }
                td { (format!("{value:.4}")) (unit) }
                td { @match sigma { Some(s) => { (format!("{s:.4}")) (unit) }, None => { "held" } } }
            }
        }
    };
    html! {
        (table(&["number", "value", "σ"], &rows))
        p.note {
            "σ is one standard deviation, from the scatter of the residuals (" (format!("{:.3}", found.rms_px)) " px, root mean square), "
            "or from leaving photos out where that is larger. It holds as far as the board is flat and the model right."
        }
    }
}

fn ladder(found: &Calibration) -> Markup {
    let worst = found.models.iter().map(|r| r.held_out_px).fold(0.0, f64::max);
    let rows = html! {
        @for (i, r) in found.models.iter().enumerate() {
            tr.chosen[i == found.chosen] {
                td { (r.model.name()) }
                td { (r.model.parameters()) }
                td.bar { i style=(width(r.held_out_px, worst)) {} }
                td { (format!("{:.3} ± {:.3} px", r.held_out_px, r.error_px)) }
                @if i == found.chosen {
                    td { "chosen" } td {}
                } @else {
                    td { (format!("{:.3}°", r.moves.direction_deg)) }
                    td { (format!("{:.2} mm ({:.3} %)", r.moves.distance_mm, r.moves.distance_percent)) }
                }
            }
        }
    };
    let heads = [
        "model",
        "numbers",
        "",
        "error on unseen corners",
        "moves azimuth by",
        "moves distance by",
    ];
    html! {
        (table(&heads, &rows))
        p.note {
            "The smallest model within one standard error, and 5 %, of the best is taken. Each is fitted without some photos; in these the pose comes "
            "from every other corner, and the error is that of the remaining corners. “Moves” is how far the camera of a photo would be "
            "elsewhere, seen from the board's middle, in the worst photo."
        }
    }
}

fn photos(found: &Calibration) -> Markup {
    let worst = found.photos.iter().map(|p| p.rms_px).fold(0.0, f64::max);
    let rows = html! {
        @for p in &found.photos {
            tr {
                td { (p.file) }
                td.bar { i style=(width(p.rms_px, worst)) {} }
                td { (format!("{:.3} px", p.rms_px)) }
                td { (p.corners_px.len()) }
                td { (format!("{:.1}°", p.tilt_deg)) }
                td { (format!("{:.0} mm", p.distance_mm)) }
                td { @if let Some(w) = p.edge_width_px { (format!("{w:.1} px")) } @else { "–" } }
            }
        }
    };
    table(
        &["photo", "", "error", "corners", "tilt", "distance", "edge width"],
        &rows,
    )
}

fn left_out(found: &Calibration) -> Markup {
    html! {
        @if !found.left_out.is_empty() {
            h3 { "Left out" }
            (table(&["photo", "reason"], &html! {
                @for out in &found.left_out { tr { td { (out.file) } td.wrap { (out.reason) } } }
            }))
        }
    }
}

/// Renders a table; the column without a head holds bars.
fn table(heads: &[&str], rows: &Markup) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { @for head in heads { @if head.is_empty() { th.bar { "" } } @else { th { (head) } } } } }
                tbody { (rows) }
            }
        }
    }
}

fn width(value: f64, most: f64) -> String {
    format!("width:{:.1}%", 100.0 * value / most.max(1e-12))
}
