//! `scaleproof attack evaluate`: patterns re-rendered on the model and scored.

use std::io::Write;

use crate::cli::answer::told;
use crate::cli::args::attack::evaluate::EvaluateArgs;
use crate::cli::commands::attack::render::cache;
use crate::cli::print::attack::evaluate::Evaluated;
use crate::cli::resolve::attack::render::mesh_file;
use crate::cli::score::caution;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_attack::evaluate::RenderedSet;
use scaleproof_core::files;
use scaleproof_frames::render::blender;
use scaleproof_score::report;
use scaleproof_score::{ApDefinition, BASE_VARIANT, Comparison, Scores, compare_with, decide};

pub fn run(args: &EvaluateArgs, out: &mut dyn Write) -> CommandResult {
    let model = args.model.load()?;
    let mesh = mesh_file(&model)?;
    let scale = model.scale;
    let class = args.class()?;
    let (variants, paints, worn) = args.paints(&model)?;
    let evaluation = RenderedSet::new(args.request(model, paints)?, variants.clone())?;
    // Faults of the detectors and of the output are reported before the long rendering.
    let detectors = args.detectors(&class)?;
    files::check_writable(&args.output)?;
    let [folder, report] = ["session", "score"].map(|name| args.output.join(name));
    files::chosen::check_folder(&args.output, &folder)?;
    files::chosen::check_folder(&args.output, &report)?;
    let python = || blender::find(&cache(), progress::announce);
    progress::frames("rendering", evaluation.photos().len())
        .during(|bar| evaluation.render(&folder, python, |done| bar.set_position(done as u64)))?;
    // The scene and the list of photos.
    let name = mesh.file_stem().unwrap_or_default().to_string_lossy();
    evaluation.write_session(&folder, (&name, &class, scale))?;
    let mut scores = args.scores(&folder, detectors)?;
    scores.patterns = worn;
    let tables = report::Evaluation {
        comparisons: comparisons(&scores, &variants)?,
        scores: &scores,
        patterns: variants,
        targets: args.target.clone(),
    };
    report::write(&report, &scores, None)?;
    let page = report::write_evaluation(&args.output, &tables)?;
    caution(&scores);
    let evaluated = Evaluated {
        classes: &class,
        box_labels: report::box_labels(tables.scores),
        patterns: &tables.patterns,
        targets: &tables.targets,
        results: &scores.summaries,
        comparisons: &tables.comparisons,
        page: &page,
    };
    let words = format!("{}\npage: {}", report::evaluation_tables(&tables), page.display());
    told(args.json, &evaluated, words, out)
}

/// Each variant against those after it.
pub fn comparisons(scores: &Scores, variants: &[String]) -> Result<Vec<Comparison>> {
    let names: Vec<&str> = variants.iter().map(String::as_str).collect();
    let compared = (1..names.len()).map(|i| compare_with(scores, names[i - 1], &names[i..], ApDefinition::Coco101));
    let mut compared: Vec<Comparison> = compared.collect::<Result<_, _>>()?;
    // Against the plain model; pattern against pattern has intervals alone.
    if let Some(from_plain) = compared.iter_mut().find(|comparison| comparison.base == BASE_VARIANT) {
        decide(from_plain);
    }
    Ok(compared)
}
