//! Comparisons of a run on defended photos, and of photos with a defence with the same photos without it.

use crate::error::ScoreError;
use crate::figures::{DefenceCard, Defences, DefendedRow, PairedDifference, Scores, UNDEFENDED};
use crate::observe::Options;
use crate::robustness::changes::changes;
use crate::robustness::{Condition, Defending, Rerun};

/// Runs the detectors on every photo of a run again, under each of these defences, and compares the variants as [`crate::under_corruption`] does.
/// `None` where no photos pair.
pub fn under_defences(
    scores: &Scores,
    defences: &[Defending],
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Option<Defences>, ScoreError> {
    let defended = defences.iter().cloned().map(Condition::Defended);
    let Some(rerun) = Rerun::of(scores, defended, options, on_photo)? else {
        return Ok(None);
    };
    let names: Vec<String> = std::iter::once(UNDEFENDED.to_owned())
        .chain(defences.iter().map(Defending::name))
        .collect();
    let named = |of_each: Vec<Vec<PairedDifference>>| -> Vec<DefendedRow> {
        let of_each = names.iter().zip(of_each);
        let rows = of_each.flat_map(|(name, own)| own.into_iter().map(move |difference| (name.clone(), difference)));
        rows.map(|(defence, difference)| DefendedRow { defence, difference })
            .collect()
    };
    let changed = changes(scores, &rerun.photos, rerun.conditions.len(), options)?;
    let notes = defences.iter().filter_map(|defence| match defence {
        Defending::Program(program) => Some(program.card().notes.clone()),
        Defending::Published(_) => None,
    });
    Ok(Some(Defences {
        defences: defences.iter().map(card).collect(),
        cautions: rerun
            .left_out(scores, "defended")
            .into_iter()
            .chain(notes.flatten())
            .collect(),
        rows: named(rerun.differences),
        changes: named(changed),
    }))
}

/// Describes a defence.
fn card(defence: &Defending) -> DefenceCard {
    let (does, source) = match defence {
        Defending::Published(defence) => (defence.does().to_owned(), defence.source().to_owned()),
        Defending::Program(program) => {
            let card = program.card();
            let files = card.files.iter().map(|(name, sha256)| format!("; {name} {sha256}"));
            let version = card.version.clone().unwrap_or_default();
            (
                format!("the program {}", card.command.join(" ")),
                files.fold(version, |all, file| all + &file),
            )
        }
    };
    let name = defence.name();
    DefenceCard { name, does, source }
}
