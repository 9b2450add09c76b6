//! The shift that all tag edges share.

use scaleproof_rig::survey::outwards;

#[test]
fn every_side_moves_out_by_the_same() {
    let square = [[10.0, 10.0], [50.0, 10.0], [50.0, 50.0], [10.0, 50.0]];
    let larger = [[9.0, 9.0], [51.0, 9.0], [51.0, 51.0], [9.0, 51.0]];
    let near = |a: [[f64; 2]; 4], b: [[f64; 2]; 4]| {
        a.iter()
            .flatten()
            .zip(b.iter().flatten())
            .all(|(a, b)| (a - b).abs() < 1e-12)
    };
    assert!(near(outwards(&square, 1.0), larger));
    let mirrored = |c: [[f64; 2]; 4]| c.map(|[x, y]| [-x, y]);
    assert!(near(outwards(&mirrored(square), 1.0), mirrored(larger)));
    // A slanted quadrilateral: the distance between old and new sides, by the point-to-line formula.
    let slanted = [[10.0, 12.0], [60.0, 5.0], [55.0, 40.0], [8.0, 33.0]];
    let moved = outwards(&slanted, 0.5);
    for i in 0..4 {
        let ([ax, ay], [bx, by], [px, py]) = (slanted[i], slanted[(i + 1) % 4], moved[i]);
        let off = ((bx - ax) * (py - ay) - (by - ay) * (px - ax)) / (bx - ax).hypot(by - ay);
        assert!((off.abs() - 0.5).abs() < 1e-9, "side {i}: {off}");
        assert!(off < 0.0, "inside is to the right of a side, so out is negative");
    }
}
