//! Detector manifests: one TOML file per detector says where its weights come from, how to feed it and how to read it.

use serde::Deserialize;

use super::Labels;

/// A detector this program knows.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// What `--detector` takes.
    pub name: String,
    pub title: String,
    pub licence: String,
    pub origin: String,
    pub labels: Labels,
    pub weights: Weights,
    pub input: Input,
    pub head: Head,
}

/// The ONNX file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    pub file: String,
    /// The raw file at a pinned commit.
    pub url: String,
    /// SHA-256, hex.
    pub sha256: String,
}

/// From a photo to the input tensor (1×3×height×width, f32).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Width, height.
    pub size_px: [u32; 2],
    pub resize: Resize,
    pub kernel: Kernel,
    /// Grey level (0–255) around a letterboxed photo.
    #[serde(default)]
    pub pad: u8,
    pub channels: Channels,
    /// Each channel becomes (value − mean) / std, in the order of `channels`, on values 0–255.
    pub mean: [f32; 3],
    pub std: [f32; 3],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resize {
    /// To the full input size, whatever the aspect ratio.
    Stretch,
    /// Aspect ratio kept, photo in the top-left corner.
    LetterboxTopLeft,
    /// Aspect ratio kept, photo in the middle.
    LetterboxCentre,
}

/// The interpolation of the detector's own pipeline; another one moves scores by up to 0.07.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kernel {
    /// OpenCV `INTER_LINEAR`.
    OpencvLinear,
    /// Bilinear with the support widened for reduction, as PIL and torchvision do.
    Antialiased,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channels {
    Rgb,
    Bgr,
}

/// From output tensors to boxes. One file per kind in `heads/`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Head {
    Yolox { nms_iou: f64 },
    Nanodet { strides: Vec<u32>, nms_iou: f64 },
    Fastestdet { nms_iou: f64 },
    Deim {},
}

/// Why a manifest was refused.
#[derive(Debug, thiserror::Error)]
pub enum ManifestError {
    #[error("no detector is called {name}: choose from {known}")]
    Unknown { name: String, known: String },
    #[error("the manifest {file} is not valid: {message}")]
    Syntax { file: String, message: String },
}

/// The manifests that ship with the program, in the order lists and reports use.
const BUILT_IN: [(&str, &str); 5] = [
    ("yolox_nano.toml", include_str!("../../detectors/yolox_nano.toml")),
    ("nanodet_m.toml", include_str!("../../detectors/nanodet_m.toml")),
    ("fastestdet.toml", include_str!("../../detectors/fastestdet.toml")),
    ("deimv2_femto.toml", include_str!("../../detectors/deimv2_femto.toml")),
    ("deimv2_atto.toml", include_str!("../../detectors/deimv2_atto.toml")),
];

impl Manifest {
    /// Every known detector.
    pub fn all() -> Result<Vec<Manifest>, ManifestError> {
        BUILT_IN
            .iter()
            .map(|(file, text)| Manifest::parse(text, file))
            .collect()
    }

    /// One detector by its name.
    pub fn named(name: &str) -> Result<Manifest, ManifestError> {
        let mut all = Manifest::all()?;
        match all.iter().position(|m| m.name == name) {
            Some(i) => Ok(all.swap_remove(i)),
            None => {
                let known = all.iter().map(|m| m.name.as_str()).collect::<Vec<_>>().join(", ");
                Err(ManifestError::Unknown {
                    name: name.to_owned(),
                    known,
                })
            }
        }
    }

    /// Parses the text of a manifest; `file` is only named in errors.
    pub fn parse(text: &str, file: &str) -> Result<Manifest, ManifestError> {
        toml::from_str(text).map_err(|e| ManifestError::Syntax {
            file: file.to_owned(),
            message: e.message().replace('\n', " "),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_manifest_of_the_folder_ships_and_reads() {
        let shipped: Vec<_> = Manifest::all().unwrap();
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/detectors");
        let files = std::fs::read_dir(folder)
            .unwrap()
            .filter(|f| f.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml"));
        assert_eq!(shipped.len(), files.count());
        for m in &shipped {
            assert_eq!(m.weights.sha256.len(), 64, "{}", m.name);
            assert!(m.weights.url.starts_with("https://"), "{}", m.name);
        }
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let text = Manifest::named("yolo99").unwrap_err().to_string();
        assert!(
            text.contains("yolo99") && text.contains("yolox_nano, nanodet_m"),
            "{text}"
        );
    }

    #[test]
    fn an_unknown_key_is_refused() {
        let text = format!("colour = 1\n{}", BUILT_IN[0].1);
        assert!(
            Manifest::parse(&text, "x.toml")
                .unwrap_err()
                .to_string()
                .contains("unknown field `colour`")
        );
    }
}
