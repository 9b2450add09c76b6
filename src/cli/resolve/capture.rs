//! `capture`: the views, the source and the page that are asked for.

use super::names::check_names;
use crate::cli::Result;
use crate::cli::args::capture::{GuidedArgs, PageArgs, ViewArgs};
use scaleproof_capture::{GuidedRequest, PageRequest, SourceName, SourceOptions, ViewsRequest};

impl GuidedArgs {
    pub fn request(&self, wanted: &ViewArgs, browser: &PageArgs) -> Result<GuidedRequest> {
        check_names(&self.variant, &self.place)?;
        match &self.source {
            Some(SourceName::Upload) if !browser.page => {
                return Err("photos are sent to the page: add --page, or --page --lan for phones".into());
            }
            None | Some(SourceName::Replay(_)) => {}
            Some(_) if self.shuffle.is_some() || self.fps.is_some() => {
                return Err("--shuffle and --fps are for replay: sources: leave them out".into());
            }
            Some(_) => {}
        }
        Ok(GuidedRequest {
            scene: self.scene.clone(),
            camera: self.camera.clone(),
            variant: self.variant.clone(),
            place: self.place.clone(),
            folder: self.output.clone(),
            source: self.source.clone(),
            options: SourceOptions {
                headless: self.headless,
                shuffle: self.shuffle,
                pace: self.fps,
            },
            views: wanted.request()?,
            page: browser.page.then_some(PageRequest {
                port: browser.port,
                lan: browser.lan,
            }),
        })
    }
}

impl ViewArgs {
    fn request(&self) -> Result<ViewsRequest, String> {
        // Not as the other tolerances: lengths are read as all lengths are, in any unit.
        if let Some(mm) = self.distance_tolerance_mm.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
            return Err(format!("--distance-tolerance-mm is {mm}: give a length above 0"));
        }
        Ok(ViewsRequest {
            pitch_deg: self.pitch_deg.clone(),
            distance_mm: self.distance_mm.clone(),
            pair_with: self.pair_with.clone(),
            azimuth_tolerance_deg: self.azimuth_tolerance_deg,
            pitch_tolerance_deg: self.pitch_tolerance_deg,
            distance_tolerance_mm: self.distance_tolerance_mm,
        })
    }
}
