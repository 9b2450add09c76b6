//! `scaleproof attack chart`: renderer models against each other.

use std::io::Write;
use std::path::PathBuf;

use serde::Serialize;

use super::render::hex;
use super::{CommandResult, Outcome, progress};
use crate::files;
use crate::frames::views;
use crate::frames::{FrameSet, LIST};
use crate::surrogate::chart::{Row, draw, draw_training, measure, table};
use crate::surrogate::renderer::Learned;

/// Every renderer model on frames: error in flat colours it has not seen, and with patterns, against milliseconds
#[derive(clap::Args)]
pub struct ChartArgs {
    /// A folder of frames
    #[arg(value_name = "FRAMES")]
    frames: PathBuf,
    /// The colours models are fitted to, as hex: the first two, the first three, …
    #[arg(long, value_name = "HEX", num_args = 2..=8, default_values = ["000000", "ffffff", "808080"])]
    reference: Vec<String>,
    /// Trained networks to put beside them (attack train-dtn)
    #[cfg(feature = "attack")]
    #[arg(long, value_name = "FILE", num_args = 1..)]
    network: Vec<PathBuf>,
    #[cfg(feature = "attack")]
    #[command(flatten)]
    on: super::device::OnDevice,
    /// Folder for the charts (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// Print renderers.json instead of the table
    #[arg(long)]
    json: bool,
}

/// The numbers, with what they were measured on.
#[derive(Serialize)]
struct Numbers<'a> {
    scaleproof: &'static str,
    frames_sha256: String,
    made_by: &'a str,
    references: &'a [String],
    rows: &'a [Row],
}

pub fn run(args: &ChartArgs, out: &mut dyn Write) -> CommandResult {
    let set = FrameSet::open(&args.frames)?;
    let references = args
        .reference
        .iter()
        .map(|text| hex(text))
        .collect::<Result<Vec<_>, _>>()?;
    let bar = progress::frames("measuring", views(&set.list.frames).len());
    let networks = networks(args)?;
    let networks: Vec<&dyn Learned> = networks.iter().map(AsRef::as_ref).collect();
    let rows = measure(&set, &references, &networks, || bar.inc(1))?;
    bar.finish_and_clear();
    let numbers = Numbers {
        scaleproof: env!("CARGO_PKG_VERSION"),
        frames_sha256: files::sha256_hex(&files::read(&args.frames.join(LIST))?),
        made_by: &set.list.made_by,
        references: &args.reference,
        rows: &rows,
    };
    let json = serde_json::to_string_pretty(&numbers)?;
    let mut new = vec![
        (args.output.join("renderers.json"), json.clone().into_bytes()),
        (args.output.join("renderers.svg"), draw(&rows).into_bytes()),
    ];
    new.extend(draw_training(&rows).map(|svg| (args.output.join("training.svg"), svg.into_bytes())));
    files::replace_all_atomically(&new)?;
    if args.json {
        writeln!(out, "{json}")?;
        return Ok(Outcome::Done);
    }
    write!(out, "{}", table(&rows))?;
    for (path, _) in &new {
        writeln!(out, "{}", path.display())?;
    }
    Ok(Outcome::Done)
}

#[cfg(feature = "attack")]
fn networks(args: &ChartArgs) -> Result<Vec<Box<dyn Learned>>, Box<dyn std::error::Error>> {
    use crate::surrogate::dtn::file;
    let device = args.on.device.open()?;
    let open = |path: &PathBuf| {
        let network = file::load(path)?.network(device.clone())?;
        Ok(Box::new(network) as Box<dyn Learned>)
    };
    args.network.iter().map(open).collect()
}

#[cfg(not(feature = "attack"))]
fn networks(_: &ChartArgs) -> Result<Vec<Box<dyn Learned>>, std::convert::Infallible> {
    Ok(Vec::new())
}
