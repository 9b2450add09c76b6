//! The tests of several crates together and of the program: one integration test, linked once, with a module for each file of this folder. Tests of
//! one crate stand in its own folder.

use scaleproof_testing as common;

// What fuzzing calls.
#[path = "../fuzz/entry.rs"]
mod fuzz_entry;

mod advise;
mod architecture;
mod attack_dtn;
mod attack_evaluate;
mod attack_frames;
mod attack_import;
mod attack_judge;
mod attack_models;
mod attack_photos;
mod attack_run;
mod calibrate;
mod camera;
mod capture;
mod capture_camera;
mod capture_decided;
mod capture_page;
mod cases_detectors;
mod cases_files;
mod cases_meshes;
mod chart;
mod colour;
mod compare;
mod corruptions;
mod demo;
mod detector_proposals;
mod detectors;
mod detectors_validate;
mod diagnosis;
mod docs;
mod figures;
mod findings;
mod folders;
mod frictions;
mod headline;
mod hostile;
mod import;
mod locate;
mod manners;
mod mesh_step;
mod package;
mod parsers;
mod pattern_import;
mod print_board;
mod print_paint;
mod print_painted_pieces;
mod print_pieces;
mod print_printer;
mod print_svg;
mod print_tags;
mod print_template;
mod print_wrap;
mod program_detectors;
mod program_gradients;
mod protocols;
mod ranking;
mod real_boards;
mod real_photos;
mod real_survey;
mod report;
mod results_outside;
mod scale;
mod score;
mod sequential;
mod survey;
mod tag_detectors;
mod texture;
mod texture_bake;
mod truth;
mod video;
