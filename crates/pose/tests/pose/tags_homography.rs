//! A tag's outline as a map.

use scaleproof_pose::tags::TagHomography;

#[test]
fn the_map_hits_its_corners() {
    let corners = [[10.0, 12.0], [50.0, 9.0], [61.0, 44.0], [4.0, 70.0]];
    let homography = TagHomography::to(&corners);
    for (corner, (u, v)) in corners.iter().zip([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]) {
        let [x, y] = homography.pixel(u, v);
        assert!((x - corner[0]).abs() < 1e-9 && (y - corner[1]).abs() < 1e-9);
    }
}
