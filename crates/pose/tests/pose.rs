//! The tests of crate `scaleproof-pose`: one program, a module for each file of the crate that it tests.

#[path = "pose/board_corners.rs"]
mod board_corners;
#[path = "pose/camera.rs"]
mod camera;
#[path = "pose/camera_files.rs"]
mod camera_files;
#[path = "pose/camera_fisheye.rs"]
mod camera_fisheye;
#[path = "pose/camera_guess.rs"]
mod camera_guess;
#[path = "pose/camera_projection.rs"]
mod camera_projection;
#[path = "pose/camera_ray.rs"]
mod camera_ray;
#[path = "pose/camera_yaml.rs"]
mod camera_yaml;
#[path = "pose/locate_diagnosis.rs"]
mod locate_diagnosis;
#[path = "pose/locate_uncertainty.rs"]
mod locate_uncertainty;
#[path = "pose/scene_bins.rs"]
mod scene_bins;
#[path = "pose/scene_classes.rs"]
mod scene_classes;
#[path = "pose/scene_file.rs"]
mod scene_file;
#[path = "pose/scene_model.rs"]
mod scene_model;
#[path = "pose/scene_viewpoint.rs"]
mod scene_viewpoint;
#[path = "pose/scene_write.rs"]
mod scene_write;
#[path = "pose/solvers.rs"]
mod solvers;
#[path = "pose/tags_border.rs"]
mod tags_border;
#[path = "pose/tags_homography.rs"]
mod tags_homography;
#[path = "pose/tags_image.rs"]
mod tags_image;
#[path = "pose/tags_inset.rs"]
mod tags_inset;
#[path = "pose/tags_markers.rs"]
mod tags_markers;
#[path = "pose/tags_search.rs"]
mod tags_search;
