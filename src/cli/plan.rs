//! `scaleproof plan`: how many photos show a drop?

mod asked;
pub(super) mod sealed;

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::compare::inside;
use super::{CommandResult, progress};
use crate::cli::answer::told;
use asked::{Comparisons, comparisons};
use scaleproof_core::spelling::{count, digits};
use scaleproof_score as score;
use scaleproof_score::{PLAN_EXPERIMENTS, PLAN_SEED, Question, SequentialPlan, Spread, SpreadFrom, ViewsNeeded};

/// Say how many photos show a drop of the mean confidence, before they are taken.
///
/// A place is one spot and light in which the model stands, photographed all round; a view is a direction seen from one place. By simulated experiments, which are decided as
/// `compare` does.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A session with stored detections (`score --record`) that tells how confidences vary from view to view: of plain photos alone, or of two textures or more.
    session: Option<PathBuf>,
    /// The drop of the mean confidence that shall be shown, 0 to 1 [default: 0.2]
    #[arg(long)]
    drop: Option<f64>,
    /// How often such a drop shall be shown, 0.5 to 0.99.
    #[arg(long, default_value_t = 0.8)]
    power: f64,
    /// Detectors × textures besides the base that `compare` will decide together [default: those of SESSION, else 5x1]
    #[arg(long, value_name = "NxN", conflicts_with = "seal", value_parser = comparisons)]
    comparisons: Option<Comparisons>,
    /// The scene whose views are photographed at each place, as `capture` takes them [default: that of SESSION, else eight directions]
    #[arg(long, value_name = "TOML")]
    scene: Option<PathBuf>,
    /// With --scene: pitches of its bins that are photographed [default: the one nearest to 15°]
    #[arg(
        long,
        value_name = "DEG,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "scene"
    )]
    pitch_deg: Vec<f64>,
    /// With --scene: distances of its bins that are photographed [default: the middle one]
    #[arg(long, value_name = "MM,…", value_delimiter = ',', requires = "scene")]
    distance_mm: Vec<f64>,
    /// Plan a comparison that is looked at after every view and stops when it knows (`compare --sequential`).
    #[arg(long)]
    sequential: bool,
    /// With --sequential: it stops also when the drop is shown to be smaller than this. Between 0 and 1.
    #[arg(long, value_name = "DROP", requires = "sequential", allow_negative_numbers = true, value_parser = inside)]
    least: Option<f64>,
    #[command(flatten)]
    sealing: sealed::Sealing,
    /// Print the numbers as one JSON object.
    #[arg(long)]
    json: bool,
}

/// `plan --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct Planned {
    /// The drop of the mean confidence of one detector and texture, as requested, like `power`.
    drop: f64,
    power: f64,
    /// Detectors and textures (besides the base) that are decided together.
    detectors: usize,
    textures: usize,
    /// How the differences are assumed to scatter.
    spread: Spread,
    /// So many views show the drop, looked at once; a view is a direction seen from one place.
    views: usize,
    /// The share of the simulated experiments that show it with so many views.
    chance: f64,
    /// Its error by the number of experiments, 95 %.
    chance_error: f64,
    /// That share with one place less than so many views take; `null` where they take one place.
    chance_with_a_place_less: Option<f64>,
    experiments: usize,
    seed: u64,
    /// Views of one place.
    directions: usize,
    /// Whole places with these views, or with those of `sequential`.
    places: usize,
    /// One of each texture and of the base from every view of these places.
    photos: usize,
    /// For places like these nothing can be shown with fewer places.
    fewest_places_like_these: usize,
    /// With `--sequential`.
    #[serde(skip_serializing_if = "Option::is_none")]
    sequential: Option<SequentialPlan>,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    if let (Some(path), Some(scene)) = (&args.sealing.seal, &args.scene) {
        return sealed::seal(path, scene, &args, out);
    }
    let asked = args.asked()?;
    let (question, directions) = (asked.question, asked.directions);
    let ViewsNeeded {
        views,
        chance,
        chance_error,
    } = question.views_needed()?;
    let sequential = args.sequential.then(|| args.simulated(&question, directions));
    let sequential = sequential.transpose()?;
    let most = sequential.as_ref().map_or(views, |plan| plan.most_views);
    let places = most.div_ceil(directions);
    let less = views.div_ceil(directions) - 1;
    let planned = Planned {
        drop: question.drop,
        power: question.power,
        detectors: question.detectors,
        textures: question.textures,
        spread: question.spread,
        views,
        chance,
        chance_error,
        chance_with_a_place_less: (less > 0).then(|| question.chance(less * directions)),
        experiments: PLAN_EXPERIMENTS,
        seed: PLAN_SEED,
        directions,
        places,
        photos: places * directions * (1 + question.textures),
        fewest_places_like_these: question.fewest(),
        sequential,
    };
    let words = in_words(&planned, asked.views_seen);
    told(args.json, planned, words, out)
}

impl Args {
    fn simulated(&self, question: &Question, directions: usize) -> Result<SequentialPlan, score::PlanError> {
        progress::steps("simulating", score::SEQUENTIAL_ROWS)
            .during(|bar| score::sequential_plan(question, self.least, directions, || bar.inc(1)))
    }
}

/// The answer, what it promises, what it assumes, and of which places it is.
fn in_words(planned: &Planned, views_seen: usize) -> String {
    let textures = match planned.textures {
        1 => "one texture".to_owned(),
        n => format!("{n} textures"),
    };
    let (most, looks) = match &planned.sequential {
        Some(plan) => (plan.most_views, " at most, looked at after each"),
        None => (planned.views, ""),
    };
    let mut words = format!(
        "{}{looks}: e.g. {} × {}, {} with plain and {textures}.\n",
        count(most, "view"),
        count(planned.places, "place"),
        count(planned.directions, "direction"),
        count(planned.photos, "photo"),
    );
    let detector = match planned.detectors {
        1 => "the detector".to_owned(),
        n => format!("one of {n} detectors"),
    };
    let experiments = format!(
        "{PLAN_EXPERIMENTS} simulated experiments, seed {PLAN_SEED}: ±{}",
        digits(planned.chance_error, 2)
    );
    let chance = match &planned.sequential {
        Some(_) => format!(
            "{} ({experiments}); looked at once, {} do it",
            planned.power,
            count(planned.views, "view")
        ),
        None => {
            let less = planned.chance_with_a_place_less.map_or_else(String::new, |chance| {
                format!(
                    "; {} with one of {}",
                    count(planned.places - 1, "place"),
                    digits(chance, 2)
                )
            });
            format!("{} ({experiments}){less}", digits(planned.chance, 2))
        }
    };
    let _ = writeln!(
        words,
        "They show a drop of the mean confidence by {} of {detector} with a chance of {chance}.",
        planned.drop
    );
    let Spread {
        deviation,
        correlation,
        from,
    } = planned.spread;
    let from = match from {
        SpreadFrom::StoredPhotos => "as in the stored session and films; `plan SESSION` takes it from yours".to_owned(),
        SpreadFrom::PlainPhotos => format!(
            "as the plain confidence does in {}: the pattern is assumed to work no more unevenly; the correlation is that of the stored photos",
            count(views_seen, "view")
        ),
        SpreadFrom::PairedPhotos => format!("as they do in {}", count(views_seen, "view")),
    };
    let _ = writeln!(
        words,
        "Assumed: differences vary from view to view by {} (standard deviation), correlated by {} between detectors, {from}.",
        digits(deviation, 2),
        digits(correlation, 2)
    );
    let _ = write!(
        words,
        "A place is one spot and light in which the model stands, photographed all round; a view is a direction seen from one place. One place is enough to say what holds there; \
         for places like these it takes {} or more.",
        count(planned.fewest_places_like_these, "place")
    );
    if let Some(plan) = &planned.sequential {
        words += &table(plan);
    }
    words
}

/// Returns the outcomes of the sequential plan as a table, a row for each real drop.
fn table(plan: &SequentialPlan) -> String {
    let least = plan.least.map_or_else(String::new, |least| format!("below {least:<7}"));
    let mut words = format!("\n\nreal drop  drop shown  rise shown  {least}undecided  mean views");
    for row in &plan.table {
        let less = match plan.least {
            Some(_) => format!("{:<13.3}", row.less_than_least_shown),
            None => String::new(),
        };
        let _ = write!(
            words,
            "\n{:<11}{:<12.3}{:<12.3}{less}{:<11.3}{:.1}",
            digits(row.real_drop, 3),
            row.drop_shown,
            row.rise_shown,
            row.undecided,
            row.mean_views,
        );
    }
    words
}
