//! Time of scoring a photo by stage, with poses from tags and with truth given.

use serde::Serialize;

use scaleproof_core::statistics::upper_median;
use scaleproof_core::workers::stopwatch::{Stage, StageMs};
use scaleproof_plot::Anchor::{End, Start};
use scaleproof_plot::{BLACK, Drawing, Explained, Mark, colour, figure};
use scaleproof_score::{EvaluatedDetector, ScoreError, TimedPhoto, timed_photos};
use scaleproof_session::{PhotoEntry, Session};

/// One detector on a session.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ScoreRow {
    pub detector: String,
    /// Source of the poses: the `tags`, or `given` where the session says where the model is.
    pub poses: &'static str,
    /// Photos measured on.
    pub photos: usize,
    /// Time of each stage of the work: median over the photos of each one's fastest round.
    pub stages: Vec<StageTime>,
    /// Photos per second on one thread.
    pub photos_per_second: f64,
}

/// Time of one stage of the work.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct StageTime {
    pub stage: Stage,
    pub ms: f64,
}

/// Measures every detector alone on one thread, in `rounds` rounds. `on_photo` is called after each photo.
pub fn measure(
    session: &Session,
    detectors: Vec<EvaluatedDetector>,
    rounds: usize,
    on_photo: impl Fn() + Sync,
) -> Result<Vec<ScoreRow>, ScoreError> {
    let mut rows = Vec::new();
    for detector in detectors {
        let mut session = session.clone();
        for poses in ways(&session) {
            let photos = fastest(&session, std::slice::from_ref(&detector), rounds, &on_photo)?;
            rows.push(row(&detector, poses, &photos));
            // The session as if it had been imported with its truth: the photos that were placed, with box and viewpoint.
            session.photos = photos.into_iter().map(|photo| photo.with_truth).collect();
        }
    }
    Ok(rows)
}

/// Returns the sources of the poses, one after the other: the tags, and then given; a session that says where the model is has no other way.
pub fn ways(session: &Session) -> Vec<&'static str> {
    let is_given = |photo: &PhotoEntry| photo.box_xyxy_px.is_some() && photo.viewpoint.is_some();
    if session.photos.iter().all(is_given) {
        vec!["given"]
    } else {
        vec!["tags", "given"]
    }
}

/// Returns each photo's fastest round. The first round, in which the network is opened, does not count.
fn fastest(
    session: &Session,
    detector: &[EvaluatedDetector],
    rounds: usize,
    on_photo: &(impl Fn() + Sync),
) -> Result<Vec<TimedPhoto>, ScoreError> {
    let all = |ms: &StageMs| ms.iter().sum::<f64>();
    let mut rounds = timed_photos(session, detector, rounds, on_photo)?.into_iter();
    let mut best = rounds.next().unwrap_or_default();
    for (i, photo) in rounds.flat_map(|round| round.into_iter().enumerate()) {
        if all(&photo.ms) < all(&best[i].ms) {
            best[i] = photo;
        }
    }
    Ok(best)
}

fn row(detector: &EvaluatedDetector, poses: &'static str, photos: &[TimedPhoto]) -> ScoreRow {
    let stages = Stage::ALL.map(|stage| {
        let own: Vec<f64> = photos.iter().map(|photo| photo.ms[stage as usize]).collect();
        let ms = upper_median(&own).unwrap_or_default();
        StageTime { stage, ms }
    });
    ScoreRow {
        detector: detector.manifest.name.clone(),
        poses,
        photos: photos.len(),
        photos_per_second: 1e3 / stages.iter().map(|stage| stage.ms).sum::<f64>().max(1e-3),
        stages: stages.to_vec(),
    }
}

fn name(stage: Stage) -> &'static str {
    ["read", "tags", "pose", "colour", "resize", "network", "rest"][stage as usize]
}

const LEFT: f64 = 150.0;
const WIDTH: f64 = 460.0;
const ROW: f64 = 24.0;

/// Draws the chart: a bar for each row, its stages stacked.
pub fn draw(rows: &[ScoreRow]) -> String {
    let all = |row: &ScoreRow| row.stages.iter().map(|stage| stage.ms).sum::<f64>();
    let longest = rows.iter().map(all).fold(1e-3, f64::max);
    let long = |ms: f64| ms / longest * WIDTH;
    let mut marks = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let y = ROW * i as f64;
        let label = format!("{}, {}", row.detector, row.poses);
        marks.push(Mark::text([LEFT - 8.0, y + 15.0], 11.0, End, BLACK, label));
        let mut x = LEFT;
        for (n, stage) in row.stages.iter().enumerate() {
            let bar = Mark::rect([x, y + 4.0], [long(stage.ms), 15.0]).filled(colour(n));
            marks.push(bar.titled(format!("{}: {:.1} ms", name(stage.stage), stage.ms)));
            x += long(stage.ms);
        }
        let figures = format!("{:.0} ms, {:.1} photos/s", all(row), row.photos_per_second);
        marks.push(Mark::text([x + 6.0, y + 15.0], 11.0, Start, BLACK, figures));
    }
    let drawing = Drawing {
        area: [0.0, 0.0, LEFT + WIDTH + 150.0, ROW * rows.len() as f64 + 4.0],
        label: "Milliseconds a photo by stage".to_owned(),
        marks,
    };
    let entry = |(n, stage): (usize, Stage)| (colour(n), name(stage).to_owned());
    let photos = rows.first().map_or(0, |row| row.photos);
    let explained = Explained {
        legend: Stage::ALL.into_iter().enumerate().map(entry).collect(),
        notes: vec![format!(
            "Median of {photos} photos, one thread, nothing kept from before. Poses from tags, or given by the session."
        )],
    };
    let title = "Scoring: where the time goes";
    figure(title, &explained, 1, vec![("milliseconds a photo", drawing)]).svg()
}

/// Writes the rows as lines of text: milliseconds a photo by stage, and photos per second.
pub fn table(rows: &[ScoreRow]) -> String {
    let mut text = format!("{:<16} {:<6}", "detector", "poses");
    for stage in Stage::ALL {
        text += &format!(" {:>8}", name(stage));
    }
    text += "  photos/s\n";
    for row in rows {
        text += &format!("{:<16} {:<6}", row.detector, row.poses);
        for stage in &row.stages {
            text += &format!(" {:>8.1}", stage.ms);
        }
        text += &format!("  {:>8.1}\n", row.photos_per_second);
    }
    text + "milliseconds a photo, one thread, nothing kept from before\n"
}
