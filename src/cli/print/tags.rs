//! `scaleproof print tags`: tent cards, ground mat and plain cards of a scene.

use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, CutSheetArgs, told, written};
use scaleproof_core::spelling::count;
use scaleproof_pose::scene::Scene;
use scaleproof_print::tags::{Ground, TagNote, TagRequest, TagSheets, tag_sheets};

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
    let (plain, whole_mat) = (args.plain, args.whole_mat);
    let made = tag_sheets(
        &scene,
        &TagRequest {
            media,
            plain,
            whole_mat,
        },
    )?;
    let title = format!("Tags of {}", scene.model.name);
    let files = args.sheets.output()?.files(&title, &made.names, &made.sheets)?;
    args.sheets.output()?.write(&files)?;
    for note in made.notes.iter().filter(|_| !args.json) {
        say!("note: {}", noted(note));
    }
    let (path, sheets) = (files[0].0.display(), count(made.sheets.len(), "sheet"));
    let words = format_args!("{path}: {sheets}: {}; print at 100 %", made.contents.join(", "));
    told(args.json, written(&files, facts(&made)), words, out)
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

/// `print tags --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    /// The pages in their order.
    sheets: Vec<SheetAnswer>,
    /// What is cut out.
    cards: Vec<CardAnswer>,
    /// The ground mat.
    mat: Option<MatAnswer>,
    /// What to know before printing, as sentences.
    notes: Vec<String>,
}

#[derive(Serialize, JsonSchema)]
struct SheetAnswer {
    name: String,
    width_mm: f64,
    height_mm: f64,
}

#[derive(Serialize, JsonSchema)]
struct CardAnswer {
    /// `T1` a tent card, `id 4` a plain card, `strip T1` a place strip.
    name: String,
    /// The sheet it is on.
    sheet: Option<String>,
}

#[derive(Serialize, JsonSchema)]
struct MatAnswer {
    /// Width and height.
    size_mm: [f64; 2],
    rows: usize,
    columns: usize,
    sheets: Vec<String>,
    /// Ids of the tags on it.
    tags: Vec<u32>,
    /// Tags that a seam runs through.
    cut_tags: Vec<u32>,
    /// Names of the place strips, which hold the tent cards that stand beyond the mat's paper.
    strips: Vec<String>,
}

fn facts(made: &TagSheets) -> Answer {
    let sheets = made.names.iter().zip(&made.sheets).map(|(name, sheet)| SheetAnswer {
        name: name.clone(),
        width_mm: sheet.width_mm,
        height_mm: sheet.height_mm,
    });
    let cards = made.cut_out.iter().map(|card| CardAnswer {
        name: card.name.clone(),
        sheet: made.names.get(card.sheet).cloned(),
    });
    Answer {
        sheets: sheets.collect(),
        cards: cards.collect(),
        mat: made.ground.as_ref().map(mat),
        notes: made.notes.iter().map(noted).collect(),
    }
}

fn mat(ground: &Ground) -> MatAnswer {
    MatAnswer {
        size_mm: [ground.paper.width_mm(), ground.paper.height_mm()],
        rows: ground.layout.rows,
        columns: ground.layout.columns,
        sheets: ground.names(),
        tags: ground.mat.tags.iter().map(|(id, _)| *id).collect(),
        cut_tags: ground.cut_tags.clone(),
        strips: (ground.strips.iter().map(|strip| format!("strip T{}", strip.tent + 1))).collect(),
    }
}
