//! Colours of the variants.

use crate::figures::Scores;
use scaleproof_plot::Colour;

/// Returns the colours of the variants, with their names.
pub(crate) fn legend(scores: &Scores) -> Vec<(Colour, String)> {
    let all = scores.variants().into_iter().enumerate();
    all.map(|(i, variant)| (colour(i), variant.to_owned())).collect()
}

/// Returns the colour of the variant at `index`; the base variant is grey. None is a colour of an outcome.
pub(crate) fn colour(index: usize) -> Colour {
    Colour([0x5b6573, 0x0f7f8c, 0x1f4fb4, 0xa0522d, 0xb03a9b, 0x4a4a9c][index % 6])
}
