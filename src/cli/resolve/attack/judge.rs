//! Patterns of `attack judge`, resolved from its arguments.

use std::path::Path;

use crate::cli::Result;
use crate::cli::args::attack::judge::JudgeArgs;
use crate::cli::resolve::attack::on_frames::pattern_of;
use crate::cli::resolve::attack::render::{hex, named};
use scaleproof_attack::judged::NamedCells;
use scaleproof_attack::run::{of_pattern, srgb};
use scaleproof_surface::pattern::Pattern;

/// Patterns by the width of one repeat, mm.
type ByTile = Vec<(f64, Vec<NamedCells>)>;

impl JudgeArgs {
    /// Returns each pattern with its name and path.
    pub fn loaded(&self) -> Result<Vec<(String, &Path, Pattern)>> {
        let mut loaded = Vec::<(String, &Path, Pattern)>::new();
        for text in &self.patterns {
            let (name, path) = named(text);
            if name.is_empty() || name.chars().any(char::is_control) {
                return Err(
                    format!("the name of {path:?} is {name:?}: give one that can be read, as in NAME=FILE").into(),
                );
            }
            if name == self.normal || loaded.iter().any(|(other, _, _)| *other == name) {
                return Err(
                    format!("`{name}` is named twice: give each pattern a name of its own, as in NAME=FILE").into(),
                );
            }
            loaded.push((name, path, pattern_of(path)?));
        }
        Ok(loaded)
    }

    /// Returns the number of columns of cells, the plain colour, and the patterns by the width of one repeat: as given, else as their
    /// cards say; those without a card are repeated as the first with one.
    pub fn asked(&self) -> Result<(u32, NamedCells, ByTile)> {
        let loaded = self.loaded()?;
        let own = loaded
            .iter()
            .map(|(_, path, pattern)| self.on.own_tile_mm(path, pattern));
        let own: Vec<Option<f64>> = own.collect::<Result<_, _>>()?;
        let usual = own.iter().copied().flatten().next().unwrap_or(self.on.tile_mm());
        let columns = loaded.first().map_or(1, |(_, _, pattern)| pattern.columns());
        let grid = self.on.mapping.grid(columns);
        let normal = vec![hex(&self.normal)?; columns as usize * grid[1] as usize];
        let mut by_tile = ByTile::new();
        for ((name, path, pattern), own) in loaded.into_iter().zip(own) {
            let size = [pattern.columns(), pattern.rows()];
            if size != grid {
                return Err(format!(
                    "{} has {}×{} cells, where {}×{} are needed with --laying {}: give patterns of one size",
                    path.display(),
                    size[0],
                    size[1],
                    grid[0],
                    grid[1],
                    self.on.mapping.name()
                )
                .into());
            }
            let tile_mm = own.unwrap_or(usual);
            let pattern = (name, of_pattern(&pattern));
            match by_tile.iter_mut().find(|(known, _)| *known == tile_mm) {
                Some((_, patterns)) => patterns.push(pattern),
                None => by_tile.push((tile_mm, vec![pattern])),
            }
        }
        Ok((columns, (self.normal.clone(), srgb(&normal)), by_tile))
    }
}
