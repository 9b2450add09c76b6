//! Label maps: what the class numbers of a detector mean.

use serde::Deserialize;

/// A named list of labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Labels {
    /// The 80 classes of COCO detection, in the order of COCO's category ids.
    Coco80,
}

impl Labels {
    /// How many labels there are.
    pub fn count(self) -> usize {
        self.table().len()
    }

    /// The name of a label; `None` for a number outside the list.
    pub fn name(self, label: usize) -> Option<&'static str> {
        self.table().get(label).map(|(_, name)| *name)
    }

    /// The number of a label by its name.
    pub fn find(self, name: &str) -> Option<usize> {
        self.table().iter().position(|(_, n)| *n == name)
    }

    /// The category id that COCO files use for a label.
    pub fn category_id(self, label: usize) -> Option<u32> {
        self.table().get(label).map(|(id, _)| *id)
    }

    /// The label of a COCO category id.
    pub fn of_category(self, id: u32) -> Option<usize> {
        self.table().iter().position(|(i, _)| *i == id)
    }

    fn table(self) -> &'static [(u32, &'static str)] {
        match self {
            Labels::Coco80 => &COCO80,
        }
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_numbers_and_category_ids_agree() {
        assert_eq!(Labels::Coco80.find("car"), Some(2));
        assert_eq!(Labels::Coco80.category_id(79), Some(90));
        for label in 0..80 {
            assert_eq!(Labels::Coco80.find(Labels::Coco80.name(label).unwrap()), Some(label));
            assert_eq!(
                Labels::Coco80.of_category(Labels::Coco80.category_id(label).unwrap()),
                Some(label)
            );
        }
    }
}
