//! `scaleproof chart`: methods against each other, on the same photos.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use serde::Serialize;

use super::{CommandResult, Outcome, progress};
use crate::chart::locate::Sample;
use crate::chart::{locate, stability, true_views};
use crate::files;
use crate::photo::Photo;
use crate::session::Session;
use crate::tags::TagDetectorChoice;

/// Chart methods against each other, on the same photos
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Every tag detector, solver and camera model: error against milliseconds against share answered
    Locate(LocateArgs),
    /// Drive every method from harmless to hopeless: error, share answered, share silently wrong
    Stability(StabilityArgs),
}

#[derive(clap::Args)]
struct LocateArgs {
    #[command(flatten)]
    on: On,
    /// Enlarge the photos by this factor first, as if a camera of more pixels had taken them
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    enlarge: f64,
}

#[derive(clap::Args)]
struct StabilityArgs {
    #[command(flatten)]
    on: On,
    /// Simulated views at each amount of each condition
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    views: u32,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The photos and the truth about them.
#[derive(clap::Args)]
struct On {
    /// A session folder
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// Where the camera truly stood: JSON with azimuth, pitch and distance per photo
    #[arg(long, value_name = "JSON")]
    truth: PathBuf,
    /// Folder for the charts (SVG) and their numbers (JSON)
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
}

/// Runs `scaleproof chart …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Locate(args) => chart_locate(&args, out),
        What::Stability(args) => chart_stability(&args, out),
    }
}

/// The numbers of a chart, with what they were measured with.
#[derive(Serialize)]
struct Numbers<'a, R> {
    scaleproof: &'static str,
    session: &'a str,
    /// File name and SHA-256.
    inputs: &'a [(String, String)],
    tag_detectors: Vec<String>,
    rows: &'a [R],
}

fn chart_locate(args: &LocateArgs, out: &mut dyn Write) -> CommandResult {
    if !(0.1..=10.0).contains(&args.enlarge) {
        return Err(format!("photos cannot be enlarged {} times: give 0.1 to 10", args.enlarge).into());
    }
    let (session, samples) = load(&args.on)?;
    let samples = enlarged(samples, args.enlarge);
    let camera = match samples.first() {
        Some(first) => session.camera.scaled_to(first.grey.width(), first.grey.height())?,
        None => session.camera.clone(),
    };
    let bar = progress::photos("measuring", samples.len() * locate::detectors(&session.scene).len());
    let rows = locate::measure(&samples, &session.scene, &camera, || bar.inc(1))?;
    bar.finish_and_clear();
    writeln!(out, "{}", locate::table(&rows))?;
    let numbers = json(&session, &args.on, &rows)?;
    write(&args.on.out, "locate", &[("", locate::draw(&rows))], numbers, out)
}

fn chart_stability(args: &StabilityArgs, out: &mut dyn Write) -> CommandResult {
    let (session, samples) = load(&args.on)?;
    let bar = progress::photos(
        "sweeping",
        stability::photo_steps(samples.len()) + stability::view_steps(),
    );
    let detectors = stability::detectors(&session.scene);
    let (scene, camera) = (&session.scene, &session.camera);
    let photos = stability::on_photos(&samples, scene, camera, &detectors, args.seed, || bar.inc(1))?;
    let views = stability::on_views(scene, camera, args.views as usize, args.seed, || bar.inc(1));
    bar.finish_and_clear();
    let charts = [
        ("-photos", stability::draw("Spoiled photos", &photos)),
        ("-views", stability::draw("Simulated views", &views)),
    ];
    let steps: Vec<_> = photos.into_iter().chain(views).collect();
    writeln!(out, "{}", stability::summary(&steps))?;
    let numbers = json(&session, &args.on, &steps)?;
    write(&args.on.out, "stability", &charts, numbers, out)
}

/// The session and its photos, decoded, with the truth about each.
fn load(on: &On) -> Result<(Session, Vec<Sample>), Box<dyn Error>> {
    let session = Session::open(&on.session)?;
    let names: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let truths = true_views(&on.truth, &names)?;
    let samples = session.photos.iter().zip(truths).map(|(entry, truth)| {
        let grey = Photo::open(&session.photo_path(entry))?.grey();
        Ok(Sample { grey, truth })
    });
    let samples = samples.collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    Ok((session, samples))
}

fn enlarged(samples: Vec<Sample>, factor: f64) -> Vec<Sample> {
    if factor == 1.0 {
        return samples;
    }
    let side = |pixels: u32| (f64::from(pixels) * factor).round() as u32;
    samples
        .into_iter()
        .map(|sample| Sample {
            grey: image::imageops::resize(
                &sample.grey,
                side(sample.grey.width()),
                side(sample.grey.height()),
                image::imageops::FilterType::CatmullRom,
            ),
            ..sample
        })
        .collect()
}

fn json<R: Serialize>(session: &Session, on: &On, rows: &[R]) -> Result<String, Box<dyn Error>> {
    let mut inputs = session.hashes.clone();
    let name = on.truth.file_name().unwrap_or_default().to_string_lossy().into_owned();
    inputs.push((name, files::sha256_hex(&files::read(&on.truth)?)));
    Ok(serde_json::to_string_pretty(&Numbers {
        scaleproof: env!("CARGO_PKG_VERSION"),
        session: &session.name,
        inputs: &inputs,
        tag_detectors: TagDetectorChoice::ALL
            .iter()
            .map(|choice| choice.provenance())
            .collect(),
        rows,
    })?)
}

/// Writes `NAME.json` and `NAME….svg` into a folder.
fn write(folder: &Path, name: &str, charts: &[(&str, String)], json: String, out: &mut dyn Write) -> CommandResult {
    let mut new = vec![(folder.join(format!("{name}.json")), json.into_bytes())];
    for (suffix, svg) in charts {
        new.push((folder.join(format!("{name}{suffix}.svg")), svg.clone().into_bytes()));
    }
    files::write_all_atomically(&new)?;
    for (path, _) in &new {
        writeln!(out, "{}", path.display())?;
    }
    Ok(Outcome::Done)
}
