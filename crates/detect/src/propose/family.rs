//! The families of detectors: what each is called, how its outputs are read and how it is usually fed (`families.toml`).

use std::sync::LazyLock;

use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::Error as NoVariant;

use crate::manifest::{Head, Input, Resize, invalid};
use scaleproof_core::message::{Message, message};

/// A family of detectors that are fed and read alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Its three grids, not decoded.
    Yolov3,
    /// Two grids, not decoded, as the next two.
    Yolov3Tiny,
    Yolov4Tiny,
    YoloFastest,
    /// Of the ONNX zoo: three grids, with scores.
    Yolov4,
    /// Any YOLO of Darknet with its decoding.
    Darknet,
    /// As pytorch-YOLOv4 exports it: boxes beside scores.
    Yolov4Pytorch,
    /// Also v6 and v7.
    Yolov5,
    /// Also v9, 11 and 12.
    Yolov8,
    /// Also YOLO26.
    Yolov10,
    Yolox,
    /// YOLOX exported with its decoding.
    YoloxDecoded,
    Nanodet,
    NanodetPlus,
    Picodet,
    Fastestdet,
    /// Also D-FINE and RT-DETR, with the photo's size as a second input.
    Deim,
    /// RT-DETR as Ultralytics exports it.
    Rtdetr,
    Rfdetr,
    /// RT-DETR, RT-DETRv2 and D-FINE as Transformers exports them.
    HfDetr,
    /// DETR and YOLOS, with a softmax over labels and "no object".
    Detr,
    /// Conditional and DAB DETR: fed as DETR, scored by sigmoids.
    ConditionalDetr,
    /// Before its postprocessing.
    Efficientdet,
    TfOd,
    /// An SSD after TFLite's operator.
    TfliteSsd,
    /// Boxes beside scores, before the suppression.
    Ssd,
    /// One table, a column for each box.
    SsdTable,
    SsdResnet34,
    /// Faster and Mask R-CNN of the ONNX zoo.
    ZooRcnn,
    /// R-CNN, SSD and RetinaNet of torchvision.
    Torchvision,
}

/// The entry of a family in `families.toml`.
#[derive(Deserialize)]
struct FamilyEntry {
    name: String,
    title: String,
    head: Head,
    input: Input,
}

#[derive(Deserialize)]
struct FamiliesFile {
    family: Vec<FamilyEntry>,
}

/// In the order of the enum.
static FAMILIES: LazyLock<Result<Vec<FamilyEntry>, String>> = LazyLock::new(|| {
    let read = toml::from_str(include_str!("families.toml"));
    read.map(|file: FamiliesFile| file.family)
        .map_err(|e| e.message().to_owned())
});

impl Family {
    fn entry(self) -> Result<&'static FamilyEntry, Message> {
        let refused = |message: &str| invalid("families.toml", message);
        let all = FAMILIES.as_ref().map_err(|message| refused(message))?;
        all.get(self as usize).ok_or_else(|| refused("a family is missing"))
    }

    pub fn name(self) -> &'static str {
        self.entry().map_or("", |entry| &entry.name)
    }

    /// The family of that name; the error lists the names.
    pub fn from_name(name: &str) -> Result<Family, Message> {
        Family::deserialize(name.into_deserializer()).map_err(|_: NoVariant| {
            let names: Vec<&str> = FAMILIES.iter().flatten().map(|entry| entry.name.as_str()).collect();
            message!("there is no family `{name}`: choose one of {}", names.join(", "))
        })
    }

    pub fn title(self) -> &'static str {
        self.entry().map_or("", |entry| &entry.title)
    }

    /// Returns how the family's own programs prepare a photo, for a network that takes images of `size_px`, or of any size.
    pub(super) fn usual_input(self, size_px: Option<[u32; 2]>) -> Result<Input, Message> {
        let mut usual = self.entry()?.input.clone();
        usual.size_px = size_px.unwrap_or_default();
        match (self, size_px) {
            (Family::TfOd | Family::Torchvision, None) => usual.resize = Resize::Original,
            (Family::Detr | Family::ConditionalDetr, None) => {
                (usual.resize, usual.size_px) = (Resize::ShortestEdge, [800, 1333])
            }
            (Family::ZooRcnn, None) => (usual.resize, usual.size_px) = (Resize::ShortSide, [800, 800]),
            _ => {}
        }
        Ok(usual)
    }

    /// True for families whose networks take images of any size, where the file does not fix one.
    pub(super) fn takes_any_size(self) -> bool {
        matches!(
            self,
            Family::TfOd | Family::Torchvision | Family::ZooRcnn | Family::Detr | Family::ConditionalDetr
        )
    }

    pub(super) fn usual_head(self) -> Result<Head, Message> {
        Ok(self.entry()?.head.clone())
    }
}
