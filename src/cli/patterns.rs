//! The patterns of a run's textures, as its report shows them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::Result;
use scaleproof_print::printer::PrinterFile;
use scaleproof_score::TexturePattern;
use scaleproof_session::Session;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::{CardError, tile_mm};
use scaleproof_surface::pattern::fate::fate;

/// What is on the model; no figure depends on it.
#[derive(clap::Args)]
pub(super) struct Patterns {
    /// Patterns of textures, which the report then shows with their hash and tile size: PNG files with one pixel per cell.
    #[arg(long = "pattern", value_name = "NAME=PNG", num_args = 1..)]
    patterns: Vec<String>,
    /// Width of one repeat of the patterns on the model, in mm; as their cards say when left out.
    #[arg(long, value_name = "MM", requires = "patterns", allow_negative_numbers = true)]
    tile_mm: Option<f64>,
    /// File of `colour read`: the report then says how far the patterns' prints are off (ΔE2000).
    #[arg(long, value_name = "FILE", requires = "patterns")]
    printer: Option<PathBuf>,
}

impl Patterns {
    pub(super) fn of(&self, sessions: &[Session]) -> Result<Vec<TexturePattern>> {
        let photos = sessions.iter().flat_map(|s| &s.photos);
        let variants: BTreeSet<&str> = photos.map(|p| p.variant.as_str()).collect();
        let colours = |path: &PathBuf| -> Result<_> {
            let without = || format!("{} has the printer's lengths but not its colours", path.display());
            Ok(PrinterFile::load(path)?.colours.ok_or_else(without)?)
        };
        let colours = self.printer.as_ref().map(colours).transpose()?;
        let mut seen = BTreeSet::new();
        let mut worn = Vec::new();
        for text in &self.patterns {
            let (variant, path) = named(text)?;
            if !variants.contains(variant) || !seen.insert(variant) {
                let all = variants.iter().copied().collect::<Vec<_>>().join(", ");
                return Err(
                    format!("`{variant}` is no texture of these photos, or is named twice: they have {all}").into(),
                );
            }
            let pattern = Pattern::load(path)?;
            let tile_mm = match tile_mm(self.tile_mm, path, &pattern) {
                Err(CardError::None { .. }) => None,
                known => Some(known?),
            };
            let print_delta_e = colours
                .as_ref()
                .map(|colours| fate(&pattern, colours).printed_delta_e_mean);
            worn.push(TexturePattern {
                print_delta_e,
                ..shown(variant, path, &pattern, tile_mm)?
            });
        }
        Ok(worn)
    }
}

/// `NAME=FILE`
pub(super) fn named(text: &str) -> std::result::Result<(&str, &Path), String> {
    let (name, file) = text
        .split_once('=')
        .ok_or_else(|| format!("the pattern '{text}' has no name; write NAME=FILE, as in random=random16.png"))?;
    Ok((name, Path::new(file)))
}

/// A pattern that no print is known of.
pub(super) fn shown(variant: &str, path: &Path, pattern: &Pattern, tile_mm: Option<f64>) -> Result<TexturePattern> {
    Ok(TexturePattern {
        variant: variant.to_owned(),
        file: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        sha256: pattern.sha256().to_owned(),
        cells: [pattern.columns(), pattern.rows()],
        tile_mm,
        print_delta_e: None,
        png: pattern.to_png()?,
    })
}
