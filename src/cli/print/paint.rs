//! The paint mode of `scaleproof print template`, and what `print wrap` shares with it: sheets to paint by number, and stencils.

use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, told, written};
use crate::cli::{Result, progress};
use scaleproof_core::spelling::count;
use scaleproof_print::output::SheetOutput;
use scaleproof_print::paint::{PaintArea, PaintRequest, paint_sheets};
use scaleproof_print::template::TemplateRequest;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::{Paint, Painted, Palette, PaletteError};

#[derive(clap::Args)]
pub(crate) struct PaintArgs {
    /// Paint instead of paper: reduce the pattern to this many paints, with a stencil for each
    #[arg(long, value_name = "N", group = "paint", allow_negative_numbers = true)]
    paints: Option<i64>,
    /// Paint instead of paper, in the nearest paints of a palette file: [[paint]] tables with name and rgb
    #[arg(long, value_name = "TOML", group = "paint")]
    pub palette: Option<PathBuf>,
    /// With paints: the least width of a stencil's bridges and openings, in mm
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 1.5,
        allow_negative_numbers = true,
        requires = "paint"
    )]
    min_feature_mm: f64,
    /// With paints: stencils as seen from the back, to be cut from the back side of a film
    #[arg(long, requires = "paint")]
    mirror: bool,
}

/// Settings of the paints and of their stencils.
pub(crate) struct Paints {
    /// From a palette, else so many.
    palette: Option<Palette>,
    count: usize,
    pub(in crate::cli) min_feature_mm: f64,
    pub(in crate::cli) mirror: bool,
}

impl PaintArgs {
    pub(crate) fn is_asked(&self) -> bool {
        self.paints.is_some() || self.palette.is_some()
    }

    /// `None`: paper.
    pub(crate) fn paints(&self) -> Result<Option<Paints>> {
        let asked = self.paints.unwrap_or_default();
        let paints = Paints {
            count: usize::try_from(asked).map_err(|_| PaletteError::BadCount { asked })?,
            palette: self.palette.as_deref().map(Palette::load).transpose()?,
            min_feature_mm: self.min_feature_mm,
            mirror: self.mirror,
        };
        Ok(self.is_asked().then_some(paints))
    }
}

impl Paints {
    pub(in crate::cli) fn painted(&self, pattern: &Pattern) -> Result<Painted, PaletteError> {
        match &self.palette {
            Some(palette) => Painted::by_palette(pattern, palette),
            None => Painted::by_count(pattern, self.count),
        }
    }
}

pub(crate) fn run(
    pattern: &Pattern,
    template: TemplateRequest,
    paints: &Paints,
    output: &SheetOutput,
    (as_json, out): (bool, &mut dyn Write),
) -> CommandResult {
    let busy = progress::busy("cutting stencils");
    let painted = paints.painted(pattern)?;
    let request = PaintRequest {
        template,
        min_feature_mm: paints.min_feature_mm,
        mirror: paints.mirror,
    };
    let made = paint_sheets(pattern, &painted, &request)?;
    let files = output.files(&request.title(), &made.names, &made.pages)?;
    output.write(&files)?;
    busy.finish_and_clear();
    let sheets = made.layout.sheets.len();
    let words = format!(
        "{}: {} paints, {} to paint by number, {}; print at 100 %\n{}",
        files[0].0.display(),
        painted.paints.len(),
        count(sheets, "sheet"),
        count(made.stencils(), "stencil"),
        table(&painted, &made.areas, "panel")
    );
    let paints = paint_facts(&painted, &made.areas);
    told(as_json, written(&files, Answer { sheets, paints }), words, out)
}

/// `print template --paints --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    sheets: usize,
    #[serde(flatten)]
    paints: PaintsAnswer,
}

/// The paints and their areas.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct PaintsAnswer {
    /// In the order of spraying.
    paints: Vec<PaintAnswer>,
    /// Of all cells, from the pattern's colours (CIEDE2000).
    delta_e_mean: f64,
    delta_e_max: f64,
}

#[derive(Serialize, JsonSchema)]
struct PaintAnswer {
    name: String,
    hex: String,
    /// Area of its cells.
    cells_mm2: f64,
    /// Area of the stencils' openings.
    openings_mm2: f64,
    /// Area of the bridges over its cells, which is left to the brush.
    bridges_mm2: f64,
    /// From the pattern's colours (CIEDE2000).
    delta_e_mean: f64,
    delta_e_max: f64,
}

pub(in crate::cli) fn paint_facts(painted: &Painted, areas: &[PaintArea]) -> PaintsAnswer {
    let paints = painted.paints.iter().zip(areas).map(|(used, area)| PaintAnswer {
        name: used.paint.name.clone(),
        hex: used.paint.hex(),
        cells_mm2: area.cells_mm2,
        openings_mm2: area.openings_mm2,
        bridges_mm2: area.bridges_mm2,
        delta_e_mean: used.mean_delta_e,
        delta_e_max: used.max_delta_e,
    });
    let (delta_e_mean, delta_e_max) = painted.delta_e();
    PaintsAnswer {
        paints: paints.collect(),
        delta_e_mean,
        delta_e_max,
    }
}

/// The paints and their areas as a table, and the sum of a `whole`.
pub(in crate::cli) fn table(painted: &Painted, areas: &[PaintArea], whole: &str) -> String {
    let row = |name: &str, area: PaintArea, mean: f64, max: f64| {
        let [cells, open, left] = [area.cells_mm2, area.openings_mm2, area.bridges_mm2].map(|mm2| mm2 / 100.0);
        format!("{name:<26} {cells:>10.2} {open:>10.2} {left:>10.2} {mean:>8.1} {max:>8.1}")
    };
    let mut rows = vec![format!(
        "{:<26} {:>10} {:>10} {:>10} {:>8} {:>8}",
        "paint", "area cm²", "stencil", "touch up", "ΔE mean", "ΔE max"
    )];
    for (i, (used, area)) in painted.paints.iter().zip(areas).enumerate() {
        let Paint { name, .. } = &used.paint;
        let hex = used.paint.hex();
        // A paint of k-means is called by its colour, which need not stand there twice.
        let name = if *name == hex { "" } else { &format!(" {name}") };
        let name = format!("{:>2} {hex}{name}", i + 1);
        rows.push(row(&name, *area, used.mean_delta_e, used.max_delta_e));
    }
    let (mean, max) = painted.delta_e();
    rows.push(row(whole, PaintArea::sum(areas), mean, max));
    rows.join("\n")
}
