//! `scaleproof print tags`: tent cards, ground mat and plain cards of a scene.

use std::io::Write;
use std::path::PathBuf;

use super::{CutSheetArgs, write_files};
use crate::cli::{CommandResult, Outcome};
use crate::print::lettering;
use crate::print::tags::{TagRequest, tag_sheets};
use crate::scene::Scene;

#[derive(clap::Args)]
pub struct TagsArgs {
    /// The scene whose tags to print
    #[arg(long, value_name = "TOML")]
    scene: PathBuf,
    /// Every tag as a plain card: no tent cards, no ground mat
    #[arg(long)]
    plain: bool,
    #[command(flatten)]
    sheets: CutSheetArgs,
}

/// Runs `scaleproof print tags`.
pub fn run(args: &TagsArgs, out: &mut dyn Write) -> CommandResult {
    let media = args.sheets.media()?;
    let scene = Scene::open(&args.scene)?;
    let made = tag_sheets(
        &scene,
        &TagRequest {
            media,
            plain: args.plain,
        },
    )?;
    let title = format!("Tags of {}", scene.model.name);
    let files = args.sheets.files(&title, &made.sheets)?;
    write_files(&files, &[Some(&args.scene), args.sheets.printer.as_deref()])?;
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
