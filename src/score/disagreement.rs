//! AP and hit rate that tell different stories, explained where they stand: AP ranks weak finds too, a hit must be confident.

use super::{Scores, Summary};

/// From this difference on a reader wonders.
const TELLING: f64 = 0.3;

/// A sentence for each detector and variant whose AP and hit rate disagree.
pub(crate) fn disagreements(scores: &Scores) -> Vec<String> {
    scores.summaries.iter().filter_map(|s| explained(scores, s)).collect()
}

fn explained(scores: &Scores, s: &Summary) -> Option<String> {
    let index = scores.detectors.iter().position(|d| d.manifest.name == s.detector)?;
    let (f, criteria) = (&s.overall, &scores.criteria);
    let difference = f.ap50 - f.hit_rate.rate;
    let head = format!(
        "{} on “{}”: AP@0.5 is {:.2} beside {} of {} photos hit",
        scores.title(&s.detector),
        s.variant,
        f.ap50,
        f.hit_rate.count,
        f.photos
    );
    let own = || scores.photos.iter().filter(|p| p.variant == s.variant);
    let weak = own().filter(|p| p.outcomes[index].confidence > 0.0 && !p.outcomes[index].is_hit());
    if difference >= TELLING {
        return Some(format!(
            "{head}, since {} more photos show the model at a confidence below {}, which AP counts by rank and a hit does not",
            weak.count(),
            criteria.hit_confidence
        ));
    }
    (difference <= -TELLING).then(|| {
        let wrong: usize = own().map(|p| p.outcomes[index].false_positives).sum();
        format!(
            "{head}, since AP counts false positives too: {wrong} from confidence {} up, and weaker ones",
            criteria.hit_confidence
        )
    })
}
