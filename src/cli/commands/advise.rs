//! `scaleproof advise`: how little does a session need?

use std::collections::BTreeSet;
use std::io::Write;

use crate::cli::args::advise::Args;
use crate::cli::score as score_command;
use crate::cli::sessions::among_photos;
use crate::cli::{CommandResult, Outcome, Result, progress, sessions};
use scaleproof_core::files;
use scaleproof_score::{EvaluatedDetector, Scores};
use scaleproof_session::Session;
use scaleproof_session::envelope::EnvelopeShape;
use scaleproof_study::advise::{self, Advice, FigureAdvice, Sample};

pub fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let session = sessions::session(&args.session)?;
    check(args, &session)?;
    files::check_writable(&args.output)?;
    let bar = progress::photos("reading", session.photos.len());
    let (samples, unreadable) = Sample::all_of(&session, || bar.inc(1));
    bar.finish_and_clear();
    unreadable.iter().for_each(|e| say!("note: left out: {e}"));
    let camera = session.known_camera()?;
    let poses = progress::photos("measuring", samples.len())
        .during(|bar| advise::advise_poses(&samples, &session.scene, camera, || bar.inc(1)))?;
    let figures = figures(args, &session)?;
    let advice = Advice {
        session: session.name.clone(),
        unreadable: unreadable.len(),
        poses,
        figures,
    };
    let json = serde_json::to_string_pretty(&advice)? + "\n";
    let page = args.output.join("advice.html");
    let settings = args.output.join("advice.toml");
    files::replace_all_atomically(
        &args.output,
        &[
            (page.clone(), advise::page(&advice).into_bytes()),
            (args.output.join("advice.json"), json.clone().into_bytes()),
            (settings.clone(), advise::settings(&advice).into_bytes()),
        ],
    )?;
    if args.json {
        write!(out, "{json}")?
    } else {
        let (table, page, settings) = (advise::table(&advice), page.display(), settings.display());
        writeln!(out, "{table}\n\npage: {page}\nsettings: {settings}")?
    }
    Ok(Outcome::Done)
}

/// Finds out before anything is measured what cannot work.
fn check(args: &Args, session: &Session) -> Result<()> {
    if files::is_same(&args.output, &session.folder) {
        return Err(among_photos("advice", &args.output).into());
    }
    session.known_camera()?;
    if !looks(args) {
        return Ok(());
    }
    let variants: BTreeSet<&str> = session.photos.iter().map(|photo| photo.variant.as_str()).collect();
    if !variants.contains(args.base.as_str()) || variants.len() < 2 {
        let all = variants.into_iter().collect::<Vec<_>>().join(", ");
        return Err(format!(
            "findings need photos of `{}` and of another texture, and the session has {all}: name the base with --base, or leave the detectors out",
            args.base
        )
        .into());
    }
    Ok(())
}

/// Returns true if detectors or stored detections are given.
fn looks(args: &Args) -> bool {
    let given = &args.detectors;
    !given.names.is_empty() || given.recorded || given.results.are_given()
}

/// Compares the findings by every definition of AP, and by the box instead of the model's outline; `None` without detections.
fn figures(args: &Args, session: &Session) -> Result<Option<FigureAdvice>> {
    if !looks(args) {
        return Ok(None);
    }
    let detectors = args.detectors.evaluated(std::slice::from_ref(session))?;
    let options = args.effort.options(&detectors)?;
    let scored = |session: Session, detectors: Vec<EvaluatedDetector>| -> Result<Scores> {
        let scores = score_command::score_with_progress(vec![session], detectors, &options)?;
        Ok(scores.against(&args.base))
    };
    let scores = scored(session.clone(), detectors.clone())?;
    score_command::caution(&scores);
    let by_box = match session.scene.model.envelope.name() {
        "box" => None,
        _ => {
            let mut boxed = session.clone();
            boxed.outline = EnvelopeShape::of_box(&session.scene.model);
            Some(scored(boxed, detectors)?)
        }
    };
    Ok(Some(advise::advise_figures(&scores, by_box.as_ref(), &args.base)?))
}
