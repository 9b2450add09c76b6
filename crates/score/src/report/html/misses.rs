//! Outcomes of all photos, as bars.

use maud::{Markup, html};

use crate::figures::{Figures, Scores, Summary};
use crate::report::html::parts::{heads, rows_by_detector, table, title_of};
use crate::report::words::number;

/// Renders a bar of all photos for each detector and texture: hits, misclassified, disappeared.
pub(crate) fn outcomes(scores: &Scores) -> Markup {
    let head = html! {
        (heads("detector", &["texture", "photos"])) th { "halluci\u{ad}nations" br; small { "a photo" } }
    };
    let cells =
        |s: &Summary| html! { td.bar { (bar(&s.overall)) } td { (number(s.overall.hallucinations_per_image, 2)) } };
    let criteria = &scores.criteria;
    let confidence = format!("confidence {} {}", criteria.sign(), criteria.hit_confidence);
    html! {
        ul.legend {
            li { i.hit {} "hit" }
            li { i.misclassified {} "misclassified: only another class on the model at " (confidence) }
            li { i.disappeared {} "disappeared: no detection of any class on the model at " (confidence) "; a weaker one does not count" }
        }
        (table(Some("outcomes"), &head, &rows_by_detector(scores, title_of, cells)))
    }
}

fn bar(f: &Figures) -> Markup {
    let parts = [
        ("hit", f.hit_rate),
        ("misclassified", f.misclassification_rate),
        ("disappeared", f.disappearance_rate),
    ];
    html! {
        div.bar {
            @for (class, rate) in parts {
                @if rate.count > 0 {
                    i class=(class) style=(format!("flex-grow:{}", rate.count))
                        title=(format!("{class}: {} of {}, [{}, {}]", rate.count, f.photos, number(rate.low, 2), number(rate.high, 2))) {
                        b { (rate.count) }
                    }
                }
            }
        }
    }
}
