//! Results of `attack run` and `attack baseline`, as JSON and in words.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_attack::run::history::History;
use scaleproof_attack::run::judge::HeldOutFigures;
use scaleproof_attack::run::view_set::ENOUGH_HELD_OUT;
use scaleproof_attack::setup::Setup;
use scaleproof_core::spelling::count;
use scaleproof_photo::defence::Defence;
use scaleproof_pose::scene::Classes;

/// Random cells that leave less AP@0.5 hide the model by themselves.
const LITTLE_AP: f64 = 0.1;

/// `attack run --json` and `attack baseline … --json`.
#[derive(Serialize, JsonSchema)]
pub struct Made<'a> {
    /// As in `history.json`, like the others without a remark.
    pub method: &'a str,
    pub seed: u64,
    pub tile_mm: f64,
    /// Along each side.
    pub cells: u32,
    /// The labels that count as the model.
    pub classes: &'a Classes,
    pub detectors: &'a [String],
    /// The path of the PNG; `null` for patches.
    pub pattern: Option<&'a Path>,
    pub queries: u64,
    /// On held-out views, predicted and not rendered.
    pub predicted: Option<HeldOutFigures>,
    /// Those of random cells on these views; of `attack run` alone, else `null`.
    pub random: Option<HeldOutFigures>,
}

/// Returns the figures of random cells as a line after a line break; where these hide the model already, it names frames that teach more.
pub fn beside(random: &HeldOutFigures) -> String {
    let hidden = if random.ap50 < LITTLE_AP {
        "; they hide the model here already: frames in which it is smaller, or in other lights, teach more"
    } else {
        ""
    };
    format!(
        "\nrandom cells on these views: AP@0.5 {:.2}, hit rate {:.2}, mean confidence {:.2}{hidden}",
        random.ap50, random.hit_rate, random.mean_confidence
    )
}

/// That the figures of a pattern that knows a defence are not under it, as a line after a line break.
pub fn undefended(defence: Defence) -> String {
    let name = defence.name();
    format!(
        "\nboth without the defence {name}: `scaleproof score --defence {name}` judges photos of the print under it"
    )
}

/// Returns the figures of the held-out views, said to be predictions: lines, each after a line break.
pub fn figures_in_words(setup: &Setup, history: &History, class: &Classes) -> String {
    let mut text = String::new();
    if let Some((entry, figures)) = history.last_judged() {
        let which = if setup.view_set.holds_out() {
            if setup.view_set.judged().len() < ENOUGH_HELD_OUT {
                "it was not made with (few: give 24 views or more, so that 12 are held out)"
            } else {
                "it was not made with"
            }
        } else {
            "it was made with (too few to hold any out)"
        };
        text += &format!(
            "\npredicted, not rendered: AP@0.5 {:.2}, hit rate {:.2}, mean confidence {:.2} on {} {which}; {} looked at in {:.0} s; \
             counts as the model: {class}",
            figures.ap50,
            figures.hit_rate,
            figures.mean_confidence,
            count(figures.views, "view"),
            count(entry.queries as usize, "image"),
            entry.wall_s
        );
    }
    if setup.view_set.unseen > 0 {
        let views = count(setup.view_set.unseen, "view");
        text += &format!("\nleft out, as the model's paint is not seen: {views}");
    }
    text
}
