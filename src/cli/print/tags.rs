//! `scaleproof print tags`: tent cards, ground mat and plain cards of a scene.

use std::io::Write;
use std::path::PathBuf;

use super::{Format, as_files, cut_paper, numbered, printer, write_files};
use crate::cli::{CommandResult, Outcome};
use crate::print::lettering;
use crate::print::page::Media;
use crate::print::tags::{TagRequest, tag_sheets};
use crate::scene::Scene;

#[derive(clap::Args)]
pub struct TagsArgs {
    /// The scene whose tags to print
    #[arg(long, value_name = "TOML")]
    scene: PathBuf,
    /// a4, a3, letter, tabloid, or WxH in mm
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// Every tag as a plain card: no tent cards, no ground mat
    #[arg(long)]
    plain: bool,
    /// Correct the sizes by this file of `print verify`
    #[arg(long, value_name = "TOML")]
    printer: Option<PathBuf>,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// pdf, or svg (one file a page); without it, what the file's name ends in, else pdf
    #[arg(long, value_enum)]
    format: Option<Format>,
}

/// Runs `scaleproof print tags`.
pub fn run(args: &TagsArgs, out: &mut dyn Write) -> CommandResult {
    let media = Media {
        paper: cut_paper(&args.paper)?,
        printer: printer(args.printer.as_deref())?,
    };
    let scene = Scene::open(&args.scene)?;
    let made = tag_sheets(
        &scene,
        &TagRequest {
            media,
            plain: args.plain,
        },
    )?;
    let title = format!("Tags of {}", scene.model.name);
    let names = numbered(made.sheets.len());
    let files = as_files(
        Format::of(args.format, &args.output),
        &args.output,
        &title,
        (&names, &made.sheets),
    )?;
    write_files(&files, &[Some(&args.scene), args.printer.as_deref()])?;
    let contents = made.contents.join(", ");
    writeln!(out, "{}: {contents}; print at 100 %", files[0].0.display())?;
    if let Some(lifted_mm) = made.lifted_mm {
        let height = lettering::number(lifted_mm);
        writeln!(
            out,
            "note: the scene has flat tags at a height of {height} mm; the mat puts them at 0"
        )?;
    }
    for crowd in &made.crowded {
        writeln!(out, "note: {crowd}")?;
    }
    Ok(Outcome::Done)
}
