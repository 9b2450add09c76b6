//! `scaleproof print tags`: tent cards, ground mat and plain cards of a scene.

use std::io::Write;
use std::path::PathBuf;

use serde_json::{Value, json};

use super::{CutSheetArgs, NewFile, write_files};
use crate::cli::{CommandResult, Outcome};
use scaleproof_core::spelling::count;
use scaleproof_pose::scene::Scene;
use scaleproof_print::print::tags::{Ground, Instead, TagNote, TagPrintError, TagRequest, TagSheets, tag_sheets};

#[derive(clap::Args)]
pub(crate) struct TagsArgs {
    /// The scene whose tags to print
    #[arg(long, value_name = "TOML")]
    scene: PathBuf,
    /// Every tag as a plain card, with a floor plan: no tent cards, no ground mat
    #[arg(long)]
    plain: bool,
    /// The place of every tent card on the mat itself, with no place strips: more sheets
    #[arg(long, conflicts_with = "plain")]
    whole_mat: bool,
    /// Say as JSON what was written
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    sheets: CutSheetArgs,
}

/// Runs `scaleproof print tags`.
pub(crate) fn run(args: &TagsArgs, out: &mut dyn Write) -> CommandResult {
    let media = args.sheets.media()?;
    let scene = Scene::open(&args.scene)?;
    let made = tag_sheets(
        &scene,
        &TagRequest {
            media,
            plain: args.plain,
            whole_mat: args.whole_mat,
        },
    )
    .map_err(advised)?;
    let title = format!("Tags of {}", scene.model.name);
    let files = args.sheets.output()?.files(&title, &made.names, &made.sheets)?;
    write_files(&files, &[Some(&args.scene), args.sheets.printer.as_deref()])?;
    if args.json {
        writeln!(out, "{}", json(&made, &files))?;
        return Ok(Outcome::Done);
    }
    let sheets = count(made.sheets.len(), "sheet");
    let contents = made.contents.join(", ");
    writeln!(out, "{}: {sheets}: {contents}; print at 100 %", files[0].0.display())?;
    for note in &made.notes {
        say!("note: {}", noted(note));
    }
    Ok(Outcome::Done)
}

/// The error with the option that mends it.
fn advised(error: TagPrintError) -> String {
    let instead = match &error {
        TagPrintError::TooLarge { instead, .. } => *instead,
        _ => Instead::Nothing,
    };
    let option = match instead {
        Instead::Nothing => "",
        Instead::WholeMat => " (--whole-mat)",
        Instead::PlainCards => " (--plain)",
    };
    format!("{error}{option}")
}

/// The note with the option that serves.
fn noted(note: &TagNote) -> String {
    let option = match note {
        TagNote::CutTags(_) => " (--plain)",
        TagNote::PlaceStrips => "; --whole-mat prints every card's place on the mat",
        _ => "",
    };
    format!("{note}{option}")
}

/// What was written.
fn json(made: &TagSheets, files: &[NewFile]) -> Value {
    let files: Vec<_> = files.iter().map(|(path, _)| path.display().to_string()).collect();
    let sheet = |(name, sheet): (&String, &scaleproof_print::print::sheet::Sheet)| json!({ "name": name, "width_mm": sheet.width_mm, "height_mm": sheet.height_mm });
    let sheets: Vec<_> = made.names.iter().zip(&made.sheets).map(sheet).collect();
    let cards = made
        .cut_out
        .iter()
        .map(|card| json!({ "name": card.name, "sheet": made.names.get(card.sheet) }));
    json!({
        "files": files,
        "sheets": sheets,
        "cards": cards.collect::<Vec<_>>(),
        "mat": made.ground.as_ref().map(mat),
        "notes": made.notes.iter().map(noted).collect::<Vec<_>>(),
    })
}

fn mat(ground: &Ground) -> Value {
    let paper = ground.paper;
    let strips: Vec<_> = ground
        .strips
        .iter()
        .map(|strip| format!("strip T{}", strip.tent + 1))
        .collect();
    json!({
        "size_mm": [paper.width_mm(), paper.height_mm()],
        "rows": ground.layout.rows,
        "columns": ground.layout.columns,
        "sheets": ground.names(),
        "tags": ground.mat.tags.iter().map(|(id, _)| id).collect::<Vec<_>>(),
        "cut_tags": ground.cut_tags,
        "strips": strips,
    })
}
