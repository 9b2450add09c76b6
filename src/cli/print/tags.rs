//! `scaleproof print tags`: tent cards, ground mat and plain cards of a scene.

use std::io::Write;
use std::path::PathBuf;

use super::same_file;
use crate::cli::{CommandResult, Outcome};
use crate::files;
use crate::print::tags::{TagRequest, tag_sheets};
use crate::print::{lettering, pdf};
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
    /// The PDF to write
    #[arg(short, long, value_name = "PDF")]
    output: PathBuf,
}

/// Runs `scaleproof print tags`.
pub fn run(args: &TagsArgs, out: &mut dyn Write) -> CommandResult {
    if same_file(&args.scene, &args.output) {
        return Err("the PDF would overwrite the scene; give another output file".into());
    }
    let request = TagRequest {
        paper: args.paper.parse()?,
        plain: args.plain,
    };
    let scene = Scene::open(&args.scene)?;
    let made = tag_sheets(&scene, &request)?;
    let title = format!("Tags of {}", scene.model.name);
    files::write_atomically(&args.output, &pdf::write(&title, &made.sheets)?)?;
    let contents = made.contents.join(", ");
    writeln!(out, "{}: {contents}; print at 100 %", args.output.display())?;
    if let Some(lifted_mm) = made.lifted_mm {
        let height = lettering::number(lifted_mm);
        writeln!(
            out,
            "note: the scene has flat tags at a height of {height} mm; the mat puts them at 0"
        )?;
    }
    Ok(Outcome::Done)
}
