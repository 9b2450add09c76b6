//! Advice to the photographer on a frame that is not taken: the one most useful.

use std::fmt;

use super::guidance::NextMove;
use scaleproof_pose::locate::Abstention;

/// Reason why a frame is not taken, as something to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Advice {
    /// The source's own sentence.
    #[error("{0}")]
    Unreadable(String),
    #[error("this very photo is in the session already, as {photo}")]
    Repeated { photo: String },
    #[error("this very photo was taken back: take another")]
    TakenBack,
    #[error("too dark: more light, or a longer exposure")]
    TooDark,
    #[error("too bright: less light, or a shorter exposure")]
    TooBright,
    /// Standard deviation of the blur, px; `None` when nothing could be found for it.
    #[error("hold still and let it focus: blurred{}", by(*blur_px))]
    Blurred { blur_px: Option<f64> },
    #[error("the tags are too small to tell whether it is sharp: closer, or a larger image")]
    TooSmall,
    /// A pose, but no tag whose border is whole.
    #[error("no tag is clear enough to tell whether it is sharp: hold still, and uncover a tag")]
    Unmeasured,
    #[error("hold still")]
    Moving,
    /// All gates hold: it is taken when they still do in a moment.
    #[error("good: stay like this")]
    Hold,
    /// All gates hold, and photos are taken by hand only.
    #[error("good: take the photo")]
    Ready,
    /// A pose by which no part of the model's box is in the image.
    #[error("the model is outside the photo: turn the camera to it")]
    NoModel,
    #[error("I see no tag: step back, or uncover the tags")]
    NoTags,
    /// One tag only, with the tag beside it that should be seen too, if the scene has one.
    #[error("I see only tag {id}: {}", second(*beside))]
    OneTag { id: u32, beside: Option<u32> },
    /// No pose for another reason.
    #[error("{0}")]
    NotLocated(Abstention),
    #[error("{0}")]
    Walk(NextMove),
    /// This view is there; the step to the next.
    #[error("this view is there already{}", next(*then))]
    Filled { then: Option<NextMove> },
}

fn by(blur_px: Option<f64>) -> String {
    let known = blur_px.filter(|px| px.is_finite());
    known.map_or(String::new(), |px| format!(" by {px:.1} px"))
}

fn second(beside: Option<u32>) -> String {
    match beside {
        Some(tag) => format!("uncover tag {tag} beside it, or turn its card to the camera"),
        None => "let a second tag be seen".into(),
    }
}

fn next(then: Option<NextMove>) -> String {
    then.map_or(String::new(), |step| format!("; next: {step}"))
}

impl Advice {
    /// Returns a stable name for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Advice::Unreadable(_) => "unreadable",
            Advice::Repeated { .. } => "repeated",
            Advice::TakenBack => "taken_back",
            Advice::TooDark => "too_dark",
            Advice::TooBright => "too_bright",
            Advice::Blurred { .. } => "blurred",
            Advice::TooSmall => "too_small",
            Advice::Unmeasured => "unmeasured",
            Advice::Moving => "moving",
            Advice::Hold => "hold",
            Advice::Ready => "ready",
            Advice::NoModel => "no_model",
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

/// Words for somebody who faces the model. Never "0°": the step is not done yet.
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
