//! The meaning of a results file's numbers: COCO's categories, those of a COCO file, or a list of names.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::error::OutsideError;
use super::text::syntax;
use crate::Labels;
use scaleproof_core::coco::Category;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};

/// The labels of some results, and which number means which.
pub(super) struct Categories {
    pub labels: Labels,
    by_id: BTreeMap<u64, usize>,
    /// Whose they are, as in "none of COCO's".
    whose: String,
    /// The number of the first label, where that is stated.
    first: Option<u64>,
}

impl Default for Categories {
    /// COCO's own.
    fn default() -> Categories {
        Categories::numbered(Labels::Coco80, "COCO's".into())
    }
}

/// More names than any detector has; looking for copies among more would take long.
const MOST: usize = 20_000;

#[derive(Deserialize)]
struct CocoFile {
    categories: Vec<Category>,
}

impl Categories {
    /// Labels under the ids that COCO files give them.
    fn numbered(labels: Labels, whose: String) -> Categories {
        let id = |label| Some((labels.category_id(label)?.into(), label));
        Categories {
            by_id: (0..labels.count()).filter_map(id).collect(),
            labels,
            whose,
            first: None,
        }
    }

    /// The labels by numbers without gaps from a stated one on.
    pub(super) fn counted_from(self, first: Option<u64>) -> Categories {
        let Some(number) = first else { return self };
        let by_id = (0..self.labels.count())
            .map(|label| (number.saturating_add(label as u64), label))
            .collect();
        let whose = format!("{}, counted from {number}", self.whose);
        Categories {
            by_id,
            whose,
            first,
            ..self
        }
    }

    /// Reads a COCO file's `categories`, the `names` of a YOLO data set's YAML file, or a text file with one name a line.
    pub(super) fn open(path: &Path, first: Option<u64>) -> Result<Categories, OutsideError> {
        let text = files::read_text(path)?;
        let whose = format!("{}'s", path.display());
        let refuse = |message: String| OutsideError::from(FileError::content(path, message));
        let labels = |names: Result<Vec<String>, String>| {
            let labels = Labels::of_names(names.map_err(refuse)?);
            labels.map_err(|e| refuse(e.to_string()))
        };
        if path
            .extension()
            .is_some_and(|ending| ending == "yaml" || ending == "yml")
        {
            return Ok(Categories::numbered(labels(yaml_names(&text))?, whose).counted_from(first));
        }
        if !text.trim_start().starts_with(['{', '[']) {
            return Ok(Categories::numbered(labels(names(&text))?, whose).counted_from(first));
        }
        if first.is_some() {
            return Err(refuse(
                "its categories have numbers of their own: leave out that of the first label".into(),
            ));
        }
        let file: CocoFile = serde_json::from_str(&text).map_err(|e| syntax(path, &e))?;
        let by_id: BTreeMap<u64, &str> = file.categories.iter().map(|c| (c.id, c.name.as_str())).collect();
        if by_id.len() != file.categories.len() {
            return Err(refuse("an id of its categories appears twice".into()));
        }
        let names = by_id.values().map(|name| (*name).to_owned()).collect();
        Ok(Categories {
            labels: labels(checked(names))?,
            by_id: by_id.keys().enumerate().map(|(label, id)| (*id, label)).collect(),
            whose,
            first: None,
        })
    }

    /// The label of a class of YOLO's text files, which count from 0 where nothing else is stated.
    pub(super) fn of_class(&self, class: u64) -> Result<usize, String> {
        let (first, count) = (self.first.unwrap_or(0), self.labels.count());
        let label = class
            .checked_sub(first)
            .map(|label| label as usize)
            .filter(|label| *label < count);
        label.ok_or_else(|| format!("the class {class} is none of the {count} labels, which count from {first}"))
    }

    pub(super) fn of_id(&self, id: u64, path: &Path) -> Result<usize, Message> {
        let unknown = || {
            message!("{}: the category {id} is none of {}", path.display(), self.whose).hint(
                "say what its categories are called by ‹categories›, and with ‹first_label› 0 if they count from 0",
            )
        };
        self.by_id.get(&id).copied().ok_or_else(unknown)
    }

    /// Refuses categories of an `images` file that are others than COCO's, where nothing says which the results mean.
    pub(super) fn check_are_cocos(theirs: &[Category], images: &Path) -> Result<(), Message> {
        let coco = Categories::default();
        for category in theirs {
            let name = coco.by_id.get(&category.id).and_then(|label| coco.labels.name(*label));
            if name != Some(category.name.as_str()) {
                let (id, theirs, images) = (category.id, &category.name, images.display());
                let coco = name.map_or("none".into(), |name| format!("`{name}`"));
                bail!(
                    "{images} calls the category {id} `{theirs}`, and in COCO it is {coco}: whose ids the results have is not clear";
                    hint: "say by ‹categories›, which may be {images} too"
                );
            }
        }
        Ok(())
    }
}

/// A YOLO data set's description, as Ultralytics writes it: names in the order of their numbers, or by number.
#[derive(Deserialize)]
struct YoloDataSet {
    names: YoloNames,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum YoloNames {
    Listed(Vec<String>),
    Numbered(BTreeMap<u64, String>),
}

fn yaml_names(text: &str) -> Result<Vec<String>, String> {
    let read: Result<YoloDataSet, _> = serde_saphyr::from_str(text);
    let read = read.map_err(|_| "it has no `names`, neither a list nor by number".to_owned());
    match read?.names {
        YoloNames::Listed(names) => checked(names),
        YoloNames::Numbered(names) => match (0..).zip(names.keys()).find(|(expected, number)| expected != *number) {
            Some((expected, _)) => Err(format!("its `names` have no number {expected}")),
            None => checked(names.into_values().collect()),
        },
    }
}

fn names(text: &str) -> Result<Vec<String>, String> {
    let names = checked(text.trim_end().lines().map(|line| line.trim().to_owned()).collect())?;
    match names.iter().position(|name| name.is_empty()) {
        None => Ok(names),
        Some(at) => {
            let line = at + 1;
            Err(format!(
                "line {line} is empty: give one name a line, in the order of the numbers"
            ))
        }
    }
}

/// No more names than are read.
fn checked(names: Vec<String>) -> Result<Vec<String>, String> {
    match names.len() {
        0..=MOST => Ok(names),
        count => Err(format!("it has {count} names, more than the {MOST} that are read")),
    }
}
