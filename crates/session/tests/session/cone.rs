use nalgebra::Point3;
use proptest::prelude::*;
use scaleproof_session::envelope::cone::part_inside;

#[test]
fn a_line_through_the_camera_s_plane_is_cut_at_the_cone() {
    let (a, b) = (Point3::new(1.0, 0.0, 2.0), Point3::new(1.0, 0.0, -2.0));
    let [p, q] = part_inside(&a, &b, 2.0).unwrap();
    // x = 1 meets x = 2 z at z = 0.5.
    assert!((p[0] - 0.5).abs() < 1e-12 && (q[0] - 2.0).abs() < 1e-9);
    assert_eq!(part_inside(&b, &Point3::new(0.0, 1.0, -3.0), 2.0), None);
}

proptest! {
    /// Against a walk along the segment.
    #[test]
    fn the_part_is_what_a_walk_finds(a in prop::array::uniform3(-3.0..3.0_f64), b in prop::array::uniform3(-3.0..3.0_f64)) {
        let (a, b) = (Point3::from(a), Point3::from(b));
        let part = part_inside(&a, &b, 1.5);
        let walk = (0..=400).map(|i| a + (b - a) * (f64::from(i) / 400.0));
        let seen: Vec<_> = walk.filter(|p| p.z > 0.0 && p.x.hypot(p.y) <= 1.5 * p.z).collect();
        match part {
            None => prop_assert!(seen.len() <= 1, "{} points", seen.len()),
            Some([p, q]) => for s in seen {
                let (x, y) = (s.x / s.z, s.y / s.z);
                let slack = |i: usize, v: f64| v >= p[i].min(q[i]) - 1e-6 && v <= p[i].max(q[i]) + 1e-6;
                prop_assert!(slack(0, x) && slack(1, y), "{x} {y} is not in {p:?} {q:?}");
            }
        }
    }
}
