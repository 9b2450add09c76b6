//! What the model hides.

use nalgebra::Point3;
use scaleproof_pose::scene::{Envelope, ScaleModel};

#[test]
fn the_model_hides_what_is_behind_it_and_nothing_beside_or_on_it() {
    let model = ScaleModel {
        name: "m".to_owned(),
        scale: 10.0,
        class: "car".parse().unwrap(),
        size_mm: [455.0, 186.0, 128.0],
        envelope: Envelope::Box,
        mesh: Default::default(),
    };
    let hides = |point, grown_mm| model.hides(point, Point3::new(900.0, 0.0, 200.0), grown_mm);
    assert!(hides(Point3::new(-300.0, 0.0, 0.0), -1.0));
    assert!(!hides(Point3::new(300.0, 0.0, 0.0), -1.0));
    assert!(!hides(Point3::new(-300.0, 400.0, 0.0), -1.0));
    assert!(!hides(Point3::new(0.0, 0.0, 128.0), -1.0));
    assert!(hides(Point3::new(0.0, 0.0, 128.0), 20.0));
}
