//! Label maps: what the class numbers of a detector mean.

use std::collections::HashSet;

use scaleproof_core::message::{Message, bail, message};
use serde::{Deserialize, Serialize};

/// A list of labels: in a manifest, one of the names below or a list of its own, `["car", "truck"]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(try_from = "WrittenLabels", into = "WrittenLabels")]
pub enum Labels {
    /// The 80 classes of COCO detection, in the order of COCO's category ids.
    Coco80,
    /// The 80 classes of COCO detection, numbered by COCO's category ids: 1–90 with gaps.
    Coco91,
    /// The 20 classes of Pascal VOC, in alphabetical order.
    Voc20,
    /// A detector's own. Kept until the program ends, so that labels are copied as the other lists are.
    Custom(&'static [String]),
}

/// More labels than any detector has.
const MOST_LABELS: usize = 20_000;

/// Labels as a manifest writes them.
#[derive(Deserialize, Serialize)]
#[serde(
    untagged,
    expecting = "labels are \"coco80\", \"coco91\", \"voc20\" or a list of names"
)]
enum WrittenLabels {
    Named(String),
    Custom(Vec<String>),
}

impl TryFrom<WrittenLabels> for Labels {
    type Error = Message;

    fn try_from(written: WrittenLabels) -> Result<Labels, Message> {
        match written {
            WrittenLabels::Named(name) => Labels::of_list(&name).ok_or_else(|| {
                message!("labels are {name:?}: write \"coco80\", \"coco91\", \"voc20\" or a list of names")
            }),
            WrittenLabels::Custom(names) => Labels::custom(names),
        }
    }
}

impl From<Labels> for WrittenLabels {
    fn from(labels: Labels) -> WrittenLabels {
        match labels {
            Labels::Custom(names) => WrittenLabels::Custom(names.to_vec()),
            list => {
                let named = NAMED_LISTS.into_iter().find(|(_, named)| *named == list);
                WrittenLabels::Named(named.map_or("", |(name, _)| name).to_owned())
            }
        }
    }
}

/// The lists that have a name.
const NAMED_LISTS: [(&str, Labels); 3] = [
    ("coco80", Labels::Coco80),
    ("coco91", Labels::Coco91),
    ("voc20", Labels::Voc20),
];

impl Labels {
    pub fn of_list(name: &str) -> Option<Labels> {
        let named = NAMED_LISTS.into_iter().find(|(known, _)| *known == name);
        named.map(|(_, list)| list)
    }

    /// Labels by their names, in the order of their numbers; those of COCO or VOC become that list.
    pub fn of_names(names: Vec<String>) -> Result<Labels, Message> {
        let own = || names.iter().map(|name| Some(name.as_str()));
        let is = |list: &Labels| (0..list.count()).map(|i| list.name(i)).eq(own());
        let list = [Labels::Coco80, Labels::Voc20].into_iter().find(is);
        list.map_or_else(|| Labels::custom(names.clone()), Ok)
    }

    fn custom(names: Vec<String>) -> Result<Labels, Message> {
        if names.len() > MOST_LABELS {
            bail!(
                "there are {} labels, more than the {MOST_LABELS} that are read",
                names.len()
            );
        }
        let mut seen = HashSet::new();
        match names.iter().find(|name| !seen.insert(name.as_str())) {
            Some(name) => bail!("the label {name:?} is listed twice"),
            None if names.is_empty() => bail!("the list of labels is empty"),
            None => Ok(Labels::Custom(Box::leak(names.into_boxed_slice()))),
        }
    }

    /// Returns how many numbers a network gives: one more than the highest label.
    pub fn count(self) -> usize {
        match self {
            Labels::Coco80 => COCO80.len(),
            Labels::Coco91 => 91,
            Labels::Voc20 => VOC20.len(),
            Labels::Custom(names) => names.len(),
        }
    }

    /// The name of a label; `None` for a number outside the list or in a gap.
    pub fn name(self, label: usize) -> Option<&'static str> {
        match self {
            Labels::Coco80 => COCO80.get(label).map(|(_, name)| *name),
            Labels::Coco91 => {
                let named = COCO80.iter().find(|(id, _)| *id as usize == label);
                named.map(|(_, name)| *name)
            }
            Labels::Voc20 => VOC20.get(label).copied(),
            Labels::Custom(names) => names.get(label).map(String::as_str),
        }
    }

    pub fn find(self, name: &str) -> Option<usize> {
        (0..self.count()).find(|label| self.name(*label) == Some(name))
    }

    /// The category id that COCO files use for a label: COCO's own, else counted from 1.
    pub fn category_id(self, label: usize) -> Option<u32> {
        self.name(label)?;
        match self {
            Labels::Coco80 => COCO80.get(label).map(|(id, _)| *id),
            Labels::Coco91 => u32::try_from(label).ok(),
            Labels::Voc20 | Labels::Custom(_) => u32::try_from(label + 1).ok(),
        }
    }

    pub fn of_category(self, id: u32) -> Option<usize> {
        (0..self.count()).find(|label| self.category_id(*label) == Some(id))
    }
}

/// Source: the class list of the Pascal VOC 2012 development kit.
#[rustfmt::skip]
const VOC20: [&str; 20] = [
    "aeroplane", "bicycle", "bird", "boat", "bottle", "bus", "car", "cat", "chair", "cow", "diningtable", "dog", "horse",
    "motorbike", "person", "pottedplant", "sheep", "sofa", "train", "tvmonitor",
];

/// COCO's category ids have gaps; detectors count 0–79. Source: the categories of `instances_val2017.json`.
#[rustfmt::skip]
const COCO80: [(u32, &str); 80] = [
    (1, "person"), (2, "bicycle"), (3, "car"), (4, "motorcycle"), (5, "airplane"), (6, "bus"), (7, "train"), (8, "truck"),
    (9, "boat"), (10, "traffic light"), (11, "fire hydrant"), (13, "stop sign"), (14, "parking meter"), (15, "bench"),
    (16, "bird"), (17, "cat"), (18, "dog"), (19, "horse"), (20, "sheep"), (21, "cow"), (22, "elephant"), (23, "bear"),
    (24, "zebra"), (25, "giraffe"), (27, "backpack"), (28, "umbrella"), (31, "handbag"), (32, "tie"), (33, "suitcase"),
    (34, "frisbee"), (35, "skis"), (36, "snowboard"), (37, "sports ball"), (38, "kite"), (39, "baseball bat"),
    (40, "baseball glove"), (41, "skateboard"), (42, "surfboard"), (43, "tennis racket"), (44, "bottle"),
    (46, "wine glass"), (47, "cup"), (48, "fork"), (49, "knife"), (50, "spoon"), (51, "bowl"), (52, "banana"),
    (53, "apple"), (54, "sandwich"), (55, "orange"), (56, "broccoli"), (57, "carrot"), (58, "hot dog"), (59, "pizza"),
    (60, "donut"), (61, "cake"), (62, "chair"), (63, "couch"), (64, "potted plant"), (65, "bed"), (67, "dining table"),
    (70, "toilet"), (72, "tv"), (73, "laptop"), (74, "mouse"), (75, "remote"), (76, "keyboard"), (77, "cell phone"),
    (78, "microwave"), (79, "oven"), (80, "toaster"), (81, "sink"), (82, "refrigerator"), (84, "book"), (85, "clock"),
    (86, "vase"), (87, "scissors"), (88, "teddy bear"), (89, "hair drier"), (90, "toothbrush"),
];
