//! `scaleproof demo`: the whole way on the stored session, from pattern to report: the plain model, a random pattern, and one made against other detectors.

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::answer::answer;
use super::{CommandResult, Outcome, Result, advice, detectors, locate, print, score};
use scaleproof_core::files;
use scaleproof_detect::{Manifest, Runtime, WeightFolders};
use scaleproof_print::media::Media;
use scaleproof_print::paper::{Orientation, Paper};
use scaleproof_print::template::{Front, LayoutRequest, TemplateRequest};
use scaleproof_score::report;
use scaleproof_score::{EvaluatedDetector, Options, Scores};
use scaleproof_session::Session;
use scaleproof_surface::pattern::Pattern;

/// Print a template, locate the stored photos, and score them with every detector at hand.
///
/// Missing weights are fetched; without a network the detections recorded with the session are scored instead, beside the project's own small
/// detector, which runs.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Folder for the template, the poses and the report
    #[arg(short, long, alias = "out", value_name = "DIR", default_value = "out/demo")]
    output: PathBuf,
    #[command(flatten)]
    folder: detectors::Folder,
    #[command(flatten)]
    telling: score::Telling,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let steps: &mut dyn Write = if args.telling.json { &mut std::io::sink() } else { out };
    let (made, scores) = make(&args, steps)?;
    if args.telling.json {
        score::caution(&scores);
        answer(&made, out)?;
        return Ok(Outcome::Done);
    }
    writeln!(out, "\n{}", report::summary_table(&scores))?;
    if args.telling.all {
        writeln!(out, "\n{}", report::further_tables(&scores))?;
    }
    writeln!(out, "template: {}", made.template.display())?;
    score::conclude(&scores, &made.report, &args.telling, out)
}

/// `demo --json`: the paths of what the demo made.
#[derive(Serialize, JsonSchema)]
pub(super) struct Answer {
    /// The pattern's image.
    pattern: PathBuf,
    /// The print template.
    template: PathBuf,
    /// The page of the report.
    report: PathBuf,
    /// The `summary.json` of the stored session.
    summary: PathBuf,
}

/// The three steps; what each found is written in one line, and in full where all is asked for.
fn make(args: &Args, out: &mut dyn Write) -> Result<(Answer, Scores)> {
    let session = Session::open(&home().join("captures/skyline"))?;
    let pattern = Pattern::random(16, 1)?;
    let png = args.output.join("random16.png");
    files::replace_atomically(&args.output, &png, &pattern.to_png()?)?;
    let pdf = args.output.join("template.pdf");
    // The published tile size, 16 cells over 118 mm at 1:10.
    let printed = print_template(&pattern, "random16.png", 118.0, &pdf)?;
    let located = if args.telling.all {
        writeln!(out, "{printed}\n")?;
        locate::count_located(&session, Some(out))?
    } else {
        locate::count_located(&session, None)?
    };
    writeln!(
        out,
        "{located} of {} renders of a 1:10 car are located by their tags: plain (normal), in random colours (random), in a pattern made against two other detectors (two_targets)",
        session.photos.len()
    )?;
    let detectors = detectors(&session, &args.folder.folders()?, out)?;
    let speeds = score::speeds(&session.folder.join("recorded/speed.json"), &detectors)?;
    let scores = score::score_with_progress(vec![session], detectors, &Options::default())?;
    let report = report::write(&args.output, &scores, Some(&speeds))?;
    let summary = args.output.join("summary.json");
    let (pattern, template) = (png, pdf);
    Ok((
        Answer {
            pattern,
            template,
            report,
            summary,
        },
        scores,
    ))
}

/// For a panel as large as the model's side.
pub(super) fn print_template(pattern: &Pattern, name: &str, tile_mm: f64, pdf: &Path) -> Result<String> {
    let layout = LayoutRequest {
        size_mm: (600.0, 300.0),
        media: Media::new(Paper::A4),
        orientation: Orientation::Auto,
        overlap_mm: 8.0,
        bleed_mm: 2.0,
    };
    let request = TemplateRequest {
        tile_mm,
        scale: 10.0,
        pattern_name: name.into(),
        front: Front::Left,
        layout,
    };
    let made = print::write_template(pattern, &request, pdf)?;
    Ok(print::summary(pdf, &made))
}

/// The folder with the stored photos: named by `./run`, else where a packaged program lies, else where it was compiled.
pub(super) fn home() -> PathBuf {
    let named = files::environment::variable("SCALEPROOF_HOME").map(PathBuf::from);
    let packaged = || files::beside_the_program("captures")?.parent().map(Path::to_owned);
    named
        .or_else(packaged)
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")))
}

/// The detector of this project, which lies beside the stored photos: for trying things, no evidence.
pub(super) fn own_detector() -> PathBuf {
    home().join("detectors/scaleproof_car.toml")
}

/// Every detector: live where its weights are here or can be fetched, else from the session's recordings, and then the project's own runs beside them.
fn detectors(session: &Session, folders: &WeightFolders, out: &mut dyn Write) -> Result<Vec<EvaluatedDetector>> {
    let class = &session.scene.model.class;
    let mut why_not = Runtime::load().err().map(|e| advice::sentence(&e));
    let mut detectors = Vec::new();
    let mut played_back = Vec::new();
    for manifest in Manifest::all()? {
        // After one failure the others would fail the same way, a timeout each.
        if why_not.is_none() {
            why_not = detectors::fetch_one(&manifest, folders)
                .err()
                .map(|e| advice::sentence(e.as_ref()));
        }
        let live = Runtime::load()
            .is_ok()
            .then(|| EvaluatedDetector::live(manifest.clone(), folders, class));
        detectors.push(match live {
            Some(Ok(detector)) => detector,
            _ => {
                played_back.push(manifest.name.clone());
                EvaluatedDetector::recorded(manifest, &[&session.folder], class)?
            }
        });
    }
    if !played_back.is_empty() {
        let (names, why) = (
            played_back.join(", "),
            why_not.unwrap_or_else(|| "their weights are not here".into()),
        );
        writeln!(out, "detections RECORDED, not found by running: {names}\nbecause {why}")?;
        if Runtime::load().is_ok() {
            let mut own = EvaluatedDetector::live(Manifest::open(&own_detector())?, folders, class)?;
            own.is_tested = false;
            writeln!(
                out,
                "running: {}, the project's own, a toy: nothing is decided by it",
                own.manifest.name
            )?;
            detectors.push(own);
        }
    }
    Ok(detectors)
}
