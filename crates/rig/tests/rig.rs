//! The tests of crate `scaleproof-rig`: one program, a module for each file of the crate that it tests.

#[path = "rig/calibrate_film.rs"]
mod calibrate_film;
#[path = "rig/calibrate_fisheye.rs"]
mod calibrate_fisheye;
#[path = "rig/survey_edges.rs"]
mod survey_edges;
#[path = "rig/survey_residual.rs"]
mod survey_residual;
#[path = "rig/survey_room.rs"]
mod survey_room;
#[path = "rig/survey_sizes.rs"]
mod survey_sizes;
