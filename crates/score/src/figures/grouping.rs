//! Groups of photos by a condition: `weather`, `lux:100`, or one that follows from the viewpoint.

use std::collections::BTreeSet;
use std::str::FromStr;

use crate::figures::ScoredPhoto;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::spelling;
use scaleproof_session::{PhotoEntry, Session};

/// A condition to group by, and for numbers the width of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupBy {
    pub condition: String,
    /// Width of a group: numbers from 0 to below `step` are one group, and so on. Without it each value is a group.
    pub step: Option<f64>,
}

/// Largest number of groups of a table.
const MOST_GROUPS: usize = 200;

/// Conditions that follow from the centre of a photo's bin, when none of that name is given. `theta` and `phi` are PADetBench's: the angle from
/// straight above, and the azimuth.
const OF_VIEWPOINT: [&str; 5] = ["azimuth", "distance", "phi", "pitch", "theta"];

impl FromStr for GroupBy {
    type Err = Message;

    fn from_str(text: &str) -> Result<GroupBy, Message> {
        let syntax =
            || message!("`{text}` names no group: write a condition, as in weather, or one with a step, as in lux:100");
        let (condition, step) = match text.split_once(':') {
            None => (text, None),
            Some((condition, step)) => (condition, Some(step.parse::<f64>().map_err(|_| syntax())?)),
        };
        let condition = condition.trim().to_owned();
        let is_good = !condition.is_empty() && step.is_none_or(|step| step.is_finite() && step > 0.0);
        is_good.then_some(GroupBy { condition, step }).ok_or_else(syntax)
    }
}

impl GroupBy {
    /// Returns the group of a photo; `None` for a photo without the condition.
    pub(crate) fn group_of(&self, photo: &ScoredPhoto) -> Option<String> {
        let value = value(photo, &self.condition)?;
        match self.step.zip(value.parse::<f64>().ok()) {
            Some((step, number)) => {
                let low = whole_steps(number / step) * step;
                Some(format!("{} to {}", plain(low), plain(low + step)))
            }
            None => Some(value),
        }
    }

    /// Checks before a run that photos will have the condition, and numbers where there are steps.
    pub fn check_sessions(&self, sessions: &[Session]) -> Result<(), Message> {
        let entries = || sessions.iter().flat_map(|s| &s.photos);
        let is_given = entries().any(|p| p.conditions.contains_key(&self.condition));
        if !is_given && OF_VIEWPOINT.contains(&self.condition.as_str()) {
            return Ok(());
        }
        let given = |p: &PhotoEntry| match (p.conditions.get(&self.condition), self.condition.as_str()) {
            (None, "place") => p.place.clone(),
            (own, _) => own.cloned(),
        };
        let with: Vec<_> = entries().filter_map(|p| Some((p.file.as_str(), given(p)?))).collect();
        self.check_values(&with, entries().flat_map(|p| p.conditions.keys()))
    }

    /// Checks that photos have the condition, and numbers where there are steps, and that the groups make a table.
    pub(crate) fn check(&self, photos: &[ScoredPhoto]) -> Result<(), Message> {
        let with = photos
            .iter()
            .filter_map(|p| Some((p.file.as_str(), value(p, &self.condition)?)));
        let with: Vec<_> = with.collect();
        self.check_values(&with, photos.iter().flat_map(|p| p.conditions.keys()))?;
        let groups: BTreeSet<String> = photos.iter().filter_map(|p| self.group_of(p)).collect();
        if groups.len() <= MOST_GROUPS {
            return Ok(());
        }
        let (condition, groups) = (&self.condition, groups.len());
        bail!(
            "`{condition}` has {groups} values, more than the {MOST_GROUPS} that a table holds: group numbers by steps, as in {condition}:100"
        )
    }

    /// Checks values: `with` has the file and value of each photo that has the condition, `names` the conditions of all.
    fn check_values<'a>(
        &self,
        with: &[(&str, String)],
        names: impl Iterator<Item = &'a String>,
    ) -> Result<(), Message> {
        if with.is_empty() {
            return Err(self.unknown(names.map(String::as_str)));
        }
        let is_text = |(_, value): &&(&str, String)| value.parse::<f64>().map_or(true, |v| !v.is_finite());
        match (self.step, with.iter().find(is_text)) {
            (Some(_), Some((file, value))) => {
                bail!("`{value}` of {file} is no number, so `{}` has no steps", self.condition)
            }
            _ => Ok(()),
        }
    }

    fn unknown<'a>(&self, own: impl Iterator<Item = &'a str>) -> Message {
        let known: BTreeSet<&str> = own.chain(OF_VIEWPOINT).chain(["place"]).collect();
        let similar = spelling::hint(&self.condition, known.iter().copied());
        let known = known.into_iter().collect::<Vec<_>>().join(", ");
        let unknown = message!(
            "no photo has the condition `{}`; there are {known}{similar}",
            self.condition
        );
        if similar.is_empty() {
            unknown
                .hint("`session import` keeps the columns of a table, and session.json has `conditions` for each photo")
        } else {
            unknown
        }
    }
}

/// Returns the number of whole steps in `steps`; 0.3 / 0.1 is 2.9999999999999996, and means 3.
pub fn whole_steps(steps: f64) -> f64 {
    let nearest = steps.round();
    if (steps - nearest).abs() <= 1e-9 * nearest.abs() {
        nearest
    } else {
        steps.floor()
    }
}

/// Returns a condition of a photo: its own, or one that follows from its place and bin.
fn value(photo: &ScoredPhoto, condition: &str) -> Option<String> {
    if let Some(own) = photo.conditions.get(condition) {
        return Some(own.clone());
    }
    if condition == "place" {
        return photo.place.clone();
    }
    let bin = photo.bin?;
    let number = match condition {
        "azimuth" | "phi" => bin.azimuth_deg,
        "pitch" => bin.pitch_deg,
        "theta" => 90.0 - bin.pitch_deg,
        "distance" => bin.distance_mm,
        _ => return None,
    };
    Some(plain(number))
}

/// Formats a number without the digits that rounding adds.
fn plain(number: f64) -> String {
    ((number * 1e6).round() / 1e6).to_string()
}

/// Sorts groups as a reader expects: numbers by size, then texts.
pub(crate) fn in_order(mut groups: Vec<String>) -> Vec<String> {
    let number = |group: &str| group.split(" to ").next().and_then(|first| first.parse::<f64>().ok());
    groups.sort_by(|a, b| match (number(a), number(b)) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (a, b) => b.is_some().cmp(&a.is_some()),
    });
    groups
}
