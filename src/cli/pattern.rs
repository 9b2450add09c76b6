//! `scaleproof pattern`: make patterns, and check what a printer makes of them.

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;
use schemars::JsonSchema;
use serde::Serialize;

use super::answer::{told, written};
use super::enlarged::{note_enlarged, picture};
use super::{CommandResult, Outcome};
use scaleproof_core::files;
use scaleproof_plot::lettering::number;
use scaleproof_print::printer::PrinterFile;
use scaleproof_surface::pattern::fate::{PatternFate, fate};
use scaleproof_surface::pattern::gamut::PRINTABLE_DELTA_E;
use scaleproof_surface::pattern::import::{enlarged_pattern, in_cells, rows_for};
use scaleproof_surface::pattern::picture::Picture;
use scaleproof_surface::pattern::{Pattern, contrast};

/// So many of the worst colours are listed; `--json` has all.
const LISTED: usize = 8;

#[derive(Subcommand)]
pub(crate) enum Command {
    /// A square of uniformly random colours: the baseline every optimised pattern must beat
    Random(RandomArgs),
    /// A pattern from any image: the mean colour of each of its cells, or the cells of an enlarged grid
    Import(ImportArgs),
    /// What a printer makes of a pattern: non-printability score, colours out of its gamut, a preview
    Check(CheckArgs),
}

#[derive(clap::Args)]
pub(crate) struct RandomArgs {
    /// Cells along each side
    #[arg(long, default_value_t = 16)]
    cells: u32,
    /// Seed of the random colours; one seed gives one pattern everywhere
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The PNG to write, one pixel per cell
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
pub(crate) struct ImportArgs {
    /// The image: PNG or JPEG, or an array of 3 × height × width or height × width × 3 colours that NumPy saved (.npy)
    image: PathBuf,
    /// Cells across, as in 24 (the rows follow from the image's shape), or across and down, as in 24x16; without it, the image must be an
    /// enlarged grid
    #[arg(long, value_name = "N[xM]", allow_hyphen_values = true)]
    cells: Option<String>,
    /// The PNG to write, one pixel per cell
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
pub(crate) struct CheckArgs {
    /// The pattern: a PNG with one pixel per cell
    pattern: PathBuf,
    /// The printer file that `colour read` put the printer's colours in; without it, printing is not judged
    #[arg(long, value_name = "TOML")]
    printer: Option<PathBuf>,
    /// The pattern as it comes out of the printer: a PNG with one pixel per cell
    #[arg(short, long, value_name = "PNG", requires = "printer")]
    output: Option<PathBuf>,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// `pattern check --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    /// SHA-256 of the pattern's PNG, 64 hex digits.
    pattern_sha256: String,
    cells: usize,
    distinct_colours: usize,
    /// Median between neighbouring cells (CIEDE2000).
    contrast_delta_e_median: f64,
    /// Between neighbouring cells as printed; `null` without a printer.
    printed_contrast_delta_e_median: Option<f64>,
    /// `null` without a printer.
    print: Option<PatternFate>,
}

/// Runs `scaleproof pattern …`.
pub(crate) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Random(args) => run_random(&args, out),
        Command::Import(args) => run_import(&args, out),
        Command::Check(args) => run_check(&args, out),
    }
}

fn run_random(args: &RandomArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::random(args.cells, args.seed)?;
    let new = [(args.output.clone(), pattern.to_png()?)];
    files::write_all_atomically(&new)?;
    let (path, cells, seed) = (args.output.display(), args.cells, args.seed);
    let pattern_sha256 = pattern.sha256().to_owned();
    let facts = Random {
        cells,
        seed,
        pattern_sha256,
    };
    let words = format_args!("{path}: {cells} × {cells} random cells, seed {seed}");
    told(args.json, written(&new, facts), words, out)
}

/// `pattern random --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct Random {
    /// Along each side.
    cells: u32,
    seed: u64,
    /// Of the PNG, 64 hex digits.
    pattern_sha256: String,
}

/// `pattern import --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct Imported {
    /// Cells across.
    columns: u32,
    /// Cells down.
    rows: u32,
    /// Width and height of a cell in the image.
    pixels_per_cell: [f64; 2],
    /// Columns and rows of the grid that the image enlarges, if it is one.
    enlarged_grid: Option<[u32; 2]>,
    /// Of the PNG, 64 hex digits.
    pattern_sha256: String,
}

fn run_import(args: &ImportArgs, out: &mut dyn Write) -> CommandResult {
    let picture = picture(&args.image)?;
    let enlarged = enlarged_pattern(&picture)?;
    let grid = enlarged.as_ref().map(|pattern| [pattern.columns(), pattern.rows()]);
    let image = args.image.display();
    let pattern = match (&args.cells, enlarged) {
        (None, Some(pattern)) => pattern,
        // The colours of an array file are its cells.
        (None, None) if args.image.extension().is_some_and(|ending| ending == "npy") => {
            in_cells(&picture, picture.pixels.dimensions().into())?
        }
        (None, None) => {
            return Err(format!(
                "{image} is no enlarged grid of cells, so it needs their number: give --cells, as in --cells 24"
            )
            .into());
        }
        (Some(text), _) => in_cells(&picture, cells(text, &picture)?)?,
    };
    let new = [(args.output.clone(), pattern.to_png()?)];
    files::write_all_atomically(&new)?;
    let [columns, rows] = [pattern.columns(), pattern.rows()];
    let (width, height) = picture.pixels.dimensions();
    let pixels = [
        f64::from(width) / f64::from(columns),
        f64::from(height) / f64::from(rows),
    ];
    if let Some([across, down]) = grid.filter(|grid| args.cells.is_some() && *grid != [columns, rows]) {
        say!(
            "note: {image} is an enlarged grid of {across}×{down} cells, which --cells mixes; leave it out to have them"
        );
    }
    let [wide, high] = pixels.map(number);
    let words = match (&args.cells, grid) {
        (None, Some(_)) => {
            format!("{image} is an enlarged grid of {columns}×{rows} cells, {wide} × {high} pixels each")
        }
        _ => format!("{columns}×{rows} cells, each the mean light of {wide} × {high} pixels of {image}"),
    };
    let facts = Imported {
        columns,
        rows,
        pixels_per_cell: pixels,
        enlarged_grid: grid,
        pattern_sha256: pattern.sha256().to_owned(),
    };
    told(
        args.json,
        written(&new, facts),
        format_args!("{}: {words}", args.output.display()),
        out,
    )
}

/// Columns and rows.
fn cells(text: &str, picture: &Picture) -> Result<[u32; 2], String> {
    let number = |text: &str| text.trim().parse::<u32>().ok();
    let cells = match text.split_once('x') {
        Some((columns, rows)) => number(columns).zip(number(rows)).map(|(columns, rows)| [columns, rows]),
        None => number(text).map(|columns| [columns, rows_for(picture, columns)]),
    };
    cells.ok_or_else(|| format!("'{text}' is no number of cells; write 24, or 24x16 for columns and rows"))
}

fn run_check(args: &CheckArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::load(&args.pattern)?;
    let (mut print, mut printed_contrast) = (None, None);
    if let Some(path) = &args.printer {
        let Some(colours) = PrinterFile::load(path)?.colours else {
            let path = path.display();
            return Err(format!(
                "{path} has the printer's lengths but not its colours; add them: scaleproof print chart, then scaleproof colour read \
                 PHOTO -o {path}"
            )
            .into());
        };
        let gamut = colours.gamut();
        let printed = pattern.recoloured(|rgb| gamut.printed(rgb).rgb())?;
        if let Some(output) = &args.output {
            files::write_atomically(output, &printed.to_png()?)?;
        }
        printed_contrast = Some(contrast::median_delta_e(&printed));
        print = Some(fate(&pattern, &colours));
    }
    let counts = pattern.colour_counts();
    let answer = Answer {
        pattern_sha256: pattern.sha256().to_owned(),
        cells: counts.values().sum(),
        distinct_colours: counts.len(),
        contrast_delta_e_median: contrast::median_delta_e(&pattern),
        printed_contrast_delta_e_median: printed_contrast,
        print,
    };
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&answer)?)?;
    } else {
        describe(args, &answer, out)?;
    }
    note_enlarged(&args.pattern, &pattern);
    Ok(Outcome::Done)
}

fn describe(args: &CheckArgs, answer: &Answer, out: &mut dyn Write) -> std::io::Result<()> {
    let (path, contrast) = (args.pattern.display(), answer.contrast_delta_e_median);
    let (cells, colours) = (answer.cells, answer.distinct_colours);
    writeln!(
        out,
        "{path}: {cells} cells in {colours} colours; neighbouring cells differ by ΔE2000 {contrast:.1} (median)"
    )?;
    let Some(print) = &answer.print else {
        return writeln!(
            out,
            "No printer is named, so nothing is said about printing: give --printer with a file of `scaleproof colour read`."
        );
    };
    let printed_contrast = answer.printed_contrast_delta_e_median.unwrap_or_default();
    writeln!(
        out,
        "printed as it is: ΔE2000 {:.1} off (mean over cells); neighbouring cells then differ by {printed_contrast:.1}",
        print.printed_delta_e_mean
    )?;
    writeln!(
        out,
        "out of the printer's gamut (no printable colour within ΔE2000 {PRINTABLE_DELTA_E}): {:.1} % of the cells; with the best colours \
         requested, ΔE2000 {:.1} off (mean)",
        100.0 * print.out_of_gamut_share,
        print.best_delta_e_mean
    )?;
    writeln!(
        out,
        "NPS {:.4}: mean distance of a cell to the nearest measured colour, in sRGB with channels from 0 to 1",
        print.nps
    )?;
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    writeln!(out, "colour    cells  printed   ΔE2000  best: ask → get  ΔE2000")?;
    for c in print.colours.iter().take(LISTED) {
        let best = format!("{}→{}", hex(c.best_ask_rgb), hex(c.best_rgb));
        let (wanted, printed) = (hex(c.wanted_rgb), hex(c.printed_rgb));
        let (cells, printed_off, best_off) = (c.cells, c.printed_delta_e, c.best_delta_e);
        writeln!(
            out,
            "{wanted:<9}{cells:>6}  {printed:<9}{printed_off:>7.1}  {best:<16}{best_off:>7.1}"
        )?;
    }
    match print.colours.len().saturating_sub(LISTED) {
        0 => {}
        more => writeln!(out, "… and {more} colours that fare better; --json has all")?,
    }
    if let Some(output) = &args.output {
        writeln!(out, "preview in measured colours: {}", output.display())?;
    }
    Ok(())
}
