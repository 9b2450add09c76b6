//! Numbers that every YAML reader takes.

use scaleproof_pose::camera::yaml::list;

#[test]
fn numbers_have_a_point_and_a_signed_exponent() {
    assert_eq!(
        list(&[1180.0, 1e-7, -2.5e-9, 1e20, 0.1]),
        "1180.0, 1.0e-7, -2.5e-9, 1.0e+20, 0.1"
    );
}
