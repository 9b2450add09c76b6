//! Envelopes on the same photos: IoU of each truth box with the exact one, against milliseconds.

use std::path::Path;

use serde::Serialize;

use super::{MeasureError, milliseconds, true_boxes};
use scaleproof_core::geometry::{BoxPx, Rigid};
use scaleproof_core::message::message;
use scaleproof_core::statistics::median;
use scaleproof_core::workers::fastest;
use scaleproof_photo::Photo;
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, scatter};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::locate_photo;
use scaleproof_pose::scene::ScaleModel;
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_session::Session;
use scaleproof_session::envelope::{self, EnvelopeError, EnvelopeShape};

/// A photo with its pose and its exact box.
#[derive(Debug, Clone)]
pub struct LocatedSample {
    pub file: String,
    /// `T_camera_model`, as the tags give it.
    pub pose: Rigid,
    /// The session's camera, fitted to the photo.
    pub camera: Camera,
    /// Exact box of the model, px.
    pub truth: BoxPx,
}

/// Locates the photos of a session; returns those that the tags place, with the exact boxes in them, and a sentence about each of the others.
/// `on_photo` is called after each.
///
/// # Errors
/// A photo cannot be read, or none has a pose; the file does not have the truth about all of them.
pub fn placed(
    session: &Session,
    truth: &Path,
    on_photo: impl Fn(),
) -> Result<(Vec<LocatedSample>, Vec<String>), MeasureError> {
    let names: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let truths = true_boxes(truth, &names)?;
    let camera = session.known_camera()?;
    let mut tags = TagDetectorChoice::default().open(&session.scene.families())?;
    let (mut samples, mut not_located) = (Vec::new(), Vec::new());
    for (entry, truth) in session.photos.iter().zip(truths) {
        let photo = Photo::open(&session.photo_path(entry))?;
        match locate_photo(&photo, &session.scene, camera, &mut tags)?.pose_and_camera() {
            Ok((located, fitted)) => samples.push(LocatedSample {
                file: entry.file.clone(),
                pose: located.pose,
                camera: fitted.camera,
                truth,
            }),
            Err(reason) => not_located.push(format!("{}: {reason}", entry.file)),
        }
        on_photo();
    }
    match not_located.first() {
        Some(first) if samples.is_empty() => Err(message!("no photo has a pose; {first}").into()),
        _ => Ok((samples, not_located)),
    }
}

/// Returns the envelopes of a model: its box, and with a mesh its hull and its surface.
pub fn envelopes(mesh: Option<&Path>, model: &ScaleModel) -> Result<Vec<(&'static str, EnvelopeShape)>, EnvelopeError> {
    let mut shapes = vec![("box", EnvelopeShape::of_box(model))];
    if let Some(path) = mesh {
        let mesh = envelope::load(path, model)?;
        shapes.push(("hull", EnvelopeShape::hull(&mesh, model)));
        shapes.push(("mesh", EnvelopeShape::surface(&mesh, model)));
    }
    Ok(shapes)
}

/// One envelope and what it measured.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct EnvelopeRow {
    /// Envelope that the truth boxes are drawn around: `box`, `hull` or `mesh`.
    pub envelope: &'static str,
    /// True if it is the scene's.
    pub is_default: bool,
    /// Photos measured on.
    pub photos: usize,
    /// Share of the photos that got a truth box.
    pub answered: f64,
    /// IoU with the exact box: median over the photos that got a box, and in `iou_min` the smallest; `null` without one.
    pub iou_median: Option<f64>,
    pub iou_min: Option<f64>,
    /// Mean time a photo takes, one core.
    pub ms: f64,
    pub boxes: Vec<BoxFit>,
}

/// The truth box of one photo.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BoxFit {
    pub file: String,
    /// The truth box: left, top, right, bottom; `null` where `reason` says why.
    pub box_xyxy_px: Option<BoxPx>,
    /// IoU with the exact box; `null` without a box.
    pub iou: Option<f64>,
    /// Reason why there is no box, as a sentence; `null` where there is one.
    pub reason: Option<String>,
}

/// Measures envelopes, named; the one of the session's scene is the default.
pub fn measure(
    samples: &[LocatedSample],
    outlines: &[(&'static str, EnvelopeShape)],
    default: &str,
) -> Vec<EnvelopeRow> {
    let measured = |(name, outline): &(&'static str, _)| row(samples, name, outline, *name == default);
    outlines.iter().map(measured).collect()
}

fn row(samples: &[LocatedSample], envelope: &'static str, outline: &EnvelopeShape, is_default: bool) -> EnvelopeRow {
    let mut ms = 0.0;
    let fit = |sample: &LocatedSample| {
        let (found, took) = fastest(|| outline.box_in_photo(&sample.pose, &sample.camera));
        ms += took;
        BoxFit {
            file: sample.file.clone(),
            iou: found.as_ref().ok().map(|b| b.iou(&sample.truth)),
            reason: found.as_ref().err().map(ToString::to_string),
            box_xyxy_px: found.ok(),
        }
    };
    let boxes: Vec<BoxFit> = samples.iter().map(fit).collect();
    let ious: Vec<f64> = boxes.iter().filter_map(|fit| fit.iou).collect();
    let photos = samples.len();
    let mean = |sum: f64| sum / photos.max(1) as f64;
    EnvelopeRow {
        envelope,
        is_default,
        photos,
        answered: mean(ious.len() as f64),
        iou_median: median(&ious),
        iou_min: ious.iter().copied().reduce(f64::min),
        ms: mean(ms),
        boxes,
    }
}

/// Draws the chart: a colour an envelope, one mark for the median and one for the worst photo.
pub fn draw(rows: &[EnvelopeRow]) -> String {
    let dots = rows.iter().enumerate().flat_map(|(series, row)| {
        let dot = move |(shape, iou): (usize, Option<f64>)| {
            Some(Dot {
                x: row.ms,
                y: 1.0 - iou?,
                share: row.answered,
                series,
                shape,
                name: (shape == 0).then(|| row.envelope.to_owned()),
                is_ringed: row.is_default,
            })
        };
        [row.iou_median, row.iou_min].into_iter().enumerate().filter_map(dot)
    });
    let dots: Vec<Dot> = dots.collect();
    let photos = rows.first().map_or(0, |row| row.photos);
    scatter(&Cloud {
        title: "Truth box: error against time".to_owned(),
        note: format!("{photos} photos; filled share of a mark: share that got a truth box; lower left is better"),
        x: milliseconds(dots.iter().map(|dot| dot.x)),
        y: PlotAxis::around("1 − IoU with the exact box", Scale::Log, dots.iter().map(|dot| dot.y)),
        colours: rows.iter().map(|row| row.envelope.to_owned()).collect(),
        shapes: vec!["median photo".to_owned(), "worst photo".to_owned()],
        ringed: "the default".to_owned(),
        groups: vec![(String::new(), dots)],
    })
    .svg()
}

/// Writes the rows as lines of text: each envelope's IoU with the exact box, and milliseconds a photo.
pub fn table(rows: &[EnvelopeRow]) -> String {
    let mut text = "envelope   photos  answered  IoU median   IoU min  ms a photo\n".to_owned();
    for row in rows {
        let digits = |iou: Option<f64>| iou.map_or("–".to_owned(), |iou| format!("{iou:.4}"));
        let (envelope, photos, answered, ms) = (row.envelope, row.photos, 100.0 * row.answered, row.ms);
        let (median, min) = (digits(row.iou_median), digits(row.iou_min));
        let mark = if row.is_default { " ← the scene's" } else { "" };
        text += &format!("{envelope:<9} {photos:>7} {answered:>8.0}% {median:>11} {min:>9} {ms:>11.3}{mark}\n");
    }
    text
}
