//! Unit and property tests of sessions and their truth boxes.

#[path = "session/conditions.rs"]
mod conditions;
#[path = "session/cone.rs"]
mod cone;
#[path = "session/envelope.rs"]
mod envelope;
#[path = "session/new.rs"]
mod new;
#[path = "session/open.rs"]
mod open;
