//! Hostile input, as tables that grow by a line: image × command, file × parser, request × route, place × output. Whatever comes from a
//! stranger ends in a sentence, or the program goes on serving; in time, within memory, and nothing is written where it should not be.

mod bounded;
mod captures;
mod detectors;
mod lengths;
mod names;
mod outputs;
mod over_inputs;
mod pictures;
mod server;
mod soak;
mod texts;
