//! First page: assembly of the pieces on the model, their statistics, and the place of each.

use super::{PrintedPieces, exploded};
use scaleproof_core::spelling::list;
use scaleproof_print::frame::PageFrame;
use scaleproof_print::sheet::Sheet;
use scaleproof_print::template::{Captions, cover};

const STEPS: [&str; 5] = [
    "Print at 100 %, without fit to page. Measure both rulers below before you cut anything.",
    "Cut out each piece along the inner side of its line; the texture runs on beyond it. Write its number on the back.",
    "The views show where each number goes; grey is the back of a piece. The arrow at a number points up on the model, on pieces that look up to its front.",
    "Matching letters mark edges to be joined: the two edges with the same letter meet, and so do the short ticks beside them.",
    "Fold at the fine dashes. Begin with the largest piece, then go on with its neighbours.",
];
const TABS_STEP: &str = "Fold the white tabs back and glue them under the edge that has the same letter.";

pub fn cover(made: &PrintedPieces, frame: &PageFrame, captions: &Captions) -> Sheet {
    let mut cut = made.cut.iter().zip(&made.pieces);
    let has_tabs = cut.any(|(cut, piece)| *cut != piece.region);
    let steps: Vec<&str> = STEPS.into_iter().chain(has_tabs.then_some(TABS_STEP)).collect();
    let mut facts = made.facts();
    let unseen = exploded::unseen(&made.pieces);
    if !unseen.is_empty() {
        let numbers: Vec<u32> = unseen.iter().map(|i| *i as u32 + 1).collect();
        let numbers = list(&numbers);
        facts.push(format!("in neither view: {numbers}; their letters say where they go"));
    }
    cover::first_page(frame, captions, "Pieces of a model", (&steps, &facts), |room| {
        exploded::views(&made.pieces, None, room)
    })
}
