//! Sources of the truth boxes, in words.

use std::collections::BTreeMap;

use crate::figures::Scores;
use scaleproof_core::files;
use scaleproof_pose::scene::Envelope;

/// Returns the number of truth boxes by source, as one line: drawn around an envelope, or given by the sessions.
pub fn truth_boxes(scores: &Scores) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for photo in &scores.photos {
        let own = &scores.sessions[photo.session].scene.model.envelope;
        let drawn = || format!("through the pose, {}", envelope(own));
        let given = photo.truth_given.then(|| "given by the session".to_owned());
        *counts.entry(given.unwrap_or_else(drawn)).or_default() += 1;
    }
    let counts = counts.iter();
    let parts: Vec<_> = counts.map(|(source, count)| format!("{count} {source}")).collect();
    parts.join("; ")
}

fn envelope(envelope: &Envelope) -> String {
    match envelope {
        Envelope::Box => "envelope box (the model's size: larger than its outline)".to_owned(),
        Envelope::Hull(path) => format!("envelope hull (of {})", files::name_of(path)),
        Envelope::Mesh(path) => format!("envelope mesh ({})", files::name_of(path)),
    }
}
