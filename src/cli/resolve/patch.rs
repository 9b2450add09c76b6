//! Patches that are placed on the sides of a model.

use crate::cli::args::patch::PlaceArgs;
use crate::cli::{Result, enlarged};
use scaleproof_core::geometry::length::parse_mm;
use scaleproof_print::paper;
use scaleproof_print::patch::{PanelPatch, PatchError};
use scaleproof_surface::texture::PlacedPatch;

/// The patches as they were requested: the options belong together in order.
pub fn asked(args: &PlaceArgs) -> Result<Vec<PanelPatch>> {
    let count = args.patch.len();
    if count == 0 {
        return Err("give --patch, with its --panel, --at-mm and --size-mm".into());
    }
    if [args.panel.len(), args.at_mm.len(), args.size_mm.len()] != [count; 3] {
        return Err("every --patch needs its own --panel, --at-mm and --size-mm; repeat all four for each".into());
    }
    let one = |i: usize| -> Result<PanelPatch> {
        let image = enlarged::picture(&args.patch[i]).map_err(PatchError::from)?;
        let size = args.size_mm[i].trim();
        let size_mm = match parse_mm(size) {
            Ok(width) => (width, image.height_for(width)),
            Err(_) => paper::size_mm(size)?,
        };
        let name = args.patch[i].file_name().map(|n| n.to_string_lossy().into_owned());
        Ok(PanelPatch {
            name: name.unwrap_or_default(),
            image,
            side: args.panel[i],
            at_mm: place(&args.at_mm[i])?,
            size_mm,
        })
    };
    (0..count).map(one).collect()
}

pub fn placed(patches: &[PanelPatch]) -> Vec<PlacedPatch> {
    let patches = patches.iter().map(|patch| PlacedPatch {
        image: patch.image.pixels.clone(),
        side: patch.side,
        at_mm: patch.at_mm,
        size_mm: patch.size_mm,
    });
    patches.collect()
}

pub fn place(text: &str) -> Result<[f64; 2]> {
    let numbers = text
        .split_once(',')
        .and_then(|(x, y)| Some([parse_mm(x).ok()?, parse_mm(y).ok()?]));
    numbers.ok_or_else(|| format!("place '{text}' is not understood; write X,Y in mm, as in -40,65").into())
}
