//! The families of detectors: how each is usually fed (`families.toml`), and what its manifest says of the head.

use std::collections::BTreeMap;

use crate::manifest::{FirstLabel, Head, Input, Resize, Scores, usual_anchor_scale};
use crate::{Labels, ManifestError};

/// A family of detectors that are fed and read alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Its three grids, not decoded.
    Yolov3,
    Yolov4,
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
    Fastestdet,
    /// Also D-FINE and RT-DETR, with the photo's size as a second input.
    Deim,
    /// RT-DETR as Ultralytics exports it.
    Rtdetr,
    Rfdetr,
    /// RT-DETR, RT-DETRv2 and D-FINE as Transformers exports them.
    HfDetr,
    /// Before its postprocessing.
    Efficientdet,
    TfOd,
    SsdResnet34,
    /// Faster and Mask R-CNN of the ONNX zoo.
    ZooRcnn,
    /// R-CNN, SSD and RetinaNet of torchvision.
    Torchvision,
}

/// The families, in the order of the enum: how users write them, and what people call them.
const NAMES: [(Family, &str, &str); 19] = [
    (Family::Yolov3, "yolov3", "YOLOv3 of Darknet"),
    (Family::Yolov4, "yolov4", "YOLOv4 of the ONNX zoo"),
    (Family::Yolov5, "yolov5", "YOLOv5, v6 or v7"),
    (Family::Yolov8, "yolov8", "YOLOv8, v9, 11 or 12"),
    (Family::Yolov10, "yolov10", "YOLOv10 or YOLO26"),
    (Family::Yolox, "yolox", "YOLOX"),
    (
        Family::YoloxDecoded,
        "yolox_decoded",
        "YOLOX exported with its decoding",
    ),
    (Family::Nanodet, "nanodet", "NanoDet"),
    (Family::NanodetPlus, "nanodet_plus", "NanoDet-Plus"),
    (Family::Fastestdet, "fastestdet", "FastestDet"),
    (
        Family::Deim,
        "deim",
        "DEIM, D-FINE or RT-DETR with the photo's size as an input",
    ),
    (Family::Rtdetr, "rtdetr", "RT-DETR as Ultralytics exports it"),
    (Family::Rfdetr, "rfdetr", "RF-DETR"),
    (Family::HfDetr, "hf_detr", "RT-DETR or D-FINE of Transformers"),
    (
        Family::Efficientdet,
        "efficientdet",
        "EfficientDet before its postprocessing",
    ),
    (Family::TfOd, "tf_od", "TensorFlow Object Detection"),
    (Family::SsdResnet34, "ssd_resnet34", "SSD-ResNet34 of the ONNX zoo"),
    (Family::ZooRcnn, "zoo_rcnn", "Faster or Mask R-CNN of the ONNX zoo"),
    (Family::Torchvision, "torchvision", "a detector of torchvision"),
];

/// A name that no family has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no family `{0}`: choose one of {names}", names = NAMES.map(|(_, name, _)| name).join(", "))]
pub struct NoSuchFamily(String);

impl Family {
    /// Its name, as users write it.
    pub fn name(self) -> &'static str {
        NAMES[self as usize].1
    }

    /// The family of that name; the error lists the names.
    pub fn from_name(name: &str) -> Result<Family, NoSuchFamily> {
        let named = NAMES.into_iter().find(|(_, known, _)| *known == name);
        named
            .map(|(family, ..)| family)
            .ok_or_else(|| NoSuchFamily(name.to_owned()))
    }

    /// What people call it.
    pub fn title(self) -> &'static str {
        NAMES[self as usize].2
    }

    /// How the family's own programs prepare a photo, for a network that takes images of `size_px`, or of any size.
    pub(super) fn usual_input(self, size_px: Option<[u32; 2]>) -> Result<Input, ManifestError> {
        let mut usual = self.usual()?;
        (usual.resize, usual.size_px) = match (self, size_px) {
            (_, Some(size_px)) => (usual.resize, size_px),
            (Family::TfOd | Family::Torchvision, None) => (Resize::Original, [0, 0]),
            (Family::ZooRcnn, None) => (Resize::ShortSide, [800, 800]),
            (_, None) => (usual.resize, [0, 0]),
        };
        Ok(usual)
    }

    /// True for families whose networks take images of any size, where the file does not fix one.
    pub(super) fn takes_any_size(self) -> bool {
        matches!(self, Family::TfOd | Family::Torchvision | Family::ZooRcnn)
    }

    fn usual(self) -> Result<Input, ManifestError> {
        let refused = |message: &str| ManifestError::syntax("families.toml", message);
        let all: Result<BTreeMap<String, Input>, _> = toml::from_str(include_str!("families.toml"));
        let mut all = all.map_err(|e| refused(e.message()))?;
        all.remove(self.name()).ok_or_else(|| refused("a family is missing"))
    }

    /// How its outputs are read.
    pub(super) fn head(self, labels: Labels, strides: Vec<u32>, scores: Scores) -> Head {
        // 0 is the background, except with COCO's category ids, which need no shift.
        let first = FirstLabel {
            first_label: i64::from(labels != Labels::Coco91),
        };
        match self {
            Family::Yolov3 => Head::Yolov3 { nms_iou: 0.45 },
            Family::Yolov4 => Head::Yolov4 { nms_iou: 0.213 },
            Family::Yolov5 | Family::YoloxDecoded => Head::Yolov5 { nms_iou: 0.45 },
            Family::Yolov8 => Head::Yolov8 { nms_iou: 0.7 },
            Family::Yolov10 => Head::Yolov10 {},
            Family::Yolox => Head::Yolox { nms_iou: 0.45 },
            Family::Nanodet => Head::Nanodet { strides, nms_iou: 0.6 },
            Family::NanodetPlus => Head::NanodetPlus { strides, nms_iou: 0.6 },
            Family::Fastestdet => Head::Fastestdet { nms_iou: 0.45 },
            Family::Deim => Head::Deim {},
            Family::Rtdetr => Head::Rtdetr {},
            Family::Rfdetr | Family::HfDetr => Head::Rfdetr {},
            Family::Efficientdet => Head::Efficientdet {
                scores,
                anchor_scale: usual_anchor_scale(),
                nms_iou: 0.5,
            },
            Family::TfOd => Head::TfOd(first),
            Family::SsdResnet34 => Head::SsdResnet34(first),
            Family::ZooRcnn | Family::Torchvision => Head::Rcnn(first),
        }
    }
}
