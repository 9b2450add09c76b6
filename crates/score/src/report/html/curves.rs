//! Curves of every detector.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::charts::curves::charts;
use crate::report::html::parts::{colour_names, small_charts};

pub(crate) fn section(scores: &Scores) -> Markup {
    let both = charts(scores).into_iter().flat_map(|(title, charts)| {
        let captions = ["found from a confidence", "precision over recall"];
        let captions = captions.map(|what| html! { (title) br; small { (what) } });
        captions.into_iter().zip(charts)
    });
    html! {
        ul.legend { (colour_names(&scores.variants())) }
        (small_charts(both))
        p.note {
            "Found: share of photos that show the model at this confidence or more, with its 95 % Wilson interval; upright line: the confidence of a hit. "
            "Precision and recall of the detections of the class at IoU 0.5, from the most confident down to 0.001."
        }
    }
}
