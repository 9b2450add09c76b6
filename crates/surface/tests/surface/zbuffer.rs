//! Nearest triangles at the pixels of a window.

use proptest::prelude::*;
use scaleproof_surface::zbuffer::ZBuffer;

const WHOLE: [[f64; 2]; 3] = [[-100.0, -100.0], [100.0, -100.0], [0.0, 200.0]];

#[test]
fn the_first_of_equally_near_triangles_stays() {
    let mut buffer = ZBuffer::new(-2..4, 1..3, 0.0);
    for (name, depth) in [('a', 5.0), ('b', 3.0), ('c', 3.0), ('d', 4.0)] {
        buffer.draw(WHOLE, |_| depth, |_| name);
    }
    assert_eq!(buffer.pixels().len(), 12);
    let nearest = buffer.at(-2, 2).unwrap();
    assert_eq!((nearest.depth, nearest.item), (3.0, 'b'));
    assert!(buffer.at(4, 2).is_none() && buffer.at(0, 0).is_none());
}

#[test]
fn a_pixel_is_covered_by_its_centre() {
    let half = [[0.4, 0.0], [10.0, 0.0], [0.4, 10.0]];
    let covers_first = |centre: f64| {
        let mut buffer = ZBuffer::new(0..4, 0..4, centre);
        buffer.draw(half, |_| 1.0, |_| ());
        buffer.at(0, 1).is_some()
    };
    assert!(covers_first(0.5) && !covers_first(0.0));
}

proptest! {
    #[test]
    fn every_pixel_has_the_smallest_depth(depths in prop::collection::vec(-50.0_f64..50.0, 1..8)) {
        let mut buffer = ZBuffer::new(0..3, -1..2, 0.0);
        for (i, depth) in depths.iter().enumerate() {
            buffer.draw(WHOLE, |shares| shares.iter().sum::<f64>() * depth, |_| i);
        }
        let least = depths.iter().copied().fold(f64::INFINITY, f64::min);
        for pixel in buffer.pixels() {
            prop_assert!((pixel.unwrap().depth - least).abs() < 1e-9);
        }
    }
}
