//! Where a viewpoint stands on the dial.

use scaleproof_capture::page::dial::DialRings;
use scaleproof_pose::scene::{Bin, Viewpoint};

fn view(distance_mm: f64) -> Viewpoint {
    Viewpoint {
        azimuth_deg: 0.0,
        pitch_deg: 0.0,
        distance_mm,
    }
}

fn rings(distances: &[f64]) -> DialRings {
    let bin = |distance_mm: &f64| Bin {
        azimuth_deg: 0.0,
        pitch_deg: 0.0,
        distance_mm: *distance_mm,
    };
    DialRings::of_bins(&distances.iter().map(bin).collect::<Vec<_>>())
}

#[test]
fn nearer_is_further_in_and_a_ring_s_distance_is_its_middle() {
    let rings = rings(&[2000.0, 1000.0]);
    assert_eq!([rings.0[0].distance_mm, rings.0[1].distance_mm], [1000.0, 2000.0]);
    let shares = [100.0, 1000.0, 1500.0, 2000.0, 9000.0].map(|mm| rings.radius_share(&view(mm)));
    let wanted = [0.15, 0.565, 0.71, 0.855, 1.08];
    for (share, wanted) in shares.iter().zip(wanted) {
        assert!((share - wanted).abs() < 1e-9, "{shares:?}");
    }
}

#[test]
fn rings_of_one_distance_over_ground_divide_by_no_zero() {
    let bins = [-20.0, 20.0].map(|pitch_deg| Bin {
        azimuth_deg: 0.0,
        pitch_deg,
        distance_mm: 800.0,
    });
    let rings = DialRings::of_bins(&bins);
    assert_eq!(rings.0.len(), 2);
    assert!((0.15..=1.08).contains(&rings.radius_share(&view(800.0))));
}
