//! Networks of Darknet: a `.cfg` and its `.weights` become an ONNX file, whose output is the table of decoded boxes that a [`crate::Head::Yolov5`] reads.
//!
//! Source: the Darknet repositories of Joseph Redmon and Alexey Bochkovskiy (`parser.c`, `yolo_layer.c`); held against OpenCV's importer.

mod cfg; // sections and settings
mod layers; // layers as ONNX nodes
mod weights; // trained numbers

use std::path::Path;

use cfg::Section;
use layers::Converter;
use scaleproof_core::files;
use scaleproof_core::message::{Message, message};
use weights::Weights;

/// YOLOv4's configuration, one of the longest, has 12 kB.
const MOST_CFG: u64 = 16 << 20;

/// The bytes of an ONNX file that computes what Darknet computes from a configuration and its weights.
pub fn darknet_to_onnx(cfg: &Path, weights: &Path) -> Result<Vec<u8>, Message> {
    let (text, bytes) = (files::read_text_at_most(cfg, MOST_CFG)?, files::read(weights)?);
    let [cfg, weights] = [cfg, weights].map(|path| path.display().to_string());
    from_contents(&text, &cfg, &bytes, &weights)
}

/// [`darknet_to_onnx`] of what the two files hold; their names are only named in errors.
pub fn from_contents(text: &str, cfg: &str, bytes: &[u8], weights: &str) -> Result<Vec<u8>, Message> {
    let in_cfg = |(line, fault): (usize, String)| message!("{cfg}, line {line}: {fault}");
    let in_weights = |fault: String| message!("{weights}: {fault}");
    let sections = Section::read(text).map_err(in_cfg)?;
    let (net, rest) = match sections.split_first() {
        Some((net, rest)) if ["net", "network"].contains(&net.kind.as_str()) => (net, rest),
        _ => {
            return Err(in_cfg((
                1,
                "it does not begin with [net]: is it a Darknet configuration?".to_owned(),
            )));
        }
    };
    let mut numbers = Weights::new(bytes).map_err(in_weights)?;
    let mut converter = Converter::new(net).map_err(|fault| in_cfg((net.line, fault)))?;
    for section in rest {
        converter
            .add(section, &mut numbers)
            .map_err(|fault| in_cfg((section.line, fault)))?;
    }
    let left = numbers.left();
    if left > 0 || numbers.missing > 0 {
        let (more, count) = if left > 0 {
            ("more", left)
        } else {
            ("fewer", numbers.missing)
        };
        return Err(in_weights(format!(
            "it has {count} numbers {more} than {cfg} asks for: these are another network's weights, or a part of them"
        )));
    }
    converter.finish().map_err(|fault| in_cfg((net.line, fault)))
}
