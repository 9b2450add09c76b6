//! The labels of a detector that count as the model: those of the class, by their own names or by those that `[class_map]` gives them.

use super::{Labels, Manifest};
use scaleproof_core::message::{Message, message};
use scaleproof_core::spelling;

/// None of the names that count is known to a detector.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct NoSuchClass(Message);

impl Manifest {
    /// Returns what a label counts as: the name that `[class_map]` gives it, else its own; `None` for a number outside the labels.
    pub fn counts_as(&self, label: usize) -> Option<&str> {
        let own = self.labels.name(label)?;
        Some(self.class_map.get(own).map_or(own, String::as_str))
    }

    /// The numbers of the labels that count as one of `classes`, in their order; not one is an error.
    pub fn counted(&self, classes: &[String]) -> Result<Vec<usize>, NoSuchClass> {
        let counts = |label: &usize| {
            self.counts_as(*label)
                .is_some_and(|name| classes.iter().any(|c| c == name))
        };
        let labels: Vec<usize> = (0..self.labels.count()).filter(counts).collect();
        if !labels.is_empty() {
            return Ok(labels);
        }
        let quoted: Vec<String> = classes.iter().map(|class| format!("`{class}`")).collect();
        let wanted = classes.first().map_or("", String::as_str);
        let nearest = self.labels.nearest(wanted).into_iter().next().unwrap_or_default();
        let fault = message!(
            "{} has no label {}; {}: choose another detector or class, or say what counts in a manifest of your own, as in [class_map] {} = {}",
            self.name,
            quoted.join(" or "),
            self.labels.nearest_to(wanted),
            toml::Value::from(nearest),
            toml::Value::from(wanted)
        );
        Err(NoSuchClass(
            fault.hint("`scaleproof detectors add ‹map›` writes [class_map]"),
        ))
    }

    /// Those of `classes` that no label of this detector counts as.
    pub fn unknown_classes<'a>(&self, classes: &'a [String]) -> Vec<&'a str> {
        let is_known = |class: &str| (0..self.labels.count()).any(|label| self.counts_as(label) == Some(class));
        let names = classes.iter().map(String::as_str);
        names.filter(|class| !is_known(class)).collect()
    }

    /// Returns what is wrong with `[class_map]`, as a sentence.
    pub fn class_map_fault(&self) -> Option<String> {
        self.class_map.iter().find_map(|(own, counted)| {
            let is_label = (1..=LONGEST).contains(&counted.chars().count()) && !counted.contains(char::is_control);
            match self.labels.find(own) {
                None => Some(format!(
                    "class_map has `{own}`, which is no label of this detector; {}",
                    self.labels.nearest_to(own)
                )),
                Some(_) if !is_label => Some(format!(
                    "class_map counts `{own}` as {counted:?}: give a label of 1 to {LONGEST} characters, as in {own:?} = \"car\""
                )),
                Some(_) => None,
            }
        })
    }
}

/// No label has more characters.
const LONGEST: usize = 100;
/// Number of labels that are named to somebody who mistyped one.
const NAMED: usize = 3;

impl Labels {
    /// The labels most like a name: those that hold it or that it holds first, then by the letters that must change.
    fn nearest(self, name: &str) -> Vec<&'static str> {
        let wanted: String = name.to_lowercase().chars().take(LONGEST).collect();
        let mut all: Vec<&'static str> = (0..self.count()).filter_map(|label| self.name(label)).collect();
        all.sort_by_cached_key(|label| {
            let label = label.to_lowercase();
            let holds = label.contains(&wanted) || wanted.contains(&label);
            (!holds, spelling::edits(&label, &wanted))
        });
        all.truncate(NAMED);
        all
    }

    /// "its labels are `a`, `b`" or, of many, "the nearest of its 80 labels are `a`, `b`, `c`".
    fn nearest_to(self, name: &str) -> String {
        let nearest: Vec<String> = self.nearest(name).iter().map(|label| format!("`{label}`")).collect();
        let all = (0..self.count()).filter(|label| self.name(*label).is_some()).count();
        let nearest = nearest.join(", ");
        match all {
            1 => format!("its only label is {nearest}"),
            all if all <= NAMED => format!("its labels are {nearest}"),
            all => format!("the nearest of its {all} labels are {nearest}"),
        }
    }
}
