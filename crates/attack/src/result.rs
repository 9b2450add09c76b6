//! The files of a result, written together or not at all, so that they cannot disagree.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::run::history::History;
use super::run::view_set::TextureMapping;
use super::run::{AttackConfig, Rgb, to_image};
use crate::AttackError;
use scaleproof_core::files;
use scaleproof_frames::encode_rgb;
use scaleproof_surface::pattern::card::Card;

pub const PATTERN: &str = "pattern.png";
pub const CONFIG: &str = "config.json";

/// Writes a pattern, its card, its history, and the settings of the attack that made it, if one did. Returns the pattern's path.
pub fn write(
    folder: &Path,
    (cells, columns, mapping): (&[Rgb], u32, TextureMapping),
    history: &History,
    config: Option<&AttackConfig>,
) -> Result<PathBuf, AttackError> {
    let path = folder.join(PATTERN);
    let png = encode_rgb(&to_image(cells, columns))?;
    let mut about = json!({
        "made_by": format!("scaleproof {} attack, method {}", history.scaleproof, history.method),
        "cells": mapping.grid(columns),
        "seed": history.seed,
        "detectors": history.detectors,
        "classes": history.classes,
        "frames_sha256": history.frames_sha256,
        "queries": history.queries(),
        "held_out_by_renderer_model": history.last_judged().map(|(_, figures)| figures),
    });
    if let Some(defence) = config.and_then(|config| config.eot.defence) {
        about["knows_defence"] = defence.name().into();
    }
    let card = Card {
        pattern_sha256: files::sha256_hex(&png),
        tile_mm: history.tile_mm,
        sides: mapping == TextureMapping::Sides,
        about: about.as_object().cloned().unwrap_or_default(),
    };
    let card = card.to_file(&path)?;
    let mut new = vec![(path.clone(), png), card, history.to_file(folder)?];
    let config_path = folder.join(CONFIG);
    if let Some(config) = config {
        new.push((config_path.clone(), serde_json::to_vec_pretty(config)?));
    }
    files::replace_all_atomically(folder, &new)?;
    // Settings of an earlier attack are not those of this pattern.
    if config.is_none() && config_path.is_file() {
        files::chosen::remove(folder, &config_path)?;
    }
    Ok(path)
}
