//! What figures mean, as `score`, `merge` and `compare` are told: definitions, thresholds, protocols, the base and groups.

use std::collections::BTreeSet;

use super::choice::completing;
use scaleproof_detect::SCORE_FLOOR;
use scaleproof_score::score::{self, ApDefinition, CompareError, Criteria, GroupBy, GroupByError, Protocol, Scores};
use scaleproof_session::session::Session;

/// The definition of AP and the threshold of a hit, by themselves or as a protocol has them.
#[derive(clap::Args)]
pub(super) struct Reading {
    /// AP definition: coco-101, all-point, voc-11 or yolov5-ramp [default: coco-101]
    #[arg(long, value_name = "NAME", value_parser = completing(ApDefinition::from_name, ApDefinition::ALL.map(ApDefinition::name)), hide_possible_values = true, conflicts_with = "protocol")]
    ap: Option<ApDefinition>,
    /// A detection counts as a hit, a misclassification or a hallucination from this confidence up.
    #[arg(long, value_name = "C", default_value_t = score::HIT_CONFIDENCE, conflicts_with = "protocol")]
    confidence: f64,
    /// Definition, thresholds and table of a paper or benchmark: dta, active, padetbench, armory or apricot.
    #[arg(long, value_name = "NAME", value_parser = completing(Protocol::from_name, Protocol::ALL.map(Protocol::name)), hide_possible_values = true)]
    protocol: Option<Protocol>,
}

impl Reading {
    /// With this definition of AP where none is named.
    ///
    /// # Errors
    /// As [`Reading::criteria`]; another definition or a protocol is named.
    pub(super) fn criteria_or(&self, ap: Option<ApDefinition>) -> Result<Criteria, String> {
        let criteria = self.criteria()?;
        match ap {
            Some(ap) if ap != criteria.ap && (self.protocol.is_some() || self.ap.is_some()) => Err(format!(
                "the settings have the AP definition {}, and the options another one: leave one of them out",
                ap.name()
            )),
            Some(ap) => Ok(Criteria { ap, ..criteria }),
            None => Ok(criteria),
        }
    }

    pub(super) fn criteria(&self) -> Result<Criteria, String> {
        if let Some(protocol) = self.protocol {
            return Ok(Criteria::of(protocol));
        }
        if !(SCORE_FLOOR..=1.0).contains(&self.confidence) {
            return Err(format!(
                "--confidence is {}: give a number from {SCORE_FLOOR} to 1",
                self.confidence
            ));
        }
        Ok(Criteria {
            ap: self.ap.unwrap_or_default(),
            hit_confidence: self.confidence,
            protocol: None,
        })
    }
}

/// What drops are measured from, and which groups of photos get figures of their own.
#[derive(clap::Args)]
pub(super) struct Tables {
    /// The variant that drops are measured from.
    #[arg(long, value_name = "NAME", default_value = score::BASE_VARIANT)]
    base: String,
    /// Figures for each value of these conditions, such as weather,distance,theta,phi,lux:100 (steps of 100); a condition is a column of imported
    /// photos, or place, azimuth, pitch, distance, theta or phi.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    group_by: Vec<GroupBy>,
}

impl Tables {
    /// Finds out before a run that some photo has the base that was named, and the conditions.
    pub(super) fn check(&self, sessions: &[Session]) -> super::Result<()> {
        self.group_by
            .iter()
            .try_for_each(|group| group.check_sessions(sessions))?;
        let photos = sessions.iter().flat_map(|s| &s.photos);
        let variants: BTreeSet<&str> = photos.map(|p| p.variant.as_str()).collect();
        if self.base == score::BASE_VARIANT || variants.contains(self.base.as_str()) {
            return Ok(());
        }
        let (base, variants) = (self.base.clone(), variants.into_iter().collect::<Vec<_>>().join(", "));
        Err(CompareError::NoBase { base, variants }.into())
    }

    /// The run under these criteria, with these drops and groups.
    pub(super) fn made(&self, scores: Scores, criteria: Criteria) -> Result<Scores, GroupByError> {
        scores
            .judged_by(criteria)
            .against(&self.base)
            .grouped_by(&self.group_by)
    }
}
