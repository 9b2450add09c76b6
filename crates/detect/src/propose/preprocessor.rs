//! `preprocessor_config.json`, which Transformers writes beside a network: how photos are prepared for it. Source: the documentation of its image
//! processors, and files that Transformers 5.24 writes.

use std::path::Path;

use serde::Deserialize;

use super::family::Family;
use crate::manifest::{Channels, Input, Kernel, Resize, SIDES_PX, Values};
use scaleproof_core::files;
use scaleproof_core::message::{Message, message};

const NAME: &str = "preprocessor_config.json";

/// The settings of the file that a manifest can use; a key that is absent leaves the family's usual.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Preprocessor {
    image_processor_type: Option<String>,
    do_resize: Option<bool>,
    size: Option<serde_json::Value>,
    resample: Option<u32>,
    do_rescale: Option<bool>,
    rescale_factor: Option<f64>,
    do_normalize: Option<bool>,
    image_mean: Option<[f64; 3]>,
    image_std: Option<[f64; 3]>,
}

/// Pillow's number of its bilinear filter.
const BILINEAR: u32 = 2;

/// A network's usual input, changed to what the bytes of a `preprocessor_config.json` say; `is_open` where the network takes photos of any size.
pub fn preprocessed(json: &[u8], usual: &Input, is_open: bool) -> Result<Input, String> {
    let mut input = usual.clone();
    Preprocessor::parse(json)?.apply(&mut input, is_open);
    Ok(input)
}

impl Preprocessor {
    /// Reads the file beside a network, if there is one.
    pub(super) fn beside(network: &Path) -> Result<Option<Preprocessor>, Message> {
        let path = files::folder_of(network).join(NAME);
        if !path.is_file() {
            return Ok(None);
        }
        let read = Preprocessor::parse(&files::read(&path)?).map(Some);
        read.map_err(|reason| {
            let path = path.display();
            message!("{path} cannot be followed ({reason}): mend it, or move it away to get the family's usual way")
        })
    }

    fn parse(json: &[u8]) -> Result<Preprocessor, String> {
        let read: Preprocessor = serde_json::from_slice(json).map_err(|e| e.to_string())?;
        let (mean, std) = (read.image_mean.unwrap_or_default(), read.image_std.unwrap_or([1.0; 3]));
        let divisors = [std.as_slice(), &[read.rescale_factor.unwrap_or(1.0)]].concat();
        if !mean.iter().all(|v| v.abs() < 1e4) || !divisors.iter().all(|v| (1e-6..1e4).contains(v)) {
            return Err(
                "image_mean, image_std or rescale_factor is no number that photos are prepared with".to_owned(),
            );
        }
        let sides = read.size_px().or(read.edges_px()).unwrap_or([*SIDES_PX.start(); 2]);
        if !sides.iter().all(|side| SIDES_PX.contains(side)) {
            let [least, most] = [SIDES_PX.start(), SIDES_PX.end()];
            return Err(format!("sides from {least} to {most} pixels can be used"));
        }
        if read.do_resize != Some(false) && read.resample.is_some_and(|filter| filter != BILINEAR) {
            let why = "photos are resized otherwise than bilinearly (resample is not 2), which no manifest can say";
            return Err(why.to_owned());
        }
        Ok(read)
    }

    fn sides(&self, names: [&str; 2]) -> Option<[u32; 2]> {
        let size = self.size.as_ref().filter(|_| self.do_resize != Some(false))?;
        let side = |name: &str| u32::try_from(size.get(name)?.as_u64()?).ok();
        Some([side(names[0])?, side(names[1])?])
    }

    /// The size that every photo is brought to: width, height.
    pub(super) fn size_px(&self) -> Option<[u32; 2]> {
        self.sides(["width", "height"])
    }

    /// The length of the shorter side, and the most for the longer.
    fn edges_px(&self) -> Option<[u32; 2]> {
        self.sides(["shortest_edge", "longest_edge"])
    }

    /// The family that the file is one of, where others have its shapes.
    pub(super) fn family(&self) -> Option<Family> {
        let name = self.image_processor_type.as_deref()?;
        name.starts_with("ConditionalDetr").then_some(Family::ConditionalDetr)
    }

    /// Writes what the file says over a family's usual way, and returns the settings that it says.
    pub(super) fn apply(&self, input: &mut Input, is_open: bool) -> Vec<&'static str> {
        let mut said = vec!["input.channels"];
        input.channels = Channels::Rgb;
        let resize = match (self.size_px(), self.edges_px()) {
            (Some(size_px), _) if is_open || input.size_px == size_px => Some((Resize::Stretch, size_px)),
            (_, Some(edges_px)) if is_open => Some((Resize::ShortestEdge, edges_px)),
            _ if self.do_resize == Some(false) && is_open => Some((Resize::Original, [0; 2])),
            _ => None,
        };
        if let Some(resize) = resize {
            (input.resize, input.size_px) = resize;
            said.extend(["input.resize", "input.size_px"]);
        }
        if self.resample.is_some() {
            input.kernel = Kernel::Antialiased;
            said.push("input.kernel");
        }
        let scale = match self.do_rescale {
            Some(false) => 1.0,
            _ => self.rescale_factor.unwrap_or(1.0 / 255.0),
        };
        let values = match (self.do_normalize, self.image_mean, self.image_std) {
            // Bytes are normalised by the network.
            _ if input.values == Values::U8 => None,
            (Some(false), ..) => Some(([0.0; 3], [1.0; 3])),
            (_, Some(mean), Some(std)) => Some((mean, std)),
            _ => None,
        };
        if let Some((mean, std)) = values {
            (input.mean, input.std) = (mean.map(|v| (v / scale) as f32), std.map(|v| (v / scale) as f32));
            said.extend(["input.mean", "input.std"]);
        }
        said
    }
}
