//! Results of `attack photos`, as JSON and in words.

use std::io::Write;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_frames::photos::{FramedView, LeftOutPhoto, PhotoFrames};

/// `attack photos --json`.
#[derive(Serialize, JsonSchema)]
pub struct FramesOfPhotos<'a> {
    /// The path of `frames.json`.
    pub file: &'a Path,
    /// How many frames it lists.
    pub frames: usize,
    pub views: &'a [FramedView],
    pub left_out: &'a [LeftOutPhoto],
}

pub fn say(made: &PhotoFrames, out: &mut dyn Write) -> std::io::Result<()> {
    for view in &made.views {
        let others = view.others.iter().map(|other| {
            let (photo, turn_deg, [r, g, b]) = (&other.photo, other.turn_deg, other.light_factors);
            format!("{photo} ({turn_deg:.1}° aside, light × {r:.2} {g:.2} {b:.2})")
        });
        writeln!(
            out,
            "{}: {} with {}; {:.0} % of its paint is seen by all",
            view.name,
            view.reference,
            others.collect::<Vec<_>>().join(", "),
            100.0 * view.paint_seen_by_all
        )?;
    }
    let others = made.views.iter().flat_map(|view| &view.others);
    let gains = others.flat_map(|other| other.light_factors);
    let most = gains.map(|gain| gain.max(1.0 / gain)).fold(1.0, f64::max);
    if most > MOST_GAIN {
        say!(
            "note: the photos' exposures or white balances differ by up to × {most:.1}, and a camera's tone curve is not sRGB's: colours are less \
             exact than with one exposure; lock it, for black, grey and white paint alike"
        );
    }
    say_left_out(&made.left_out, out)
}

pub fn say_left_out(left_out: &[LeftOutPhoto], out: &mut dyn Write) -> std::io::Result<()> {
    let mut lines = left_out.iter();
    lines.try_for_each(|left| writeln!(out, "left out: {}: {}", left.what, left.reason))
}

/// Exposures that differ by more cost accuracy, as cameras' tone curves are not sRGB's.
pub const MOST_GAIN: f64 = 1.2;
