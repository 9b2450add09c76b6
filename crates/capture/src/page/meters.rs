//! What was measured of a frame, as three meters: focus, light, steadiness.

use serde::Serialize;

use crate::capture::{FrameAnswer, MAX_BLUR_PX, MAX_CLIPPED, MAX_MOVED_PX, MAX_WHITE, MIN_WHITE, enlargement};

/// One meter. Positions are shares of its length, and more is better up to the end of the good zone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Meter {
    pub name: &'static str,
    /// `None` when it was not measured.
    pub position: Option<f64>,
    pub good_zone: [f64; 2],
    pub is_good: Option<bool>,
    /// In words, so that nothing is said by colour alone.
    pub text: String,
}

/// The meters of a frame; steadiness is measured in a stream alone.
pub(super) fn meters(answer: &FrameAnswer, is_stream: bool) -> [Meter; 3] {
    let (measures, enlargement) = (&answer.measures, enlargement(answer.size_px));
    let steadiness = if is_stream {
        let limit_px = MAX_MOVED_PX * enlargement;
        up_to("steadiness", measures.moved_px, limit_px, ["steady", "moving"])
    } else {
        unmeasured("steadiness", "single photos")
    };
    let limit_px = MAX_BLUR_PX * enlargement;
    let focus = up_to("focus", measures.blur_px, limit_px, ["sharp", "blurred"]);
    [focus, light(answer), steadiness]
}

/// A length in px that should be small; the limit is the middle of the meter.
fn up_to(name: &'static str, px: Option<f64>, limit_px: f64, [good, bad]: [&str; 2]) -> Meter {
    let Some(px) = px else {
        return unmeasured(name, "not known");
    };
    let is_good = px <= limit_px;
    Meter {
        name,
        position: Some((1.0 - px / (2.0 * limit_px)).max(0.0)),
        good_zone: [0.5, 1.0],
        is_good: Some(is_good),
        text: format!("{}: {px:.1} px, up to {limit_px:.1}", if is_good { good } else { bad }),
    }
}

/// The level of the tags' paper, and what has lost its tone.
fn light(answer: &FrameAnswer) -> Meter {
    let Some(white) = answer.measures.white_level else {
        return unmeasured("light", "not known");
    };
    let is_clipped = answer.measures.clipped_share.is_some_and(|share| share > MAX_CLIPPED);
    let said = if white < MIN_WHITE {
        "too dark"
    } else if white > MAX_WHITE || is_clipped {
        "too bright"
    } else {
        "good"
    };
    Meter {
        name: "light",
        position: Some(white / 255.0),
        good_zone: [MIN_WHITE / 255.0, MAX_WHITE / 255.0],
        is_good: Some(said == "good"),
        text: format!("{said}: white paper is {white:.0} of 255"),
    }
}

fn unmeasured(name: &'static str, text: &str) -> Meter {
    Meter {
        name,
        position: None,
        good_zone: [0.0, 0.0],
        is_good: None,
        text: text.into(),
    }
}
