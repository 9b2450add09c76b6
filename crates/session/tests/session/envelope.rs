use nalgebra::{Matrix3, Vector3};
use scaleproof_core::geometry::rigid;
use scaleproof_core::geometry::{BoxPx, Rigid};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Envelope, ScaleModel};
use scaleproof_session::envelope::{EnvelopeShape, NoTruth};
use scaleproof_surface::mesh::Mesh;

fn model() -> ScaleModel {
    ScaleModel {
        name: "m".into(),
        scale: 10.0,
        class: "car".parse().unwrap(),
        size_mm: [400.0, 200.0, 100.0],
        envelope: Envelope::Box,
        mesh: Default::default(),
    }
}

/// A camera on the model's left at 1100 mm, looking level at its middle; the photo moved by `shift_mm` at the model.
fn from_the_left(shift_mm: f64, distance_mm: f64) -> Rigid {
    // Camera x = -model x, camera y = -model z, camera z = -model y.
    let rotation = Matrix3::new(-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0);
    rigid::from_matrix(rotation, Vector3::new(shift_mm, 50.0, distance_mm))
}

fn camera() -> Camera {
    // The axis meets the photo's very middle.
    Camera::pinhole(1000, 800, 1000.0, 1000.0, 499.5, 399.5)
}

/// The boxes of the box itself, of its hull and of its mesh, which must be one.
fn boxes(pose: &Rigid, camera: &Camera) -> Vec<Result<[f64; 4], NoTruth>> {
    let (model, mesh) = (model(), Mesh::cuboid(model().size_mm));
    let outlines = [
        EnvelopeShape::of_box(&model),
        EnvelopeShape::hull(&mesh, &model),
        EnvelopeShape::surface(&mesh, &model),
    ];
    let rounded = |b: BoxPx| [b.x1, b.y1, b.x2, b.y2].map(|v| (v * 1000.0).round() / 1000.0);
    outlines
        .iter()
        .map(|o| o.box_in_photo(pose, camera).map(rounded))
        .collect()
}

#[test]
fn the_near_side_sets_the_box() {
    // The near side is 1000 mm away: 400 mm × 100 mm there are 400 × 100 px.
    let expected = Ok([300.0, 350.0, 700.0, 450.0]);
    assert_eq!(boxes(&from_the_left(0.0, 1100.0), &camera()), vec![expected; 3]);
}

#[test]
fn a_model_cut_by_the_border_has_the_box_of_its_visible_part() {
    // The near side's right end, at x = 700 + 400, is out of the photo; the far side starts at 500 + 200 / 1.2.
    let expected = Ok([666.667, 350.0, 1000.0, 450.0]);
    assert_eq!(boxes(&from_the_left(400.0, 1100.0), &camera()), vec![expected; 3]);
    // All of the near side is out of the photo. The end of the model leaves it at 1040 mm, where 50 mm are 48.077 px; the
    // cut box of the whole model would be 50 px to each side.
    let expected = Ok([933.333, 351.923, 1000.0, 448.077]);
    assert_eq!(boxes(&from_the_left(720.0, 1100.0), &camera()), vec![expected; 3]);
}

#[test]
fn a_model_that_fills_the_photo_has_the_photo_s_box() {
    // 20 mm before the side: 20 mm of it fill 1000 px, and no edge of it is in the photo.
    let expected = Ok([0.0, 0.0, 1000.0, 800.0]);
    assert_eq!(boxes(&from_the_left(0.0, 120.0), &camera()), vec![expected; 3]);
}

#[test]
fn a_model_outside_the_photo_has_no_box() {
    let none = vec![Err(NoTruth::OutOfPhoto); 3];
    assert_eq!(boxes(&from_the_left(5000.0, 1100.0), &camera()), none);
    let behind = boxes(&from_the_left(0.0, -1100.0), &camera());
    assert_eq!(behind[0], Err(NoTruth::OutOfPhoto));
    assert_eq!(behind[1], Err(NoTruth::BeyondCamera));
    let inside = from_the_left(0.0, 50.0);
    assert_eq!(boxes(&inside, &camera()), vec![Err(NoTruth::InsideModel); 3]);
}

/// A camera over the front end that looks along the model: part of it is behind the camera.
#[test]
fn a_model_partly_behind_the_camera_has_the_box_of_the_rest() {
    // Camera x = model y, camera y = -model z, camera z = model x turned: looks to the rear from x = 150, z = 130.
    let rotation = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0);
    let pose = rigid::from_matrix(rotation, Vector3::new(0.0, 130.0, 150.0));
    let found = boxes(&pose, &camera());
    // The roof's rear edge, 350 mm away and 30 mm below the axis; the roof reaches the photo's lower border and both sides.
    assert_eq!(found[0], Ok([0.0, 485.714, 1000.0, 800.0]));
    assert_eq!(found[0], found[2]);
    assert_eq!(
        found[1],
        Err(NoTruth::BeyondCamera),
        "a hull is drawn of what is before the camera only"
    );
}

#[test]
fn a_lens_that_ends_within_the_photo_is_no_truth() {
    // Directions beyond 1.15 do not exist: 770 px from the centre of a photo that is 1000 px to each side.
    let lens = Camera::pinhole(2000, 2000, 1000.0, 1000.0, 999.5, 999.5).with_distortion(&[-0.25]);
    let near = boxes(&from_the_left(0.0, 250.0), &lens);
    assert_eq!(near, vec![Err(NoTruth::BeyondCamera); 3]);
    assert!(boxes(&from_the_left(0.0, 1100.0), &lens).iter().all(Result::is_ok));
}
