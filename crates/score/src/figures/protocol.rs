//! Protocols of papers and benchmarks: the thresholds, the definition and the source of each, by name.

use crate::figures::MATCH_IOU;
use scaleproof_core::ap::ApDefinition;

/// Protocol whose figures a run can be compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// DTA (Suryanto et al., CVPR 2022).
    Dta,
    /// ACTIVE (Suryanto et al., ICCV 2023).
    Active,
    /// PADetBench (Lian et al. 2024).
    PaDetBench,
    /// Armory's detection metrics (Two Six Technologies).
    Armory,
    /// APRICOT (Braunegg et al., ECCV 2020) as Armory evaluates it.
    Apricot,
}

/// A name that no protocol has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no protocol `{0}`: choose one of {names}", names = Protocol::ALL.map(Protocol::name).join(", "))]
pub struct UnknownProtocol(String);

impl Protocol {
    /// All protocols.
    pub const ALL: [Protocol; 5] = [
        Protocol::Dta,
        Protocol::Active,
        Protocol::PaDetBench,
        Protocol::Armory,
        Protocol::Apricot,
    ];

    /// Returns the name that stands in every output.
    pub fn name(self) -> &'static str {
        ["dta", "active", "padetbench", "armory", "apricot"][self as usize]
    }

    /// Returns the protocol of that name; the error lists the names.
    pub fn from_name(name: &str) -> Result<Protocol, UnknownProtocol> {
        let named = Protocol::ALL.into_iter().find(|p| p.name() == name);
        named.ok_or_else(|| UnknownProtocol(name.to_owned()))
    }

    /// Returns the source of the definitions, and what it leaves open.
    pub fn source(self) -> &'static str {
        match self {
            Protocol::Dta => {
                "Suryanto et al., “DTA: Physical Camouflage Attacks using Differentiable Transformation Network”, CVPR 2022, tables 1 and 2: \
                 AP@0.5 / mean confidence. The paper does not say how AP is interpolated: COCO's 101 points are taken"
            }
            Protocol::Active => {
                "Suryanto et al., “ACTIVE: Towards Highly Transferable 3D Physical Camouflage for Universal and Robust Vehicle Evasion”, ICCV 2023: \
                 AP@0.5 in %, and for the physical test the share of photos in which the car is found, in % (the published values are multiples of \
                 1/240). The paper states neither the interpolation of AP nor the confidence: COCO's 101 points and 0.5 are taken"
            }
            Protocol::PaDetBench => {
                "Lian et al., “PADetBench: Towards Benchmarking Physical Attacks against Object Detection”, arXiv 2408.09181, and its \
                 repository at 7884e27 (auto-detect-validation): the fields adv_type, benchmark, model_name and mAR 50; ASR = 1 − metric ÷ metric \
                 of clean"
            }
            Protocol::Armory => {
                "Armory Library, `ObjectDetectionRates`, and Armory, `object_detection_AP_per_class`: confidence > 0.5, IoU > 0.5, all labels; a photo with a \
                 right and a wrong label counts as both, so that the disappearance rate (1 − the two) may fall below 0; AP over 11 recalls, two \
                 digits. Armory's mAP is the mean over all true and found labels, for photos labelled in full: here only the model is labelled, and \
                 its AP is given"
            }
            Protocol::Apricot => {
                "Braunegg et al., “APRICOT: A Dataset of Physical Adversarial Attacks on Object Detection”, ECCV 2020 (arXiv 1912.08166), as in \
                 Armory, `apricot_patch_targeted_AP_per_class`: detections of the target label at IoU > 0.1, further ones ignored, AP over 11 recalls, two \
                 digits. Here the patterned model takes the patch's place, and the target is the label that most photos show there instead, \
                 its detections from confidence 0.001 up"
            }
        }
    }

    /// Returns the definition of AP.
    pub fn ap(self) -> ApDefinition {
        if self.is_strict() {
            ApDefinition::Voc11
        } else {
            ApDefinition::Coco101
        }
    }

    /// Returns the IoU with the truth box from which a detection is on the model.
    pub fn match_iou(self) -> f64 {
        if self == Protocol::Apricot { 0.1 } else { MATCH_IOU }
    }

    /// Returns true if a value must be above its threshold, and not only reach it.
    pub fn is_strict(self) -> bool {
        matches!(self, Protocol::Armory | Protocol::Apricot)
    }
}
