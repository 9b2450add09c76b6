//! Request of `attack import`, resolved from its arguments.

use crate::cli::Result;
use crate::cli::args::attack::import::ImportArgs;
use crate::cli::args::model::ModelArgs;
use crate::cli::resolve::attack::render::{described, file_name, hex, options};
use scaleproof_frames::FramePaint;
use scaleproof_frames::import::fca::FcaRequest;

impl ImportArgs {
    pub fn drop_m(&self) -> f64 {
        self.drop_m.unwrap_or(0.0)
    }

    pub fn field_of_view_deg(&self) -> f64 {
        self.field_of_view_deg.unwrap_or(90.0)
    }

    /// An option that was given and says nothing to the layout with masks.
    pub fn of_fca(&self) -> Option<&'static str> {
        let given = [
            ("--drop-m", self.drop_m.is_some()),
            ("--field-of-view-deg", self.field_of_view_deg.is_some()),
            ("--flat", self.flat.is_some()),
            ("--scale", self.model.scale.is_some()),
        ];
        let own = given.iter().find_map(|(option, is_given)| is_given.then_some(*option));
        own.or_else(|| self.model.of_a_mesh())
    }

    pub fn fca_request(&self) -> Result<FcaRequest> {
        let model = self.model.load()?;
        Ok(FcaRequest {
            mesh: model.mesh,
            materials: model.materials,
            scale: model.scale,
            drop_m: self.drop_m(),
            field_of_view_deg: self.field_of_view_deg(),
            paint: match &self.flat {
                Some(text) => FramePaint::FlatRgb(hex(text)?),
                None => FramePaint::Original,
            },
            made_by: self.made_by(&self.model.filled()?, model.scale),
        })
    }

    /// The arguments that decide about the frames, with files by their names only.
    pub fn made_by(&self, model: &ModelArgs, scale: f64) -> String {
        format!(
            "attack import --layout fca --mesh {}{} --scale {scale} --drop-m {} --field-of-view-deg {}{}",
            model.mesh.as_deref().map(file_name).unwrap_or_default(),
            described(model),
            self.drop_m(),
            self.field_of_view_deg(),
            options([("flat", self.flat.clone())])
        )
    }
}
