//! Hostile input, as tables that grow by a line: picture × command, file × parser, request × route, place × output. Whatever comes from a
//! stranger ends in a sentence, or the program goes on serving; in time, within memory, and nothing is written where it should not be.

mod common;

#[path = "hostile/bounded.rs"]
mod bounded;
#[path = "hostile/captures.rs"]
mod captures;
#[path = "hostile/detectors.rs"]
mod detectors;
#[path = "capture_page/http.rs"]
mod http;
#[path = "hostile/lengths.rs"]
mod lengths;
#[path = "hostile/outputs.rs"]
mod outputs;
#[path = "hostile/pictures.rs"]
mod pictures;
#[path = "capture_page/running.rs"]
mod running;
#[path = "hostile/server.rs"]
mod server;
#[path = "hostile/soak.rs"]
mod soak;
#[path = "hostile/texts.rs"]
mod texts;
