//! Arguments of `score`, `merge` and `compare` that say what figures mean: definitions, thresholds, protocols, the base and groups.

use super::choice::completing;
use scaleproof_detect::SCORE_FLOOR;
use scaleproof_plot::distinct;
use scaleproof_score as score;
use scaleproof_score::{ApDefinition, CompareError, Criteria, GroupBy, Protocol, Scores};
use scaleproof_session::Session;

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

/// The variants of sessions in the order in which their photos are listed.
pub(super) fn variants(sessions: &[Session]) -> Vec<&str> {
    let photos = sessions.iter().flat_map(|s| &s.photos);
    distinct(photos.map(|photo| photo.variant.as_str()))
}

/// The variant that drops are measured from: the one that is named, else `normal`, else the first of several.
pub(super) fn base_of<'a>(named: Option<&'a str>, sessions: &'a [Session]) -> &'a str {
    let all = variants(sessions);
    let is_clear = all.len() < 2 || all.contains(&score::BASE_VARIANT);
    let usual = if is_clear { score::BASE_VARIANT } else { all[0] };
    named.unwrap_or(usual)
}

/// Finds out, before any photo is looked at, that some have the base that is named; notes which is taken where none is.
pub(super) fn check_base(named: Option<&str>, sessions: &[Session]) -> super::Result<()> {
    let (all, base) = (variants(sessions), base_of(named, sessions));
    match named {
        Some(named) if !all.contains(&named) && named != score::BASE_VARIANT => {
            let (base, variants) = (named.to_owned(), all.join(", "));
            return Err(CompareError::NoBase { base, variants }.into());
        }
        None if base != score::BASE_VARIANT => say!(
            "note: no photo has the variant `{}`: drops are measured from `{base}`, the first that is listed; --base names another of {}",
            score::BASE_VARIANT,
            all.join(", ")
        ),
        _ => {}
    }
    Ok(())
}

/// Finds out, before any photo is looked at, that some have the control that is named, and others a texture.
pub(super) fn check_control(named: Option<&str>, base: &str, sessions: &[Session]) -> Result<(), CompareError> {
    named.map_or(Ok(()), |control| {
        score::check_control(&variants(sessions), base, control)
    })
}

/// What drops are measured from, and which groups of photos get figures of their own.
#[derive(clap::Args)]
pub(super) struct Tables {
    /// The variant that drops are measured from [default: normal, else the first that is listed]
    #[arg(long, value_name = "NAME")]
    base: Option<String>,
    /// The variant that is a second plain round: a word for a detector is held back where it moves that detector by as much as the texture does
    #[arg(long, value_name = "NAME")]
    control: Option<String>,
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
        check_base(self.base.as_deref(), sessions)?;
        let base = base_of(self.base.as_deref(), sessions);
        Ok(check_control(self.control.as_deref(), base, sessions)?)
    }

    /// The run under these criteria, with these drops, this control and these groups.
    pub(super) fn made(&self, scores: Scores, criteria: Criteria) -> super::Result<Scores> {
        let base = base_of(self.base.as_deref(), &scores.sessions).to_owned();
        let scores = scores.judged_by(criteria).against(&base);
        let scores = scores.controlled_by(self.control.as_deref())?;
        Ok(scores.grouped_by(&self.group_by)?)
    }
}
