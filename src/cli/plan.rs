//! `scaleproof plan`: how many photos show a drop?

pub(super) mod sealed;

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::compare::inside;
use super::{CommandResult, Outcome, progress};
use crate::cli::answer::{answer, told};
use scaleproof_core::spelling::digits;
use scaleproof_core::statistics::FEWEST_CLUSTERS;
use scaleproof_core::{files, spelling};
use scaleproof_pose::scene::{NoSuchBin, Scene, Viewpoint};
use scaleproof_score::{report, score};

/// Say how many photos show a drop of the hit rate, before they are taken.
///
/// Exact for McNemar's test at 5 %, with one photo of each texture a place and bin, and independent hits; simulated for six places of a scene or
/// more, each of which `compare` takes as one cluster.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The drop of the hit rate that shall be shown, 0 to 1.
    #[arg(long, required_unless_present = "scene")]
    drop: Option<f64>,
    /// The scene whose views are photographed, as `capture` takes them: a table of places, photos and the smallest drop they show.
    #[arg(long, value_name = "TOML", conflicts_with = "bins")]
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
    #[command(flatten)]
    sealing: sealed::Sealing,
    /// With --scene: places that are planned.
    #[arg(long, default_value_t = 1, requires = "scene", value_parser = clap::value_parser!(u16).range(1..=200))]
    places: u16,
    /// Hit rate expected of the base texture.
    #[arg(long, default_value_t = 0.9)]
    base_rate: f64,
    /// How often such a drop shall be shown, 0.5 to 0.99.
    #[arg(long, default_value_t = 0.8)]
    power: f64,
    /// Show it in each of so many bins by itself (at the strictest level of Holm's correction).
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    bins: u16,
    /// Comparisons that `compare` corrects together: detectors × textures besides the base. Counted by itself with --seal.
    #[arg(long, value_name = "NUMBER", default_value_t = 1, conflicts_with_all = ["seal", "sequential"], value_parser = clap::value_parser!(u16).range(1..=1000))]
    comparisons: u16,
    /// Plan a comparison that is looked at after every pair and stops when it knows (`compare --sequential`): how many pairs it takes, by 5,000 simulated
    /// experiments for each real drop, beside the fixed plan.
    #[arg(long, conflicts_with = "bins")]
    sequential: bool,
    /// With --sequential: it stops also when the drop is shown to be smaller than this. Between 0 and 1.
    #[arg(long, value_name = "DROP", requires = "sequential", allow_negative_numbers = true, value_parser = inside)]
    least: Option<f64>,
    /// With --sequential: an SVG file for the chart of pairs against the real drop.
    #[arg(short, long, alias = "out", value_name = "SVG", requires = "sequential")]
    output: Option<PathBuf>,
    /// Print the numbers as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    if let (Some(scene), Some(path)) = (&args.scene, &args.sealing.seal) {
        return sealed::seal(path, scene, &args, out);
    }
    match &args.scene {
        Some(_) if args.sequential => {
            return Err("--sequential plans pairs, not places: leave --scene out, or seal the plan with --seal".into());
        }
        Some(scene) => return table(&args, scene, out),
        None => {}
    }
    // The option is required without a scene.
    let drop = args.drop.unwrap_or_default();
    if args.sequential {
        return sequential(&args, drop, out);
    }
    let bins = usize::from(args.bins);
    let level = 0.05 / bins as f64 / f64::from(args.comparisons);
    let pairs = score::pairs_needed(args.base_rate, drop, args.power, level)?;
    let plan = PairsNeeded {
        pairs: pairs * bins,
        pairs_per_bin: pairs,
        bins,
        photos: 2 * pairs * bins,
        base_rate: args.base_rate,
        drop,
        power: args.power,
        comparisons: args.comparisons,
    };
    let each = if bins > 1 {
        format!(" in each of {bins} bins, {} pairs in all", plan.pairs)
    } else {
        String::new()
    };
    let digits = decimals(args.base_rate).max(decimals(drop));
    let words = format!(
        "{pairs} pairs{each}: {} photos, one of each texture at each place and bin.\n\
         A drop of the hit rate from {:.digits$} to {:.digits$} is then shown (McNemar, p < 0.05{}) with a chance of at least {}. Repeats at the same place and \
         bin count as one.",
        plan.photos,
        args.base_rate,
        args.base_rate - drop,
        args.corrected(),
        args.power
    );
    told(args.json, plan, words, out)
}

/// `plan --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct PairsNeeded {
    /// Pairs of photos in all.
    pairs: usize,
    /// Pairs in each bin.
    pairs_per_bin: usize,
    /// As requested, like the last four.
    bins: usize,
    /// One of each texture at each place and bin.
    photos: usize,
    base_rate: f64,
    drop: f64,
    power: f64,
    /// For how many comparisons p is corrected.
    comparisons: u16,
}

/// `plan --scene --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct PlacesNeeded {
    /// Views of the scene that are photographed at each place: those that `capture` asks for.
    bins: usize,
    /// As requested, like the next four.
    base_rate: f64,
    power: f64,
    planned_places: usize,
    drop: Option<f64>,
    /// For how many comparisons p is corrected.
    comparisons: u16,
    /// For that drop.
    places_needed: Option<usize>,
    table: Vec<PlacesRow>,
}

/// What so many places show.
#[derive(Serialize, JsonSchema)]
struct PlacesRow {
    places: usize,
    /// Of each texture.
    photos_per_bin: usize,
    /// Pairs of photos in all; `photos` counts one of each texture at each place and bin.
    pairs: usize,
    photos: usize,
    /// The smallest drop that is shown with this power.
    smallest_drop: Option<f64>,
}

/// A plan that stops when it knows, beside the fixed one.
fn sequential(args: &Args, drop: f64, out: &mut dyn Write) -> CommandResult {
    let plan = progress::steps("simulating", score::SEQUENTIAL_ROWS)
        .during(|bar| score::sequential_plan((args.base_rate, drop), args.power, args.least, || bar.inc(1)))?;
    if let Some(path) = &args.output {
        files::write_atomically(path, report::plan_chart(&plan).as_bytes())?;
    }
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&plan)?)?;
        return Ok(Outcome::Done);
    }
    let (fixed, most) = (plan.fixed_pairs, plan.budget_pairs);
    writeln!(
        out,
        "fixed: {fixed} pairs, looked at once; sequential: {most} pairs at most, looked at after each. Either shows a drop of {drop} from {} with a chance of {}.\n",
        args.base_rate, args.power
    )?;
    let less = args.least.map_or_else(String::new, |least| format!("below {least:<7}"));
    writeln!(
        out,
        "real drop  drop shown  rise shown  {less}undecided  mean pairs  pairs saved"
    )?;
    for row in &plan.table {
        let less = args
            .least
            .map(|_| format!("{:<13.3}", row.less_than_least_shown))
            .unwrap_or_default();
        writeln!(
            out,
            "{:<11}{:<12.3}{:<12.3}{less}{:<11.3}{:<12.1}{} %",
            digits(row.real_drop, 3),
            row.drop_shown,
            row.rise_shown,
            row.undecided,
            row.mean_pairs,
            digits(100.0 * row.saved, 0)
        )?;
    }
    writeln!(
        out,
        "\n{} simulated experiments a row; independent hits, one photo of each texture at each place and bin.",
        plan.experiments
    )?;
    if let Some(path) = &args.output {
        writeln!(out, "chart: {}", path.display())?;
    }
    Ok(Outcome::Done)
}

/// Places, photos and the smallest drop they show, for the bins of a scene.
fn table(args: &Args, scene: &Path, out: &mut dyn Write) -> CommandResult {
    let scene = Scene::open(scene)?;
    let bins = args.views(&scene)?.len();
    let tests = usize::from(args.comparisons);
    let places = match args.drop {
        Some(drop) => Some(score::places_needed_among(
            tests,
            bins,
            [args.base_rate, drop],
            args.power,
        )?),
        // What is wrong with the other numbers is found out in any case.
        None => score::pairs_needed(args.base_rate, args.base_rate, args.power, 0.05).map(|_| None)?,
    };
    let planned = usize::from(args.places);
    let mut rows: Vec<usize> = PLACES.into_iter().chain([planned]).chain(places).collect();
    rows.sort_unstable();
    rows.dedup();
    rows.retain(|row| *row <= 2 * planned.max(places.unwrap_or(planned)).max(3));
    let drop = |places: usize| score::smallest_drop_among(tests, places, bins, [args.base_rate, args.power]);
    if args.json {
        let row = |places: usize| PlacesRow {
            places,
            photos_per_bin: places,
            pairs: places * bins,
            photos: 2 * places * bins,
            smallest_drop: drop(places),
        };
        let plan = PlacesNeeded {
            bins,
            base_rate: args.base_rate,
            power: args.power,
            planned_places: planned,
            drop: args.drop,
            comparisons: args.comparisons,
            places_needed: places,
            table: rows.into_iter().map(row).collect(),
        };
        answer(&plan, out)?;
        return Ok(Outcome::Done);
    }
    writeln!(
        out,
        "{:<8}{:<26}{:<8}{:<8}smallest drop shown",
        "places", "photos a bin and texture", "pairs", "photos"
    )?;
    for places in rows {
        let drop = drop(places).map_or("none".to_owned(), |drop| format!("{drop:.2}"));
        let mark = if places == planned { "  ← planned" } else { "" };
        writeln!(
            out,
            "{places:<8}{places:<26}{:<8}{:<8}{drop}{mark}",
            places * bins,
            2 * places * bins
        )?;
    }
    if let (Some(drop), Some(places)) = (args.drop, places) {
        let places_in_words = spelling::count(places, "place");
        writeln!(
            out,
            "A drop of {drop} needs {places_in_words}: {} pairs.",
            places * bins
        )?;
    }
    let at_fewer = args.drop.zip(places).and_then(|(asked, places)| {
        let shows = |fewer: &usize| *fewer < places && drop(*fewer).is_some_and(|shown| shown <= asked);
        (1..FEWEST_CLUSTERS).find(shows)
    });
    if let Some(fewer) = at_fewer {
        writeln!(
            out,
            "{} show it too, but for themselves alone: below {FEWEST_CLUSTERS} places the pairs count one by one, from {FEWEST_CLUSTERS} on the places.",
            spelling::count(fewer, "place")
        )?;
    }
    writeln!(
        out,
        "{bins} views of {} in the scene's bins, as `capture` takes them (--pitch-deg and --distance-mm take others); one photo of each texture at each place and view; hit rate of the base {}, shown with a chance of {} (McNemar, p < 0.05{}, all views \
         together).\nPhotos of one place are alike, and from six places on `compare` takes each as one cluster, as is counted here: rather more places than \
         more views.",
        scene.bins.count(),
        args.base_rate,
        args.power,
        args.corrected()
    )?;
    Ok(Outcome::Done)
}

impl Args {
    /// For how many comparisons p is corrected.
    fn corrected(&self) -> String {
        match self.comparisons {
            1 => " for one detector and one texture; --comparisons counts more".to_owned(),
            n => format!(" after correction for {n} comparisons"),
        }
    }

    fn views(&self, scene: &Scene) -> Result<Vec<Viewpoint>, NoSuchBin> {
        scene.bins.photographed(&self.pitch_deg, &self.distance_mm)
    }
}

/// Rows that are there whatever is planned.
const PLACES: [usize; 7] = [1, 2, 3, 5, 10, 20, 50];

fn decimals(number: f64) -> usize {
    number.to_string().split_once('.').map_or(0, |(_, digits)| digits.len())
}
