//! The one most useful thing to tell the photographer about a frame that is not taken.

use std::fmt;

use super::guidance::NextMove;
use crate::locate::Abstention;

/// Why a frame is not taken, as something to do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Advice {
    /// The source's own sentence.
    Unreadable(String),
    /// The very file is in the session.
    Repeated {
        photo: String,
    },
    /// The very file was taken back by hand.
    TakenBack,
    TooDark,
    TooBright,
    /// Standard deviation of the blur, px; `None` when nothing could be found for it.
    Blurred {
        blur_px: Option<f64>,
    },
    /// The tags are too small in the image to tell whether it is sharp.
    TooSmall,
    Moving,
    /// All gates hold: it is taken when they still do in a moment.
    Hold,
    /// All gates hold, and photos are taken by hand only.
    Ready,
    NoTags,
    OneTag {
        id: u32,
        /// The tag beside it that should be seen too, if the scene has one.
        beside: Option<u32>,
    },
    /// No pose for another reason.
    NotLocated(Abstention),
    Walk(NextMove),
    /// This view is there; the step to the next.
    Filled {
        then: Option<NextMove>,
    },
}

impl Advice {
    /// A stable name for programs.
    pub(crate) fn code(&self) -> &'static str {
        match self {
            Advice::Unreadable(_) => "unreadable",
            Advice::Repeated { .. } => "repeated",
            Advice::TakenBack => "taken_back",
            Advice::TooDark => "too_dark",
            Advice::TooBright => "too_bright",
            Advice::Blurred { .. } => "blurred",
            Advice::TooSmall => "too_small",
            Advice::Moving => "moving",
            Advice::Hold => "hold",
            Advice::Ready => "ready",
            Advice::NoTags => "no_tags",
            Advice::OneTag { .. } => "one_tag",
            Advice::NotLocated(abstention) => abstention.code(),
            Advice::Walk(NextMove::Azimuth(_)) => "azimuth",
            Advice::Walk(NextMove::Distance(_)) => "distance",
            Advice::Walk(NextMove::Height(_)) => "height",
            Advice::Filled { .. } => "filled",
        }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Advice::Unreadable(sentence) => f.write_str(sentence),
            Advice::Repeated { photo } => write!(f, "this very photo is in the session already, as {photo}"),
            Advice::TakenBack => f.write_str("this very photo was taken back: take another"),
            Advice::TooDark => f.write_str("too dark: more light, or a longer exposure"),
            Advice::TooBright => f.write_str("too bright: less light, or a shorter exposure"),
            Advice::Blurred { blur_px: Some(px) } if px.is_finite() => {
                write!(f, "hold still and let it focus: blurred by {px:.1} px")
            }
            Advice::Blurred { .. } => f.write_str("hold still and let it focus: blurred"),
            Advice::TooSmall => {
                f.write_str("the tags are too small to tell whether it is sharp: closer, or a larger image")
            }
            Advice::Moving => f.write_str("hold still"),
            Advice::Hold => f.write_str("good: stay like this"),
            Advice::Ready => f.write_str("good: take the photo"),
            Advice::NoTags => f.write_str("I see no tag: step back, or uncover the tags"),
            Advice::OneTag {
                id,
                beside: Some(beside),
            } => {
                write!(
                    f,
                    "I see only tag {id}: uncover tag {beside} beside it, or turn its card to the camera"
                )
            }
            Advice::OneTag { id, beside: None } => write!(f, "I see only tag {id}: let a second tag be seen"),
            Advice::NotLocated(abstention) => abstention.fmt(f),
            Advice::Walk(step) => step.fmt(f),
            Advice::Filled { then: None } => f.write_str("this view is there already"),
            Advice::Filled { then: Some(step) } => write!(f, "this view is there already; next: {step}"),
        }
    }
}

/// From the standpoint of somebody who faces the model. Never "0°": the step is not done yet.
impl fmt::Display for NextMove {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let cm = |mm: f64| (mm.abs() / 10.0).round().max(1.0);
        match *self {
            NextMove::Azimuth(deg) => {
                let side = if deg > 0.0 { "right" } else { "left" };
                write!(f, "{:.0}° to the {side}", deg.abs().round().max(1.0))
            }
            NextMove::Distance(mm) => write!(f, "{:.0} cm {}", cm(mm), if mm > 0.0 { "back" } else { "closer" }),
            NextMove::Height(mm) => write!(f, "{:.0} cm {}", cm(mm), if mm > 0.0 { "higher" } else { "lower" }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_said_as_to_a_person() {
        let said = [
            NextMove::Azimuth(-12.3),
            NextMove::Azimuth(0.2),
            NextMove::Distance(-204.0),
            NextMove::Distance(58.0),
            NextMove::Height(70.0),
            NextMove::Height(-1.0),
        ]
        .map(|step| step.to_string());
        assert_eq!(
            said,
            [
                "12° to the left",
                "1° to the right",
                "20 cm closer",
                "6 cm back",
                "7 cm higher",
                "1 cm lower"
            ]
        );
    }
}
