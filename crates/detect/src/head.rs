//! The part of a manifest about outputs: the kind of head they come from, and what that kind leaves open.

use serde::{Deserialize, Serialize};

/// A manifest leaves out what is as usual.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The kind of a head, which turns output tensors into boxes. One file per form in `heads/`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Head {
    Yolox(AnchorHead),
    Nanodet(StridesHead),
    Picodet(StridesHead),
    Fastestdet(AnchorHead),
    Deim {},
    Yolov3(GridsHead),
    Yolov4(GridsHead),
    Yolov5(TableHead),
    Yolov8(TableHead),
    Yolov10 {},
    Rtdetr {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        labels: Option<AnchorLabels>,
    },
    Rfdetr {},
    Detr {},
    TfOd(ListHead),
    SsdResnet34(FirstLabel),
    Rcnn(FirstLabel),
    NanodetPlus(StridesHead),
    Efficientdet(EfficientdetHead),
    Ssd(SsdHead),
    /// No outputs are read here: another program gives boxes in pixels of the photo. No manifest names it.
    #[serde(skip)]
    Foreign {},
}

/// The labels of an anchor that become detections.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AnchorLabels {
    /// The one that scores best.
    Best,
    /// Each whose score reaches the floor.
    All,
}

/// A head whose boxes are suppressed, and nothing else is to be said.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AnchorHead {
    /// Overlap above which a box is dropped, 0 to 1.
    pub nms_iou: f64,
    /// As the family's own program does, if not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<AnchorLabels>,
}

/// A head with a pair of tables, or some rows of one table, for each stride.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StridesHead {
    pub strides: Vec<u32>,
    /// Overlap above which a box is dropped, 0 to 1.
    pub nms_iou: f64,
    /// As the family's own program does, if not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<AnchorLabels>,
}

/// A head with one table of decoded boxes.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TableHead {
    /// Overlap above which a box is dropped, 0 to 1.
    pub nms_iou: f64,
    /// As the family's own program does, if not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<AnchorLabels>,
    #[serde(default, skip_serializing_if = "is_default")]
    pub boxes: Unit,
}

/// The unit of centres and sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Pixels of the input.
    #[default]
    Pixels,
    /// Shares of the input's width and height, 0 to 1.
    Shares,
}

/// A head with a grid of cells for each stride, not decoded.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct GridsHead {
    /// Overlap above which a box is dropped, 0 to 1.
    pub nms_iou: f64,
    /// As the family's own program does, if not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<AnchorLabels>,
    /// The three of the full network, if not stated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub grids: Vec<GridAnchors>,
}

/// A grid of a Darknet YOLO.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct GridAnchors {
    /// Side of a cell in input pixels.
    pub stride: u32,
    /// Reach of a centre beyond its cell: 1 not at all; Darknet's `scale_x_y`.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale_xy: f32,
    /// Width and height of the anchors, in input pixels, in the order of the network's channels.
    pub anchors: Vec<[f32; 2]>,
}

fn one() -> f32 {
    1.0
}

fn is_one(v: &f32) -> bool {
    *v == 1.0
}

/// Boxes in one output and the scores of all labels in another.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SsdHead {
    pub boxes: SsdBoxes,
    pub scores: Scores,
    /// Overlap above which a box is dropped, 0 to 1.
    pub nms_iou: f64,
    /// As the family's own program does, if not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<AnchorLabels>,
}

/// The meaning of a box's four numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SsdBoxes {
    /// Offsets from prior boxes (y, x, height, width), as TensorFlow's `FasterRcnnBoxCoder` encodes them with 10, 10, 5, 5.
    Offsets,
    /// y1, x1, y2, x2 as shares of the input.
    Yxyx,
    /// x1, y1, x2, y2 as shares of the input.
    Xyxy,
    /// x1, y1, x2, y2 in pixels of the input.
    XyxyPixels,
}

/// EfficientDet before its postprocessing.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct EfficientdetHead {
    pub scores: Scores,
    /// Side of an anchor in strides.
    #[serde(default = "usual_anchor_scale", skip_serializing_if = "is_usual_anchor_scale")]
    pub anchor_scale: f64,
    pub nms_iou: f64,
    /// As the family's own program does, if not stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels: Option<AnchorLabels>,
}

/// The anchor scale of EfficientDet D0 to D6.
fn usual_anchor_scale() -> f64 {
    4.0
}

fn is_usual_anchor_scale(scale: &f64) -> bool {
    *scale == usual_anchor_scale()
}

/// The scores of a head, without its last sigmoid or with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scores {
    Logits,
    Probabilities,
}

/// The first number of a head with numbered labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct FirstLabel {
    /// The number the network gives the first entry of `labels`: 1 where 0 is the background, 0 with `coco91`, whose
    /// numbers are category ids already. Never assumed: off by one is another label, and nothing would show it.
    pub first_label: i64,
}

/// A head that lists its boxes under names.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ListHead {
    /// The number the network gives the first entry of `labels`: 1 where 0 is the background, 0 with `coco91`, −1 with `coco91` where the network
    /// counts COCO's category ids from 0, as TFLite does.
    pub first_label: i64,
    /// Names of the outputs that hold boxes, labels, scores and how many there are, where they are not TensorFlow's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outputs: Option<[String; 4]>,
}

impl GridAnchors {
    fn check(&self) -> Result<(), String> {
        let is_side = |side: &f32| *side > 0.0 && side.is_finite();
        let are_sides = !self.anchors.is_empty() && self.anchors.iter().flatten().all(is_side);
        if (1..=256).contains(&self.stride) && is_side(&self.scale_xy) && are_sides {
            return Ok(());
        }
        Err(format!(
            "head.grids has {self:?}: give a stride from 1 to 256 and the width and height of each anchor in pixels, as in the network's .cfg"
        ))
    }
}

impl Head {
    /// The overlap above which a box is dropped, of heads that need it.
    pub fn nms_iou(&self) -> Option<f64> {
        match self {
            Head::Yolox(head) | Head::Fastestdet(head) => Some(head.nms_iou),
            Head::Nanodet(head) | Head::Picodet(head) | Head::NanodetPlus(head) => Some(head.nms_iou),
            Head::Yolov3(head) | Head::Yolov4(head) => Some(head.nms_iou),
            Head::Yolov5(head) | Head::Yolov8(head) => Some(head.nms_iou),
            Head::Efficientdet(head) => Some(head.nms_iou),
            Head::Ssd(head) => Some(head.nms_iou),
            _ => None,
        }
    }

    /// Returns what the manifest says of an anchor's labels, in heads whose anchors have several.
    fn stated_labels(&mut self) -> Option<&mut Option<AnchorLabels>> {
        match self {
            Head::Yolox(head) | Head::Fastestdet(head) => Some(&mut head.labels),
            Head::Nanodet(head) | Head::Picodet(head) | Head::NanodetPlus(head) => Some(&mut head.labels),
            Head::Yolov3(head) | Head::Yolov4(head) => Some(&mut head.labels),
            Head::Yolov5(head) | Head::Yolov8(head) => Some(&mut head.labels),
            Head::Efficientdet(head) => Some(&mut head.labels),
            Head::Ssd(head) => Some(&mut head.labels),
            Head::Rtdetr { labels } => Some(labels),
            _ => None,
        }
    }

    /// Returns which labels of an anchor become detections: as stated, else as the family's own program does it.
    ///
    /// Best: YOLOX (`postprocess` takes `torch.max` over the labels), FastestDet (`handle_preds`), YOLOv4 of the ONNX zoo (its page's
    /// `postprocess_boxes` takes `argmax`), Ultralytics and YOLOv5 where they predict (`non_max_suppression` with `multi_label=False`). Every one:
    /// Darknet (`get_yolo_detections` keeps each above the threshold, `do_nms_sort` goes label by label), NanoDet and PicoDet (`multiclass_nms`, `MultiClassNMS`), EfficientDet (`topk_class_boxes`), SSD
    /// (`batch_multiclass_non_max_suppression`).
    pub fn anchor_labels(&self) -> AnchorLabels {
        let stated = self.clone().stated_labels().and_then(|labels| *labels);
        stated.unwrap_or(match self {
            Head::Yolox(_)
            | Head::Fastestdet(_)
            | Head::Yolov4(_)
            | Head::Yolov5(_)
            | Head::Yolov8(_)
            | Head::Rtdetr { .. } => AnchorLabels::Best,
            _ => AnchorLabels::All,
        })
    }

    /// The head with the other choice among an anchor's labels, and what that is called; `None` where it has none.
    pub fn with_other_labels(&self) -> Option<(Head, &'static str)> {
        let (other, what) = match self.anchor_labels() {
            AnchorLabels::Best => (AnchorLabels::All, "head.labels all"),
            AnchorLabels::All => (AnchorLabels::Best, "head.labels best"),
        };
        let mut head = self.clone();
        *head.stated_labels()? = Some(other);
        Some((head, what))
    }

    pub(super) fn check(&self) -> Result<(), String> {
        if let Some(nms_iou) = self.nms_iou().filter(|iou| !(0.0..=1.0).contains(iou)) {
            return Err(format!(
                "head.nms_iou is {nms_iou}: give the overlap above which a box is dropped, from 0 to 1"
            ));
        }
        match self {
            Head::Efficientdet(head) if !(head.anchor_scale > 0.0 && head.anchor_scale < 100.0) => Err(format!(
                "head.anchor_scale is {}: give the side of an anchor in strides, 4 for most",
                head.anchor_scale
            )),
            Head::Nanodet(head) | Head::Picodet(head) | Head::NanodetPlus(head)
                if head.strides.is_empty() || head.strides.contains(&0) =>
            {
                Err(format!(
                    "head.strides is {:?}: give the strides of the network, such as [8, 16, 32]",
                    head.strides
                ))
            }
            Head::Yolov3(head) | Head::Yolov4(head) => head.grids.iter().try_for_each(GridAnchors::check),
            _ => Ok(()),
        }
    }
}
