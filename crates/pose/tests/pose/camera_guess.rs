//! A camera guessed from EXIF: the stated bound covers what makers and editors do, and what no camera has is refused.

use scaleproof_photo::Lens;
use scaleproof_pose::camera::{Camera, GuessError};

/// A camera as its maker knows it: the whole sensor's pixels, their pitch in µm, and the focal length in mm.
struct Maker {
    sensor_px: [f64; 2],
    pitch_um: f64,
    focal_mm: f64,
}

/// 4:3 of a phone's main and front cameras, 3:2 of an APS-C camera, a 16:9 action camera.
const MAKERS: [Maker; 5] = [
    Maker {
        sensor_px: [3264.0, 2448.0],
        pitch_um: 1.4,
        focal_mm: 4.28,
    },
    Maker {
        sensor_px: [4032.0, 3024.0],
        pitch_um: 1.7,
        focal_mm: 5.1,
    },
    Maker {
        sensor_px: [2592.0, 1944.0],
        pitch_um: 1.12,
        focal_mm: 2.2,
    },
    Maker {
        sensor_px: [6000.0, 4000.0],
        pitch_um: 3.9,
        focal_mm: 35.0,
    },
    Maker {
        sensor_px: [3840.0, 2160.0],
        pitch_um: 1.55,
        focal_mm: 3.0,
    },
];

impl Maker {
    /// The 35 mm equivalent by the sensor's diagonal or by its longer side, some per cent off as makers state it, in whole mm.
    fn equivalent_mm(&self, by_diagonal: bool, nominal: f64) -> f64 {
        let [w, h] = self.sensor_px.map(|px| px * self.pitch_um / 1000.0);
        let times = if by_diagonal {
            36f64.hypot(24.0) / w.hypot(h)
        } else {
            36.0 / w
        };
        (self.focal_mm * nominal * times).round()
    }

    /// The focal length in px of a photo that is the middle of the sensor in another shape, made smaller, focused at a distance.
    fn photo(&self, shape: f64, smaller: f64, focus_mm: f64) -> (u32, u32, f64) {
        let [w, h] = self.sensor_px;
        let (w, h) = if w / h > shape { (h * shape, h) } else { (w, w / shape) };
        let focal_px = self.focal_mm * 1000.0 / self.pitch_um * focus_mm / (focus_mm - self.focal_mm);
        ((w * smaller) as u32, (h * smaller) as u32, focal_px * smaller)
    }
}

#[test]
fn the_stated_bound_covers_makers_conventions_crops_to_other_shapes_and_smaller_copies() {
    let (mut all, mut widest) = (0, 0.0f64);
    for maker in &MAKERS {
        let [w, h] = maker.sensor_px;
        // The sensor's own shape, and what a phone cuts from it.
        for shape in [w / h, 16.0 / 9.0, 1.0, 20.0 / 9.0] {
            for by_diagonal in [true, false] {
                for (nominal, focus_mm) in [(1.0, 1e6), (1.02, 1e6), (0.98, 500.0), (1.0, 700.0)] {
                    for smaller in [1.0, 0.25] {
                        let (width, height, focal_px) = maker.photo(shape, smaller, focus_mm);
                        let lens = Lens {
                            equivalent_35_mm: Some(maker.equivalent_mm(by_diagonal, nominal)),
                            focal_mm: Some(maker.focal_mm),
                            ..Lens::default()
                        };
                        // What is cut from 3:2 and 16:9 has no place in the model: no such phone is known.
                        if shape != w / h && w / h != 4.0 / 3.0 {
                            continue;
                        }
                        let camera = Camera::guessed(width, height, &lens).unwrap();
                        let (off, bound) = (
                            (focal_px / camera.fx - 1.0).abs() * 100.0,
                            camera.guess.unwrap().focal_percent,
                        );
                        assert!(
                            off <= bound,
                            "{width}×{height}, {lens:?}: {off:.1} % off, stated {bound:.1} %"
                        );
                        all += 1;
                        if shape == w / h && w / h < 1.6 {
                            widest = widest.max(bound);
                        }
                    }
                }
            }
        }
    }
    println!("{all} photos covered; the widest bound of a whole sensor: {widest:.1} %");
    assert!(all > 100 && widest < 16.0);
}

/// EXIF data of a compact camera with a sensor 7.1 mm wide, of a photo 2272 px wide.
fn compact() -> Lens {
    Lens {
        focal_mm: Some(15.437),
        sensor_px_per_mm: Some(8114.29 / 25.4),
        recorded_px: Some((2272, 1704)),
        ..Lens::default()
    }
}

#[test]
fn a_smaller_copy_is_scaled_where_exif_says_so_and_refused_where_an_editor_hid_it() {
    let honest = Camera::guessed(100, 75, &compact()).unwrap();
    assert!((honest.fx - 217.06).abs() < 0.1, "{}", honest.fx);
    let hidden = |width: u32, height: u32| {
        let lens = Lens {
            recorded_px: Some((width, height)),
            ..compact()
        };
        Camera::guessed(width, height, &lens)
    };
    assert!(hidden(2272, 1704).is_ok());
    for width in [100, 320, 640, 800] {
        let refused = hidden(width, width * 3 / 4).unwrap_err();
        assert!(matches!(refused, GuessError::Sensor { .. }), "{width}: {refused}");
        assert!(refused.to_string().contains("an editor"), "{refused}");
    }
    let refused = hidden(100, 75).unwrap_err().to_string();
    assert!(refused.contains("0.31 mm wide"), "{refused}");
    // With a 35 mm equivalent, a copy half as large contradicts it.
    let half = Lens {
        equivalent_35_mm: Some(78.0),
        recorded_px: Some((1136, 852)),
        ..compact()
    };
    let refused = Camera::guessed(1136, 852, &half).unwrap_err();
    assert!(matches!(refused, GuessError::Contradiction { .. }), "{refused}");
}

#[test]
fn what_no_camera_has_is_refused() {
    let phone = Lens {
        equivalent_35_mm: Some(26.0),
        focal_mm: Some(5.1),
        ..Lens::default()
    };
    for (width, height) in [(4032, 1400), (3000, 900), (1000, 700), (1000, 590)] {
        let refused = Camera::guessed(width, height, &phone).unwrap_err();
        assert_eq!(refused, GuessError::Shape { width, height });
    }
    for (width, height) in [
        (4032, 3024),
        (3024, 4032),
        (4080, 3072),
        (6000, 4000),
        (4000, 2252),
        (1080, 2340),
        (640, 640),
        (100, 75),
    ] {
        assert!(Camera::guessed(width, height, &phone).is_ok(), "{width}×{height}");
    }
    // 5.1 m where mm are meant, and a lens of 0.01 mm.
    for focal_mm in [5100.0, 0.01] {
        let lens = Lens {
            focal_mm: Some(focal_mm),
            ..phone.clone()
        };
        let refused = Camera::guessed(4032, 3024, &lens).unwrap_err();
        assert!(matches!(refused, GuessError::Sensor { .. }), "{refused}");
    }
    // A telescope: 1000 mm on a sensor of 6 mm.
    let telescope = Lens {
        focal_mm: Some(1000.0),
        sensor_px_per_mm: Some(500.0),
        ..Lens::default()
    };
    let refused = Camera::guessed(3000, 2250, &telescope).unwrap_err();
    assert!(matches!(refused, GuessError::FieldOfView { .. }), "{refused}");
}
