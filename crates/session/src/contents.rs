//! Summary of a session's contents.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::opened::Session;
use scaleproof_core::spelling;
use scaleproof_photo::PhotoError;
use scaleproof_pose::scene::{Classes, Scene, TagFamily};

/// Result of reading a photo: the SHA-256 of its file in hex, or why it cannot be read.
pub type PhotoRead = Result<String, PhotoError>;

/// Maximum number of listed groups of photos; the rest is counted.
const MOST_GROUPS: usize = 16;

/// A session in short, for people and programs.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Contents {
    /// Name of the session's folder.
    pub session: String,
    /// The scene in short.
    pub scene: SceneInShort,
    /// `null` when every photo has its truth box and viewpoint.
    pub camera: Option<CameraInShort>,
    /// Photos of the session, in all.
    pub photos: usize,
    /// Photos by texture and place.
    pub groups: Vec<PhotoGroup>,
    /// Photos whose truth box came with the session.
    pub with_truth: usize,
    /// Photos that cannot be read, and why.
    pub unreadable: Vec<UnreadablePhoto>,
}

#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SceneInShort {
    /// Name of the model.
    pub model: String,
    /// The labels that count as the model.
    pub class: Classes,
    /// Scale of the model: 10 for 1:10.
    pub scale: f64,
    /// Length, width, height.
    pub size_mm: [f64; 3],
    /// Envelope of the ground truth boxes: `box`, `hull` or `mesh`.
    pub truth_envelope: &'static str,
    pub bins: BinsInShort,
    /// Number of tags.
    pub tags: usize,
    /// Families of the tags, by their usual names.
    pub tag_families: Vec<&'static str>,
}

#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BinsInShort {
    /// Number of bins.
    pub count: usize,
    /// Step from one azimuth to the next.
    pub azimuth_deg: f64,
    /// Centres of the bins in pitch.
    pub pitch_deg: Vec<f64>,
    /// Centres of the bins in distance.
    pub distance_mm: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CameraInShort {
    /// Width of the camera's images, and then their height.
    pub width_px: u32,
    pub height_px: u32,
    /// Focal lengths.
    pub fx_px: f64,
    pub fy_px: f64,
    /// Bound of the error of a focal length that was guessed from EXIF, percent; `null` for a calibrated camera.
    pub guessed_within_percent: Option<f64>,
}

/// Photos of one texture and place.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PhotoGroup {
    pub variant: String,
    /// `null` where the session names none.
    pub place: Option<String>,
    /// Number of photos.
    pub photos: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct UnreadablePhoto {
    pub file: String,
    /// A sentence.
    pub reason: String,
}

impl Contents {
    /// Summarises a session; `reads` are the results of reading its photos, in its order.
    pub fn of(session: &Session, reads: &[PhotoRead]) -> Contents {
        let mut groups: BTreeMap<(&str, Option<&str>), usize> = BTreeMap::new();
        for photo in &session.photos {
            *groups.entry((&photo.variant, photo.place.as_deref())).or_default() += 1;
        }
        let group = |((variant, place), photos): ((&str, Option<&str>), usize)| PhotoGroup {
            variant: variant.to_owned(),
            place: place.map(str::to_owned),
            photos,
        };
        let unreadable = session.photos.iter().zip(reads).filter_map(|(photo, read)| {
            let reason = read.as_ref().err()?.to_string();
            let file = photo.file.clone();
            Some(UnreadablePhoto { file, reason })
        });
        let Scene { model, bins, .. } = &session.scene;
        let seen = session.scene.families();
        let families = TagFamily::ALL.iter().filter(|(family, _)| seen.contains(family));
        Contents {
            session: session.name.clone(),
            scene: SceneInShort {
                model: model.name.clone(),
                class: model.class.clone(),
                scale: model.scale,
                size_mm: model.size_mm,
                truth_envelope: model.envelope.name(),
                bins: BinsInShort {
                    count: bins.count(),
                    azimuth_deg: bins.azimuth_deg,
                    pitch_deg: bins.pitch_deg.clone(),
                    distance_mm: bins.distance_mm.clone(),
                },
                tags: session.scene.tags.len(),
                tag_families: families.map(|(_, name)| *name).collect(),
            },
            camera: session.camera.as_ref().map(|camera| CameraInShort {
                width_px: camera.width,
                height_px: camera.height,
                fx_px: camera.fx,
                fy_px: camera.fy,
                guessed_within_percent: camera.guess.map(|guess| guess.focal_percent),
            }),
            photos: session.photos.len(),
            groups: groups.into_iter().map(group).collect(),
            with_truth: session.photos.iter().filter(|p| p.box_xyxy_px.is_some()).count(),
            unreadable: unreadable.collect(),
        }
    }

    /// Returns lines that fit on one screen. Groups that are not listed are counted, with `elsewhere` as the place that lists them.
    pub fn lines(&self, elsewhere: &str) -> Vec<String> {
        let (scene, groups, with_truth) = (&self.scene, &self.groups, self.with_truth);
        let [length, width, height] = scene.size_mm;
        let model = format!(
            "{}, 1:{}, {length} × {width} × {height} mm, detected as {}; truth envelope: {}",
            scene.model, scene.scale, scene.class, scene.truth_envelope
        );
        let bins = format!(
            "{}: azimuth every {}°, pitch {}°, distance {} mm",
            scene.bins.count,
            scene.bins.azimuth_deg,
            list(&scene.bins.pitch_deg),
            list(&scene.bins.distance_mm)
        );
        let camera = self.camera.as_ref().map(|c| {
            let guessed = |percent| format!(", guessed from EXIF (within {percent} %)");
            let guessed = c.guessed_within_percent.map(guessed).unwrap_or_default();
            let focal_px = (c.fx_px + c.fy_px) / 2.0;
            format!(
                "{} × {} px, focal length {focal_px:.0} px{guessed}",
                c.width_px, c.height_px
            )
        });
        let mut lines = vec![
            format!("{}: {}", self.session, spelling::count(self.photos, "photo")),
            line("model", &model),
            line("tags", &format!("{} ({})", scene.tags, scene.tag_families.join(", "))),
            line("bins", &bins),
            line(
                "camera",
                camera
                    .as_deref()
                    .unwrap_or("none: every photo has its truth box and viewpoint"),
            ),
        ];
        for (i, group) in groups.iter().take(MOST_GROUPS).enumerate() {
            let place = group
                .place
                .as_ref()
                .map_or("no place".into(), |place| format!("place {place}"));
            let name = if i == 0 { "photos" } else { "" };
            lines.push(line(name, &format!("{} {}, {place}", group.photos, group.variant)));
        }
        if groups.len() > MOST_GROUPS {
            let more = spelling::count(groups.len() - MOST_GROUPS, "more group");
            lines.push(line("", &format!("… and {more}{elsewhere}")));
        }
        if with_truth > 0 {
            let have = spelling::choose(with_truth, "has its", "have their");
            lines.push(line(
                "truth",
                &format!("{} {have} own truth box", spelling::count(with_truth, "photo")),
            ));
        }
        lines
    }
}

pub fn line(name: &str, what: &str) -> String {
    format!("{name:<9}{what}")
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}

/// Returns a sentence about photos that are byte-for-byte copies, if there are any.
pub fn copies(session: &Session, reads: &[PhotoRead]) -> Option<String> {
    let mut seen = BTreeSet::new();
    let looked = session.photos.iter().zip(reads);
    let mut copies = looked.filter(|(_, read)| read.as_ref().is_ok_and(|hash| !seen.insert(hash)));
    let (first, _) = copies.next()?;
    Some(format!(
        "{} (the first: {})",
        are_copies(1 + copies.count()),
        first.file
    ))
}

/// Returns a sentence about this number of copies.
pub fn are_copies(count: usize) -> String {
    let (one, many) = (
        "is a byte-for-byte copy of another",
        "are byte-for-byte copies of others",
    );
    let are = spelling::choose(count, one, many);
    format!("{} {are}", spelling::count(count, "photo"))
}
