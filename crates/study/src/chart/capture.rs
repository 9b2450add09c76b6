//! Guided capture: time of a frame from its bytes to the sentence of advice, by tag detector.

use serde::Serialize;

use super::MeasureError;
use super::locate::detectors;
use scaleproof_capture::{Guidance, Judge, Tolerance};
use scaleproof_core::workers::fastest;
use scaleproof_photo::{Budget, Photo};
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, distinct, scatter};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bins, Scene};
use scaleproof_pose::tags::TagDetectorChoice;

/// Limits of guided capture for the median and for 95 % of the frames, ms: a person who moves a camera does not notice them yet.
pub const LIMITS_MS: [f64; 2] = [60.0, 120.0];

/// One tag detector, judging frames one way.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CaptureRow {
    pub tag_detector: &'static str,
    /// True if frames are judged as those of a running camera, which a faster search sees first, rather than as photos.
    pub is_stream: bool,
    /// Frames measured on.
    pub frames: usize,
    /// Share of the frames that got a pose.
    pub located: f64,
    /// Median time from the photo's bytes to the advice.
    pub median_ms: f64,
    /// Time from the photo's bytes to the advice that 95 % of the frames do not exceed.
    pub p95_ms: f64,
    /// True if it is what the program uses.
    pub is_default: bool,
}

/// Measures every tag detector with the common fit on the same frames (JPEG files), one after the other on one thread: decoding, tags, pose,
/// gates, and the sentence. `on_done` is called after each frame of each row.
pub fn measure(
    frames: &[(String, Vec<u8>)],
    scene: &Scene,
    camera: &Camera,
    on_done: impl Fn(),
) -> Result<Vec<CaptureRow>, MeasureError> {
    // Times are of one core: OpenCV gets one thread.
    let _ = opencv::core::set_num_threads(1);
    for (name, bytes) in frames {
        let photo = Photo::from_bytes(name.as_ref(), bytes.clone(), Budget::FILE)?;
        camera.for_photo(photo.width, photo.height, photo.turned_deg)?;
    }
    let guidance = unreachable(&scene.bins);
    let mut rows = Vec::new();
    for (choice, is_stream) in ways(scene) {
        let mut judge = Judge::new(scene, choice, is_stream)?;
        let (mut ms, mut located) = (Vec::new(), 0);
        for (name, bytes) in frames {
            let (is_located, time) = fastest(|| advice(name, bytes, &mut judge, camera, &guidance));
            located += usize::from(is_located?);
            ms.push(time);
            on_done();
        }
        ms.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let index = (share * ms.len() as f64).ceil() as usize;
            ms.get(index.saturating_sub(1)).copied().unwrap_or(f64::NAN)
        };
        rows.push(CaptureRow {
            tag_detector: choice.name(),
            is_stream,
            frames: frames.len(),
            located: located as f64 / frames.len().max(1) as f64,
            median_ms: at(0.5),
            p95_ms: at(0.95),
            is_default: choice == TagDetectorChoice::default() && is_stream,
        });
    }
    Ok(rows)
}

/// Returns the rows that [`measure`] gives: photos by each detector, and a stream by the one that has a faster search.
pub fn ways(scene: &Scene) -> Vec<(TagDetectorChoice, bool)> {
    let all = detectors(scene).into_iter();
    let fitted = all.filter(|choice| !TagDetectorChoice::PEERS.contains(choice));
    let photos = fitted.map(|choice| (choice, false));
    let stream = [(TagDetectorChoice::default(), true)];
    stream.into_iter().chain(photos).collect()
}

/// Judges a frame; returns true if it got a pose.
fn advice(
    name: &str,
    bytes: &[u8],
    judge: &mut Judge,
    camera: &Camera,
    guidance: &Guidance,
) -> Result<bool, MeasureError> {
    let photo = Photo::from_bytes(name.as_ref(), bytes.to_vec(), Budget::FILE)?;
    let judgement = judge.judge(&photo.luma()?, photo.turned_deg, camera, guidance);
    let sentence = judgement.verdict.err().map(|advice| advice.to_string());
    // The sentence is part of the work.
    std::hint::black_box(sentence);
    Ok(judgement.located.is_some())
}

/// Returns views that no frame shows, so that every frame gets advice.
fn unreachable(bins: &Bins) -> Guidance {
    let far_mm = 1e6;
    let pitch_deg = bins.pitch_deg.first().copied().unwrap_or_default();
    let tolerance = Tolerance::of_bins(bins, &[far_mm]);
    Guidance::at(&bins.viewpoints(&[pitch_deg], &[far_mm]), tolerance, bins)
}

/// Draws the chart: the median against the slowest twentieth; lower left is better.
pub fn draw(rows: &[CaptureRow]) -> String {
    let names: Vec<String> = distinct(rows.iter().map(|row| row.tag_detector.to_owned()));
    let dot = |row: &CaptureRow| Dot {
        x: row.median_ms,
        y: row.p95_ms,
        share: row.located,
        series: names.iter().position(|name| name == row.tag_detector).unwrap_or(0),
        shape: usize::from(!row.is_stream),
        name: row.is_default.then(|| format!("{}, running camera", row.tag_detector)),
        is_ringed: row.is_default,
    };
    let frames = rows.first().map_or(0, |row| row.frames);
    let [median, p95] = LIMITS_MS;
    scatter(&Cloud {
        title: "Guided capture: from frame to advice".to_owned(),
        note: format!(
            "{frames} frames; limits {median:.0} ms (median) and {p95:.0} ms (95 %); filled share of a mark: share located"
        ),
        x: PlotAxis::around(
            "median milliseconds, one core",
            Scale::Log,
            rows.iter().map(|row| row.median_ms),
        ),
        y: PlotAxis::around("95 % take no longer, ms", Scale::Log, rows.iter().map(|row| row.p95_ms)),
        colours: names.clone(),
        shapes: vec!["running camera".to_owned(), "photos".to_owned()],
        ringed: "the default".to_owned(),
        groups: vec![(String::new(), rows.iter().map(dot).collect())],
    })
    .svg()
}

/// Writes the rows as lines of text: milliseconds a frame, median and 95 %, and the share that was located.
pub fn table(rows: &[CaptureRow]) -> String {
    let mut text = "tags             frames          median ms   95 % ms  located\n".to_owned();
    for row in rows {
        let kind = if row.is_stream { "running camera" } else { "photos" };
        let mark = if row.is_default { " ← running camera" } else { "" };
        let (tags, median, p95, located) = (row.tag_detector, row.median_ms, row.p95_ms, 100.0 * row.located);
        text += &format!("{tags:<16} {kind:<15} {median:>9.1} {p95:>9.1} {located:>7.0}%{mark}\n");
    }
    text
}
