//! Patterns judged where they were not made: re-rendered on the model, never predicted, at viewpoints and under lights of their own.
//!
//! What comes out are photos with exact truth: the box of the projected mesh and the viewpoint are known, nothing is measured. The images are
//! denoised, so that few light paths do: nothing has to add up here. Each paint's photos lie in a folder of their own, so that a paint may be
//! added later, and one that is done is not rendered again.

pub mod finished; // the figures of a finished evaluation
mod photos; // photos that are missing, and those that Blender makes
pub mod time_chart; // patterns in rendered photos against the time of their making

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::AttackError;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::ensure;
use scaleproof_frames::FramesError;
use scaleproof_frames::render::{PlannedFrame, RenderPlan, RenderRequest, blender, check_folder, other_render};
use scaleproof_pose::scene::{Bins, Classes, Envelope, ScaleModel, Scene, Viewpoint};
use scaleproof_session as session;
use scaleproof_session::PhotoEntry;

/// Photos to be rendered: every paint from every viewpoint under every light.
#[derive(Debug)]
pub struct RenderedSet {
    plan: RenderPlan,
    /// Names of the request's paints, in its order.
    variants: Vec<String>,
    /// In the order of `plan.frames()`; their files lie below the evaluation's folder. Views under one light are one place.
    photos: Vec<PhotoEntry>,
}

impl RenderedSet {
    /// Plans the photos; `variants` name the request's paints, in their order.
    pub fn new(request: RenderRequest, variants: Vec<String>) -> Result<Self, AttackError> {
        let mut seen = HashSet::new();
        for name in &variants {
            ensure!(
                is_plain(name) && seen.insert(name),
                "{name:?} cannot name a pattern here: use letters, digits, '-', '_' and '.', each name once, and not `normal`, which is the plain model"
            );
        }
        let plan = RenderPlan::new(request)?;
        let boxes = (0..plan.request().viewpoints.len()).map(|view| plan.truth(view));
        let boxes = boxes.collect::<Result<Vec<BoxPx>, _>>()?;
        let photo = |frame: &PlannedFrame| {
            let (request, variant) = (plan.request(), &variants[frame.colour]);
            let place = request.lights[frame.light].place();
            let name = format!("{place}_{}.png", plan.view_name(frame.viewpoint));
            PhotoEntry {
                file: folder_of(variant).join(name).to_string_lossy().into_owned(),
                variant: variant.clone(),
                place: Some(place),
                box_xyxy_px: Some(boxes[frame.viewpoint]),
                viewpoint: Some(request.viewpoints[frame.viewpoint]),
                ..PhotoEntry::default()
            }
        };
        let photos = plan.frames().iter().map(photo).collect();
        Ok(Self { plan, variants, photos })
    }

    /// Lists the photos, those of one paint together, in the order of the paints.
    pub fn photos(&self) -> Vec<PhotoEntry> {
        let mut photos = self.photos.clone();
        photos.sort_by_key(|photo| self.variants.iter().position(|v| *v == photo.variant));
        photos
    }

    /// Writes the session of the photos: the scene, which is the model (name, class, scale) without tags and with a bin for each viewpoint,
    /// then the list that names it.
    pub fn write_session(&self, folder: &Path, (name, class, scale): (&str, &Classes, f64)) -> Result<(), AttackError> {
        let RenderRequest { mesh, viewpoints, .. } = self.plan.request();
        let each = |of: fn(&Viewpoint) -> f64| {
            let mut values: Vec<f64> = viewpoints.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let scene = Scene {
            model: ScaleModel {
                name: name.to_owned(),
                scale,
                class: class.clone(),
                size_mm: mesh.size_mm(),
                // Every photo says its box.
                envelope: Envelope::Box,
                mesh: Default::default(),
            },
            bins: Bins {
                azimuth_deg: azimuth_step(&each(|v| v.azimuth_deg)),
                pitch_deg: each(|v| v.pitch_deg),
                distance_mm: each(|v| v.distance_mm),
            },
            tags: Vec::new(),
        };
        files::replace_atomically(folder, &folder.join("scene.toml"), scene.to_toml().as_bytes())?;
        let path = folder.join("session.json");
        let text = session::text(&path, "scene.toml", None, self.photos(), true)?;
        Ok(files::replace_atomically(folder, &path, text.as_bytes())?)
    }

    /// Renders what `folder` still lacks. `python` is called only when something is missing; `on_photo` is called with the photos done so far, those
    /// found already included. When Blender fails, whole photos stay, and the next call goes on.
    pub fn render(
        &self,
        folder: &Path,
        python: impl FnOnce() -> Result<blender::Python, FramesError>,
        on_photo: impl FnMut(usize),
    ) -> Result<(), AttackError> {
        check_folder(folder)?;
        self.claim(folder)?;
        photos::render(&self.plan, &self.photos, folder, python, on_photo)
    }

    /// Writes the identities of the folder's views and of each paint, or refuses folders of others.
    fn claim(&self, folder: &Path) -> Result<(), AttackError> {
        let views = (folder.join("render.json"), as_file(&self.plan.view_identity()));
        ensure!(
            views.0.is_file() || !folder.join("session.json").exists(),
            "{} holds a session that no evaluation made, which would be written over; give another folder",
            folder.display()
        );
        if entries(&folder.join("photos")).any(|of_paint| has_photos(&of_paint)) && is_other(&views)? {
            return Err(other_render(folder).into());
        }
        let mut notes = vec![views];
        for (variant, paint) in self.variants.iter().zip(&self.plan.request().colours) {
            let own = folder.join(folder_of(variant));
            let note = (own.join("paint.json"), as_file(&paint.identity()));
            ensure!(
                !has_photos(&own) || !is_other(&note)?,
                "{} holds photos of another pattern, texture or tile than `{variant}` has now; give it another name, or remove that folder",
                own.display()
            );
            notes.push(note);
        }
        notes.extend(self.plan.pattern_files(folder)?);
        Ok(files::replace_all_atomically(folder, &notes)?)
    }
}

/// Returns the width of azimuth bins, which divides 360° and comes next to the smallest step between two azimuths (ascending).
pub fn azimuth_step(azimuths: &[f64]) -> f64 {
    let gaps = azimuths.windows(2).map(|pair| pair[1] - pair[0]);
    let smallest = gaps.fold(360.0, f64::min);
    360.0 / (360.0 / smallest).round().clamp(1.0, 360.0)
}

/// Returns true for a folder with photos: one that was refused before its first photo is free.
fn has_photos(folder: &Path) -> bool {
    entries(folder).any(|path| path.extension().is_some_and(|e| e == "png"))
}

/// Lists a folder that may not be there.
fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path())
}

/// Returns true when the note is not there, or says something else.
fn is_other((note, text): &(PathBuf, Vec<u8>)) -> Result<bool, FileError> {
    files::inputs::own(note);
    Ok(!note.is_file() || files::read(note)? != *text)
}

fn as_file(identity: &Value) -> Vec<u8> {
    format!("{identity:#}\n").into_bytes()
}

/// Returns the folder of a paint's photos, below the evaluation's folder.
fn folder_of(variant: &str) -> PathBuf {
    Path::new("photos").join(variant)
}

fn is_plain(name: &str) -> bool {
    let is_safe = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    !name.is_empty() && !name.starts_with('.') && name.chars().all(is_safe)
}
