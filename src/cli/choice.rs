//! Options whose value is one of some names.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command, Error};

/// Parses as another parser does, and tells shells some names to complete.
#[derive(Clone)]
pub(super) struct Completing<P> {
    parser: P,
    names: Vec<&'static str>,
}

/// A parser whose likely values shells complete; others may be given, and say themselves what is wrong with them.
pub(super) fn completing<P: TypedValueParser>(
    parser: P,
    names: impl IntoIterator<Item = &'static str>,
) -> Completing<P> {
    let names = names.into_iter().collect();
    Completing { parser, names }
}

impl<P: TypedValueParser> TypedValueParser for Completing<P> {
    type Value = P::Value;

    fn parse_ref(&self, command: &Command, argument: Option<&Arg>, value: &OsStr) -> Result<P::Value, Error> {
        self.parser.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.names.iter().map(|name| PossibleValue::new(*name))))
    }
}

/// Takes the name of one of these.
pub(super) fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    choices: [(T, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(choices.map(|(_, name)| name)).try_map(move |given| {
        let found = choices.iter().find(|(_, name)| *name == given);
        found.map(|(choice, _)| *choice).ok_or("there is no such choice")
    })
}
