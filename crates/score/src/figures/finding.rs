//! Finding on one detector and texture.

use serde::{Deserialize, Serialize};

/// Effect of a texture on a detector, as far as the photos show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// The hit rate is shown to fall beside the confidence, and at most one photo in four is still a hit.
    Hides,
    /// The confidence is shown to fall.
    Weakens,
    /// The confidence is shown to rise.
    Strengthens,
    /// Nothing is shown.
    NothingShown,
    /// The detector does not see the base (mean confidence below 0.1), so that no photo can tell.
    BaseUnseen,
}

impl Effect {
    pub fn is_shown(self) -> bool {
        matches!(self, Effect::Hides | Effect::Weakens | Effect::Strengthens)
    }
}

/// Finding on a detector and texture, with the figures that decided it (explained in comparing.md).
///
/// The confidence is the primary endpoint: that of the strongest detection that counts as the model, 0 where there is none, paired by view. The hit rate
/// is the second, with an error rate of its own, and is tested only where the confidence is shown to fall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Finding {
    /// Effect that these photos show for these places.
    pub effect: Effect,
    /// True if an effect was shown and is withheld, since it does not stand when photos that show the same moment again count once.
    pub withheld_for_copies: bool,
    /// An effect that was shown and is held back, since the control moves this detector by as much: its mean confidence, or of `hides` its hit rate, which leaves
    /// `weakens`; `null` where nothing is held back.
    pub withheld_by_control: Option<Effect>,
    /// p of the mean confidence by flipped signs of the views (place × bin), two-sided, corrected for the detectors.
    pub confidence_p: f64,
    /// The confidence is shown to change where its p is no larger: the texture's share of 5 %.
    pub confidence_level: f64,
    /// p of the hit rate, as that of the confidence.
    pub hit_rate_p: f64,
    /// The hit rate is shown to change where its p is no larger: the texture's share of another 5 %.
    pub hit_rate_level: f64,
    /// Number of further views from which the smallest possible p is within the share; 0 where the views are enough.
    pub views_missing: usize,
    /// The smallest drop of the mean confidence that as many views, spread as these, show with a chance of 0.8; `null` where an effect is shown, where no
    /// drop from this base is, and with too few views.
    pub drop_shown_from: Option<f64>,
    /// Finding for places like these; `null` where no effect is shown for these places.
    pub in_places_like_these: Option<InPlacesLikeThese>,
}

/// Finding on whether an effect holds for places like these.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct InPlacesLikeThese {
    pub effect: Effect,
    /// p of the mean confidence by flipped signs of whole places, corrected for the detectors.
    pub confidence_p: f64,
    /// Number of further places from which the smallest possible p is within the texture's share; 0 where the places are enough.
    pub places_missing: usize,
}
