//! State of the page as one small JSON value, with the newest frame's measurements as three meters: focus, light, steadiness.

use std::collections::BTreeSet;

use serde::Serialize;

use super::dial::{DialRing, DialRings};
use crate::{FrameAnswer, Guidance, MAX_BLUR_PX, MAX_CLIPPED, MAX_MOVED_PX, MAX_WHITE, MIN_WHITE, Target};
use scaleproof_pose::scene::{Bin, Viewpoint};
use scaleproof_pose::tags::{SeenTag, limit_scale};

/// Facts that stay the same while a capture runs.
#[derive(Debug, Clone, Serialize)]
pub struct CaptureInfo {
    pub variant: String,
    pub place: String,
    /// Kind of the source, in a word.
    pub source: &'static str,
    /// A running camera; its calibration does not fit a phone's photos, so the page takes none.
    pub is_stream: bool,
    /// Targets are the viewpoints of another session.
    pub is_paired: bool,
    /// Width and height of the images that the camera file is for: what a device films must have them.
    pub camera_px: [u32; 2],
}

/// Interim result of the pairs of a session that grows.
#[derive(Debug, Clone, Serialize)]
pub struct PairsSoFar {
    pub sentence: String,
    /// No photo is needed any more.
    pub is_decided: bool,
    /// The view that would tell most.
    #[serde(skip)]
    pub next: Option<usize>,
}

/// State of the page.
#[derive(Debug, Serialize)]
pub(super) struct PageState<'a> {
    pub revision: u64,
    pub about: &'a CaptureInfo,
    pub rings: &'a [DialRing],
    pub sectors: Vec<Sector>,
    pub views: Vec<ViewState<'a>>,
    pub filled: usize,
    pub frame: Option<&'a ShownFrame>,
    /// Interim result of the pairs; `None` if pairs are not evaluated while they are taken.
    pub pairs: Option<&'a PairsSoFar>,
    /// The view that is required next: the one that would tell most, else by where the camera was last.
    pub next: Option<usize>,
    pub source_ended: bool,
    /// The last words: how the capture ended.
    pub ended: Option<&'a str>,
}

/// A bin in which photos are required.
#[derive(Debug, Serialize)]
pub(super) struct Sector {
    pub azimuth_deg: f64,
    pub width_deg: f64,
    pub ring: usize,
    pub name: String,
    /// `empty`, `ok`, or `redo` when a photo of it was taken back.
    pub state: &'static str,
}

/// A required view.
#[derive(Debug, Serialize)]
pub(super) struct ViewState<'a> {
    pub azimuth_deg: f64,
    pub radius_share: f64,
    pub sector: usize,
    pub name: String,
    pub state: &'static str,
    pub photo: Option<&'a str>,
}

/// The newest frame.
#[derive(Debug, Clone, Serialize)]
pub(super) struct ShownFrame {
    pub number: u64,
    pub name: String,
    pub size_px: [u32; 2],
    pub tags: Vec<TagOutline>,
    pub viewpoint: Option<Viewpoint>,
    /// Camera's distance from the dial's centre, as a share of its radius.
    pub radius_share: Option<f64>,
    /// Closeness of the next view: 1 within tolerance, towards 0 far away.
    pub closeness: f64,
    pub photo: Option<String>,
    pub code: &'static str,
    pub advice: String,
    pub meters: [Meter; 3],
    pub film: Option<FilmedView>,
}

/// Overlay on the picture that a device films.
#[derive(Debug, Clone, Serialize)]
pub(super) struct FilmedView {
    /// The number that its page made up.
    pub device: u32,
    /// Outline of each sector on the ground about the model, as `TagOutline::corners_px`; empty without a pose.
    pub ground_px: Vec<Vec<[f64; 2]>>,
}

/// A tag's border.
#[derive(Debug, Clone, Serialize)]
pub(super) struct TagOutline {
    pub id: u32,
    pub is_whole: bool,
    /// Pixels of the frame; (0, 0) is the corner of the image.
    pub corners_px: [[f64; 2]; 4],
}

/// Returns the required bins in their order, one for each sector.
pub(super) fn bins(guidance: &Guidance) -> Vec<Bin> {
    let bins: BTreeSet<Bin> = guidance.targets().iter().map(|target| target.bin).collect();
    bins.into_iter().collect()
}

/// Returns the sectors and views of a capture; `redo` has the targets whose photo was taken back.
pub(super) fn views<'a>(
    guidance: &'a Guidance,
    rings: &DialRings,
    bins: &[Bin],
    redo: &BTreeSet<usize>,
) -> (Vec<Sector>, Vec<ViewState<'a>>) {
    let view = |(index, target): (usize, &'a Target)| ViewState {
        azimuth_deg: target.viewpoint.azimuth_deg,
        radius_share: rings.radius_share(&target.viewpoint),
        sector: bins.iter().position(|bin| *bin == target.bin).unwrap_or_default(),
        name: name(&target.viewpoint),
        state: match target.photo {
            Some(_) => "ok",
            None if redo.contains(&index) => "redo",
            None => "empty",
        },
        photo: target.photo.as_deref(),
    };
    let views: Vec<ViewState> = guidance.targets().iter().enumerate().map(view).collect();
    let sector = |(index, bin): (usize, &Bin)| {
        let states: BTreeSet<&str> = views.iter().filter(|v| v.sector == index).map(|v| v.state).collect();
        Sector {
            azimuth_deg: bin.azimuth_deg,
            width_deg: guidance.azimuth_step_deg(),
            ring: rings.ring_of(bin),
            name: format!("{:.0}°", bin.azimuth_deg),
            // Of several views in one bin, what is left to do counts.
            state: (["redo", "empty", "ok"].into_iter().find(|state| states.contains(state))).unwrap_or("empty"),
        }
    };
    let sectors = bins.iter().enumerate().map(sector).collect();
    (sectors, views)
}

fn name(v: &Viewpoint) -> String {
    let (round, up, away_cm) = (v.azimuth_deg, v.pitch_deg, v.distance_mm / 10.0);
    format!("{round:.0}° round, {up:.0}° up, {away_cm:.0} cm away")
}

impl ShownFrame {
    pub(super) fn new(
        number: u64,
        name: &str,
        answer: &FrameAnswer,
        guidance: &Guidance,
        rings: &DialRings,
        is_stream: bool,
    ) -> ShownFrame {
        let off_by = |from| Some(guidance.off_by(guidance.nearest_open(&from)?, &from));
        let photo = answer.verdict.as_ref().ok().map(|(photo, _)| photo.clone());
        ShownFrame {
            number,
            name: name.to_owned(),
            size_px: answer.size_px,
            tags: answer.tags.iter().map(outline).collect(),
            viewpoint: answer.viewpoint,
            radius_share: answer.viewpoint.map(|from| rings.radius_share(&from)),
            closeness: (answer.viewpoint.and_then(off_by)).map_or(0.0, |off_by| 1.0 / off_by.max(1.0)),
            code: answer.verdict.as_ref().err().map_or("accepted", |advice| advice.code()),
            advice: said(answer, guidance),
            photo,
            meters: meters(answer, is_stream),
            film: None,
        }
    }
}

/// Returns the one sentence: the advice, or that the photo is taken and the next step.
fn said(answer: &FrameAnswer, guidance: &Guidance) -> String {
    let sentence = match &answer.verdict {
        Err(advice) => advice.to_string(),
        Ok(_) => {
            let from = answer.viewpoint;
            let step = from.and_then(|from| guidance.step(guidance.nearest_open(&from)?, &from));
            match step {
                Some(step) => format!("taken; next: {step}"),
                None if guidance.is_finished() => "taken; all views are there".into(),
                None => "taken; hold still for the next".into(),
            }
        }
    };
    let mut letters = sentence.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

fn outline(tag: &SeenTag) -> TagOutline {
    TagOutline {
        id: tag.id,
        is_whole: tag.is_whole,
        corners_px: tag.corners_px.map(from_corner),
    }
}

/// Converts a pixel whose (0, 0) is the centre of the top-left one to the page's, whose (0, 0) is the image's corner.
pub(super) fn from_corner(px: [f64; 2]) -> [f64; 2] {
    px.map(|v| ((v + 0.5) * 10.0).round() / 10.0)
}

/// One meter. Positions are shares of its length, and more is better up to the end of the good zone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Meter {
    pub name: &'static str,
    /// `None` when it was not measured.
    pub position: Option<f64>,
    pub good_zone: [f64; 2],
    pub is_good: Option<bool>,
    /// The reading in words, so that nothing depends on colour alone.
    pub text: String,
}

/// Returns the meters of a frame; steadiness is measured in a stream alone.
fn meters(answer: &FrameAnswer, is_stream: bool) -> [Meter; 3] {
    let (measures, scale) = (&answer.measures, limit_scale(answer.size_px));
    let steadiness = if is_stream {
        let limit_px = MAX_MOVED_PX * scale;
        up_to("steadiness", measures.moved_px, limit_px, ["steady", "moving"])
    } else {
        unmeasured("steadiness", "single photos")
    };
    let limit_px = MAX_BLUR_PX * scale;
    let focus = up_to("focus", measures.blur_px, limit_px, ["sharp", "blurred"]);
    [focus, light(answer), steadiness]
}

/// Returns the meter of a length in px that should be small; the limit is its middle.
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

/// Returns the meter of the level of the tags' paper, and of the share that has lost its tone.
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
