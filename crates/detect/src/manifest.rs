//! Detector manifests: one TOML file per detector says where its weights come from, how to feed it and how to read it.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Labels;
use super::head::is_default;
pub use super::head::{
    AnchorHead, AnchorLabels, EfficientdetHead, FirstLabel, GridAnchors, GridsHead, Head, ListHead, Scores, SsdBoxes,
    SsdHead, StridesHead, TableHead, Unit,
};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::spelling;

/// A detector this program knows.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Name by which it is chosen.
    pub name: String,
    /// Name in reports.
    pub title: String,
    /// Licence of the weights.
    pub licence: String,
    /// Origin of the weights.
    pub origin: String,
    /// Names of its classes.
    pub labels: Labels,
    /// The AP@\[.5:.95\], 0 to 1, that its origin states for COCO's val2017.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_ap: Option<f64>,
    /// File, hash and address of the weights.
    pub weights: Weights,
    /// Preparation of a photo as its input.
    pub input: Input,
    /// Reading of its outputs as boxes.
    pub head: Head,
    /// Labels that count as others: label of the detector → label of the scene.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub class_map: BTreeMap<String, String>,
    /// Folder of the manifest, if it is a user's; its weights lie there too.
    #[serde(skip)]
    pub folder: Option<PathBuf>,
}

/// The ONNX file.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// A plain file name; without `url` it may also be a whole path, as `detectors add` writes for a network in another folder.
    pub file: String,
    /// The raw file at a pinned commit; empty when there is none to fetch.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub url: String,
    /// SHA-256, 64 lower-case hex digits: of the file, followed by the files that it keeps its tensors in, if any, in the order of their names.
    pub sha256: String,
}

/// The preparation of a photo as input tensor.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Width, height. For `short_side` both are the length of the photo's shorter side; for `shortest_edge` they are its length and the most that
    /// the longer one may have; `original` has none.
    #[serde(default, skip_serializing_if = "is_default")]
    pub size_px: [u32; 2],
    #[serde(default, skip_serializing_if = "is_default")]
    pub layout: Layout,
    #[serde(default, skip_serializing_if = "is_default")]
    pub values: Values,
    pub resize: Resize,
    pub kernel: Kernel,
    /// Border around a letterboxed photo.
    #[serde(default, skip_serializing_if = "is_default")]
    pub pad: Pad,
    pub channels: Channels,
    /// Each channel becomes (value − mean) / std, in the order of `channels`, on values 0–255.
    pub mean: [f32; 3],
    pub std: [f32; 3],
}

impl Input {
    /// The sides of the input tensor for an image of width × height, px.
    pub fn shape(&self, [width, height]: [u32; 2]) -> Vec<usize> {
        let [width, height] = [width, height].map(|side| side as usize);
        match self.layout {
            Layout::Nchw => vec![1, 3, height, width],
            Layout::Nhwc => vec![1, height, width, 3],
            Layout::Chw => vec![3, height, width],
        }
    }

    /// The photo as it is, its values from 0 to 255.
    pub(super) fn unchanged(layout: Layout, values: Values) -> Input {
        Input {
            size_px: [0, 0],
            layout,
            values,
            resize: Resize::Original,
            kernel: Kernel::OpencvLinear,
            pad: Pad::default(),
            channels: Channels::Rgb,
            mean: [0.0; 3],
            std: [1.0; 3],
        }
    }
}

/// The colour around a letterboxed photo: a grey level (0–255), or a level for each channel, in the order of `channels`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(untagged)]
pub enum Pad {
    Grey(u8),
    Colour([u8; 3]),
}

impl Default for Pad {
    fn default() -> Pad {
        Pad::Grey(0)
    }
}

impl Pad {
    pub fn level(self, channel: usize) -> u8 {
        match self {
            Pad::Grey(level) => level,
            Pad::Colour(levels) => levels[channel],
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Resize {
    /// To the full input size, whatever the aspect ratio.
    Stretch,
    /// Aspect ratio kept, photo in the top-left corner.
    LetterboxTopLeft,
    /// Aspect ratio kept, photo in the middle, its size truncated to whole pixels.
    LetterboxCentre,
    /// Aspect ratio kept, photo in the middle, its size rounded to whole pixels, as the YOLO programs since v5 do.
    LetterboxCentreRounded,
    /// Aspect ratio kept, the shorter side given; zeros right and below up to the next multiple of 32.
    ShortSide,
    /// Aspect ratio kept, and no border: the shorter side as the first of `size_px`, but the longer at most the second.
    ShortestEdge,
    /// The photo as it is: the network resizes.
    Original,
}

/// The order of the input tensor's axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// 1×3×height×width.
    #[default]
    Nchw,
    /// 1×height×width×3.
    Nhwc,
    /// 3×height×width.
    Chw,
}

/// The numbers of the input tensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Values {
    #[default]
    F32,
    U8,
}

/// The interpolation of the detector's own pipeline; another one moves scores by up to 0.07.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kernel {
    /// OpenCV `INTER_LINEAR`.
    OpencvLinear,
    /// OpenCV `INTER_CUBIC`.
    OpencvCubic,
    /// Bilinear with the support widened for reduction, as PIL and torchvision do.
    Antialiased,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Channels {
    Rgb,
    Bgr,
}

/// Why a manifest was refused.
#[derive(Debug, thiserror::Error)]
pub enum ManifestError {
    #[error(transparent)]
    Message(#[from] Message),
    #[error(transparent)]
    File(#[from] FileError),
}

/// Refuses a manifest's text.
pub(super) fn invalid(file: &str, fault: &str) -> Message {
    message!("the manifest {file} is not valid: {}", fault.replace('\n', " "))
}

/// Files of results are named by it, with endings.
const LONGEST_NAME: usize = 100;

/// The manifests that ship with the program, in the order lists and reports use.
const BUILT_IN: [(&str, &str); 5] = [
    ("yolox_nano.toml", include_str!("manifests/yolox_nano.toml")),
    ("nanodet_m.toml", include_str!("manifests/nanodet_m.toml")),
    ("fastestdet.toml", include_str!("manifests/fastestdet.toml")),
    ("deimv2_femto.toml", include_str!("manifests/deimv2_femto.toml")),
    ("deimv2_atto.toml", include_str!("manifests/deimv2_atto.toml")),
];

impl Manifest {
    /// Every known detector.
    pub fn all() -> Result<Vec<Manifest>, ManifestError> {
        let parsed = BUILT_IN.iter().map(|(file, text)| Manifest::parse(text, file));
        parsed.collect()
    }

    /// The names of the detectors that ship with the program.
    pub fn names() -> [&'static str; BUILT_IN.len()] {
        BUILT_IN.map(|(file, _)| file.trim_end_matches(".toml"))
    }

    /// One detector that ships with the program, by its name.
    pub fn named(name: &str) -> Result<Manifest, ManifestError> {
        Manifest::named_among(name, &[])
    }

    /// [`Manifest::named`], where a refusal also lists detectors that are `registered`.
    pub(super) fn named_among(name: &str, registered: &[String]) -> Result<Manifest, ManifestError> {
        let all = Manifest::all()?;
        let mut known: Vec<String> = all.iter().map(|m| m.name.clone()).collect();
        known.extend_from_slice(registered);
        let found = all.into_iter().find(|m| m.name == name);
        found.ok_or_else(|| {
            let hint = spelling::hint(name, known.iter().map(String::as_str));
            message!("no detector is called {name}: choose from {}{hint}", known.join(", ")).into()
        })
    }

    /// A manifest that states nothing but a detector's name, labels and input.
    pub(super) fn unstated(name: &str, labels: Labels, input: Input) -> Manifest {
        Manifest {
            name: name.to_owned(),
            title: name.to_owned(),
            licence: "not stated".to_owned(),
            origin: "not stated".to_owned(),
            labels,
            published_ap: None,
            weights: Weights::default(),
            input,
            head: Head::Foreign {},
            class_map: BTreeMap::new(),
            folder: None,
        }
    }

    /// A user's manifest, from a TOML file; its weights are looked for beside it.
    pub fn open(path: &Path) -> Result<Manifest, ManifestError> {
        let file = path.display().to_string();
        let mut manifest = Manifest::parse(&files::read_text(path)?, &file)?;
        if Manifest::all()?.iter().any(|m| m.name == manifest.name) {
            let name = manifest.name;
            bail!("the manifest {file} calls its detector {name}, which ships with scaleproof: give it another name");
        }
        manifest.folder = Some(path.parent().unwrap_or(Path::new("")).to_owned());
        Ok(manifest)
    }

    /// Parses the text of a manifest; `file` is only named in errors.
    pub fn parse(text: &str, file: &str) -> Result<Manifest, ManifestError> {
        let manifest: Manifest = toml::from_str(text).map_err(|e| invalid(file, e.message()))?;
        manifest.check().map_err(|fault| invalid(file, &fault))?;
        Ok(manifest)
    }

    /// The text of this manifest, which [`Manifest::parse`] reads as the same.
    pub fn to_toml(&self) -> Result<String, ManifestError> {
        let text = toml::to_string(self).map_err(|e| invalid(&self.name, &e.to_string()))?;
        Manifest::parse(&text, &self.name)?;
        Ok(text)
    }

    /// Returns whether a detector may have this name: files are named by it.
    pub fn is_name(name: &str) -> bool {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
        (1..=LONGEST_NAME).contains(&name.len()) && !name.starts_with('.') && name.chars().all(is_plain)
    }

    fn check(&self) -> Result<(), String> {
        if !Manifest::is_name(&self.name) {
            return Err(format!(
                "name is {:?}: use letters, digits, `_`, `-` and `.`, {LONGEST_NAME} at most, as files are named by it",
                self.name
            ));
        }
        self.weights.check()?;
        if let Some(ap) = self.published_ap.filter(|ap| !(0.0..=1.0).contains(ap)) {
            return Err(format!("published_ap is {ap}: give an AP from 0 to 1, such as 0.258"));
        }
        if let Some(fault) = self.class_map_fault() {
            return Err(fault);
        }
        let (size_px, mean, std) = (self.input.size_px, &self.input.mean, &self.input.std);
        let size_is_good = match self.input.resize {
            Resize::Original => size_px == [0, 0],
            Resize::ShortSide => size_px[0] == size_px[1] && SIDES_PX.contains(&size_px[0]),
            Resize::ShortestEdge => size_px[0] <= size_px[1] && size_px.iter().all(|side| SIDES_PX.contains(side)),
            _ => size_px.iter().all(|side| SIDES_PX.contains(side)),
        };
        if !size_is_good {
            return Err(format!(
                "input.size_px is {size_px:?}: give width and height from 32 to 8192, twice the same for `short_side`, no \
                 larger first one for `shortest_edge`, and \
                 leave it out for `original`"
            ));
        }
        if std.contains(&0.0) {
            return Err("input.std has a 0, and values are divided by it".into());
        }
        if !mean.iter().chain(std).all(|value| value.is_finite()) {
            return Err(format!("input.mean is {mean:?} and input.std {std:?}: give numbers"));
        }
        self.head.check()
    }
}

impl Weights {
    /// A manifest may come from anybody, and `detectors fetch` writes what it names: into the folder of weights and nowhere else.
    fn check(&self) -> Result<(), String> {
        let Weights { file, url, sha256 } = self;
        if !self.names_a_network() {
            return Err(format!(
                "weights.file is {file:?}: give the name of an .onnx or .ort file beside the manifest, without a folder"
            ));
        }
        let is_web = url.starts_with("https://") || url.starts_with("http://");
        if !url.is_empty() && (!is_web || url.contains(char::is_control)) {
            return Err(format!(
                "weights.url is {url:?}: give an address that begins with https:// or http://, or leave it out"
            ));
        }
        if sha256.len() != 64 || !sha256.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f')) {
            return Err(format!(
                "weights.sha256 is {sha256:?}: give the 64 lower-case hex digits that `sha256sum` prints"
            ));
        }
        Ok(())
    }

    fn names_a_network(&self) -> bool {
        let (file, path) = (&self.file, Path::new(&self.file));
        let mut parts = path.components();
        let is_one_part = matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None));
        let is_plain = is_one_part && !file.starts_with('.') && !file.contains(['/', '\\']);
        // A whole path is only read, never written to.
        let is_whole_path =
            self.url.is_empty() && path.is_absolute() && !path.components().any(|c| c == Component::ParentDir);
        is_network(file) && (is_plain || is_whole_path) && !file.contains(char::is_control)
    }
}

/// Returns whether a file is called as those that ONNX Runtime reads.
pub(super) fn is_network(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    lower.ends_with(".onnx") || lower.ends_with(".ort")
}

impl Manifest {
    /// The manifest as the family's own program validates with it: Ultralytics and YOLOv5 keep every label of a box there (`val.py` sets
    /// `multi_label=True`), unless this one says otherwise.
    pub fn when_validated(mut self) -> Manifest {
        if let Head::Yolov5(head) | Head::Yolov8(head) = &mut self.head {
            head.labels.get_or_insert(AnchorLabels::All);
        }
        self
    }
}

/// Input sides that some detector could have.
pub(super) const SIDES_PX: std::ops::RangeInclusive<u32> = 32..=8192;
