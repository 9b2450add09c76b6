//! `scaleproof plan`: how many photos show a drop?

use std::io::Write;

use super::{CommandResult, Outcome};
use crate::score;

/// Say how many photos show a drop of the hit rate, before they are taken.
///
/// Exact for McNemar's test at 5 %, with one photo of each texture a place and bin, and hits independent within a pair.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The drop of the hit rate that shall be shown, 0 to 1.
    #[arg(long)]
    drop: f64,
    /// Hit rate expected of the base texture.
    #[arg(long, default_value_t = 0.9)]
    base_rate: f64,
    /// How often such a drop shall be shown, 0.5 to 0.99.
    #[arg(long, default_value_t = 0.8)]
    power: f64,
    /// Show it in each of so many bins by itself (at the strictest level of Holm's correction).
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    bins: u16,
    /// Print the numbers as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let bins = usize::from(args.bins);
    let pairs = score::pairs_needed(args.base_rate, args.drop, args.power, 0.05 / bins as f64)?;
    if args.json {
        let plan = serde_json::json!({
            "pairs": pairs * bins, "pairs_per_bin": pairs, "bins": bins, "photos": 2 * pairs * bins, "base_rate": args.base_rate,
            "drop": args.drop, "power": args.power,
        });
        writeln!(out, "{plan}")?;
        return Ok(Outcome::Done);
    }
    let each = if bins > 1 {
        format!(" in each of {bins} bins, {} pairs in all", pairs * bins)
    } else {
        String::new()
    };
    let digits = decimals(args.base_rate).max(decimals(args.drop));
    writeln!(
        out,
        "{pairs} pairs{each}: {} photos, one of each texture at each place and bin.\n\
         A drop of the hit rate from {:.digits$} to {:.digits$} is then shown (McNemar, p < 0.05) with a chance of at least {}. Repeats at the same place and \
         bin count as one.",
        2 * pairs * bins,
        args.base_rate,
        args.base_rate - args.drop,
        args.power
    )?;
    Ok(Outcome::Done)
}

/// How many digits a number has behind its point.
fn decimals(number: f64) -> usize {
    number.to_string().split_once('.').map_or(0, |(_, digits)| digits.len())
}
