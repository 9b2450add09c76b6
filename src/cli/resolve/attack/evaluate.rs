//! Paints, views and detectors of `attack evaluate`, resolved from its arguments.

use std::path::Path;

use crate::cli::args::attack::evaluate::EvaluateArgs;
use crate::cli::detectors;
use crate::cli::print::tile_mm;
use crate::cli::resolve::attack::render::{azimuths, hex, mesh_file, named, size, textured};
use crate::cli::score::score_with_progress;
use crate::cli::{Result, at_hand, patterns};
use scaleproof_detect::Manifest;
use scaleproof_frames::render::{Panorama, RenderPaint, RenderRequest};
use scaleproof_pose::scene::{Classes, Scene, Viewpoint};
use scaleproof_score::{BASE_VARIANT, EvaluatedDetector, Scores, TexturePattern, evaluated_detectors};
use scaleproof_session::Session;
use scaleproof_surface::model::Model;
use scaleproof_surface::pattern::Pattern;

type Paints = (Vec<String>, Vec<RenderPaint>, Vec<TexturePattern>);

impl EvaluateArgs {
    /// The names of what the model wears, and the paints: the plain model's, then patterns and textures in the order of the command; and what
    /// the report shows of the patterns.
    pub fn paints(&self, model: &Model) -> Result<Paints> {
        let normal = match self.normal.as_str() {
            "original" => RenderPaint::Original,
            text => RenderPaint::Flat(hex(text)?),
        };
        let (mut names, mut paints, mut worn) = (vec![BASE_VARIANT.to_owned()], vec![normal], Vec::new());
        for text in &self.patterns {
            let (name, file) = patterns::named(text)?;
            let pattern = Pattern::load(file)?;
            let tile_mm = tile_mm(self.tile_mm, file, &pattern)?;
            worn.push(patterns::shown(name, file, &pattern, Some(tile_mm))?);
            names.push(name.to_owned());
            paints.push(RenderPaint::Pattern(name.to_owned(), pattern, tile_mm));
        }
        for text in &self.textures {
            let (name, path) = named(text);
            names.push(name.clone());
            paints.push(textured(name, path, model)?);
        }
        Ok((names, paints, worn))
    }

    pub fn request(&self, model: Model, colours: Vec<RenderPaint>) -> Result<RenderRequest> {
        let mesh_file = mesh_file(&model)?;
        let lights = self.light.iter().map(|text| text.parse());
        Ok(RenderRequest {
            turn: model.turn,
            mesh: model.mesh,
            materials: model.materials,
            lights: lights.collect::<Result<Vec<Panorama>, _>>()?,
            viewpoints: Viewpoint::combinations(&azimuths(&self.azimuth_deg)?, &self.pitch_deg, &self.distance_mm),
            colours,
            size_px: size(&self.size_px)?,
            field_of_view_deg: self.field_of_view_deg,
            roughness: self.roughness,
            samples: self.samples,
            denoise: true,
            seed: self.seed,
            factor: 1,
            threads: self.effort.threads.map_or(0, u32::from),
            made_by: String::new(),
            mesh_file,
        })
    }

    /// The labels that count as the model: as given, else as the scene says.
    pub fn class(&self) -> Result<Classes> {
        match (&self.class, &self.model.scene) {
            (Some(class), _) => Ok(class.clone()),
            (None, Some(scene)) => Ok(Scene::open(scene)?.model.class),
            (None, None) => Ok("car".parse()?),
        }
    }

    /// The detectors to score, whose weights are here, and those that are programs; the targets are among them.
    pub fn detectors(&self, class: &Classes) -> Result<(Vec<Manifest>, Vec<EvaluatedDetector>)> {
        let (networks, programs) = self.programs.among(&self.detectors)?;
        let manifests = if networks.is_empty() && !programs.is_empty() {
            Vec::new()
        } else {
            detectors::present(&networks, &self.folder.folders()?)?
        };
        for manifest in &manifests {
            manifest.counted(class.labels())?;
        }
        let started = self.programs.started(programs)?.into_iter();
        let programs: Vec<EvaluatedDetector> = started
            .map(|program| EvaluatedDetector::program(program, class))
            .collect::<Result<_, _>>()?;
        let all = || manifests.iter().chain(programs.iter().map(|p| &p.manifest));
        let names = || all().map(|manifest| manifest.name.as_str());
        at_hand::check_names(names())?;
        match self.target.iter().find(|target| names().all(|name| name != *target)) {
            Some(target) => {
                let names = names().collect::<Vec<_>>().join(", ");
                Err(format!("the target '{target}' is not among the detectors that are scored: {names}").into())
            }
            None => Ok((manifests, programs)),
        }
    }

    pub fn scores(
        &self,
        folder: &Path,
        (manifests, programs): (Vec<Manifest>, Vec<EvaluatedDetector>),
    ) -> Result<Scores> {
        let sessions = vec![Session::open(folder)?];
        let mut detectors = evaluated_detectors(&sessions, manifests, Some(&self.folder.folders()?))?;
        detectors.extend(programs);
        let options = self.effort.options(&detectors)?;
        let scores = score_with_progress(sessions, detectors, &options)?;
        if let Some(photo) = scores.not_scored.first() {
            let (path, reason) = (folder.join(&photo.file), &photo.reason);
            let path = path.display();
            return Err(format!("{path} was not scored, so that the tables would not be whole: {reason}").into());
        }
        Ok(scores)
    }
}
