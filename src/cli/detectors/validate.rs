//! `scaleproof detectors validate`: does a detector reach the figure that its origin states?

use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::{Folder, present};
use crate::cli::{CommandResult, Outcome, progress};
use scaleproof_core::spelling::{self, count};
use scaleproof_detect::Manifest;
use scaleproof_score::{Averages, LEAST_GAIN, LabelledPhotos, Trials, labelled_photos, trials};

/// Score labelled photos and put the AP beside the published one; where they differ, say what explains it.
///
/// When the AP is not within 0.01 of the published one, or none is stated, the network is run again on some of the photos with one thing changed each
/// time: channel order, normalisation, resize, kernel, labels shifted by one. Use a set that the figure is of, such as COCO's val2017.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The detector.
    name: String,
    /// COCO annotations of all objects in the photos.
    #[arg(long, value_name = "JSON")]
    coco: PathBuf,
    /// Folder of the photos.
    #[arg(long, value_name = "DIR")]
    photos: PathBuf,
    /// The published AP@[.5:.95], 0 to 1; otherwise the manifest's `published_ap`.
    #[arg(long, value_name = "AP")]
    published: Option<f64>,
    /// So many photos for the trials, spread over the set.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    trial_photos: u32,
    #[command(flatten)]
    folder: Folder,
    /// One JSON object instead of the text.
    #[arg(long)]
    json: bool,
}

/// As close to the published figure as other kernels, roundings and versions leave it.
const CLOSE: f64 = 0.01;

/// `detectors validate --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Validated {
    detector: String,
    photos: usize,
    /// Boxes that count.
    boxes: usize,
    /// Different labels among them.
    labels: usize,
    /// Categories whose names are no label of the detector.
    left_out: Vec<String>,
    /// Over all photos and labels.
    averages: Averages,
    /// Of `--published`, else of the manifest.
    published_ap: Option<f64>,
    /// `null` when the AP is within 0.01 of the published one.
    trials: Option<Trials>,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    if let Some(published) = args.published.filter(|ap| !(0.0..=1.0).contains(ap)) {
        return Err(format!("--published is {published}: give an AP from 0 to 1, such as 0.258").into());
    }
    let folders = args.folder.folders()?;
    let manifest = present(std::slice::from_ref(&args.name), &folders)?;
    let manifest = manifest.into_iter().next().ok_or("there is no such detector")?;
    let weights = folders.checked(&manifest)?;
    let set = labelled_photos(&args.coco, &args.photos, &manifest)?;
    let manifest = manifest.when_validated();
    if !set.unknown.is_empty() {
        let names = set.unknown.join(", ");
        say!(
            "note: {} has no label for these categories, which are left out: {names}",
            manifest.name
        );
    }
    let of = |set: &LabelledPhotos, manifest: &Manifest, what: &str| {
        progress::photos(what, set.photos.len()).during(|bar| set.detect(manifest, &weights, || bar.inc(1)))
    };
    let found = of(&set, &manifest, &manifest.name)?;
    let averages = set.averages(&found, 0).ok_or("the photos have no object that counts")?;
    let published_ap = args.published.or(manifest.published_ap);
    let is_as_published =
        set.unknown.is_empty() && published_ap.is_some_and(|ap| (averages.ap_50_95 - ap).abs() <= CLOSE);
    let [boxes, labels] = set.counts();
    let nothing = "the photos of the trial have no object that counts: give more by --trial-photos";
    let trials = if is_as_published {
        None
    } else {
        Some(trials(&manifest, &set.sample(args.trial_photos as usize), &of)?.ok_or(nothing)?)
    };
    let validated = Validated {
        detector: manifest.name.clone(),
        photos: set.photos.len(),
        boxes,
        labels,
        left_out: set.unknown,
        averages,
        published_ap,
        trials,
    };
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&validated)?)?
    } else {
        write!(out, "{}", text(&validated))?
    }
    Ok(Outcome::Done)
}

fn text(validated: &Validated) -> String {
    let (v, averages) = (validated, &validated.averages);
    let mut lines = vec![
        format!(
            "{}: {}, {}, different labels: {}",
            v.detector,
            count(v.photos, "photo"),
            spelling::choose(v.boxes, "1 box", &format!("{} boxes", v.boxes)),
            v.labels
        ),
        format!("AP@[.5:.95] {:.3}, AP@0.5 {:.3}", averages.ap_50_95, averages.ap_50),
    ];
    if let Some(published) = validated.published_ap {
        let difference = averages.ap_50_95 - published;
        let left_out = validated.left_out.len();
        let found = if left_out > 0 {
            format!("{difference:+.3}, over other labels: {left_out} left out")
        } else if difference.abs() <= CLOSE {
            format!("the same within {CLOSE}")
        } else {
            format!("{difference:+.3}")
        };
        lines.push(format!("published {published:.3}: {found}"));
    }
    if let Some(trials) = &validated.trials {
        let head = format!("on {} of the photos", trials.photos);
        lines.push(format!("\n{head:<34} AP@[.5:.95]  gain at least"));
        let row = |what: &str, averages: &Averages| format!("  {what:<32} {:<12.3}", averages.ap_50_95);
        let base = row("as the manifest says", &trials.as_the_manifest_says);
        lines.push(base.trim_end().to_owned());
        let least = |gain: Option<f64>| gain.map_or("not known".to_owned(), |gain| format!("{gain:+.3}"));
        let changed = trials.changed.iter();
        lines.extend(
            changed.map(|trial| format!("{} {}", row(&trial.change, &trial.averages), least(trial.least_gain))),
        );
        let none = format!("none of these changes gains {LEAST_GAIN} beyond chance");
        lines.push(match &trials.explained_by {
            Some(change) => format!("explained by: {change}"),
            None if validated.published_ap.is_none() => none,
            None => format!("{none}: something else differs, or the photos are too few"),
        });
    }
    lines.join("\n") + "\n"
}
