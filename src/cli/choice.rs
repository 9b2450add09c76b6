//! Options whose value is one of some names.

use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Takes the name of one of these.
pub(super) fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    choices: [(T, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(choices.map(|(_, name)| name)).try_map(move |given| {
        let found = choices.iter().find(|(_, name)| *name == given);
        found.map(|(choice, _)| *choice).ok_or("there is no such choice")
    })
}
