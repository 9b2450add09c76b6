//! Folds a printed tent card by what is on the paper: its dashed lines and its outline. Nothing is taken from the program's own
//! fold geometry; the angles are those of a triangle with the panels' lengths as sides.

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use scaleproof_pose::scene::{Bins, Envelope, ScaleModel, Scene, Tag, TagFamily, corners_in_tag_mm};
use scaleproof_print::sheet::{Line, Mark, Sheet};
use scaleproof_print::tags::arrange;

use super::paper::Mm;

/// One card on a sheet, by its printed lines (page frame, mm).
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    left: f64,
    right: f64,
    /// Foot of face A, ridge, foot of face B.
    folds: [f64; 3],
    /// End of the base.
    top: f64,
}

impl Card {
    /// The cards of a sheet: sets of three level dashed lines of one length, and the cut line above them.
    pub fn on(sheet: &Sheet) -> Vec<Card> {
        let mut level: Vec<(f64, f64, f64, bool)> = Vec::new();
        for mark in &sheet.marks {
            if let Mark::Line(Line { from, to, dash_mm, .. }) = mark
                && from[1] == to[1]
                && sheet.trim.left_mm < 6.0
            {
                let ends = (from[0].min(to[0]), from[0].max(to[0]));
                level.push((ends.0, ends.1, from[1], dash_mm.is_some()));
            }
        }
        let mut cards = Vec::new();
        for foot in level.iter().filter(|line| line.3) {
            let same = |line: &&(f64, f64, f64, bool)| (line.0 - foot.0).abs() < 1e-6 && (line.1 - foot.1).abs() < 1e-6;
            let mut folds: Vec<f64> = level
                .iter()
                .filter(same)
                .filter(|line| line.3)
                .map(|line| line.2)
                .collect();
            folds.sort_by(f64::total_cmp);
            // Cards one above the other are told apart by the lowest line: three folds each.
            let Some(place) = folds.iter().position(|y| *y == foot.2) else {
                continue;
            };
            if place % 3 != 0 {
                continue;
            }
            let above = level
                .iter()
                .filter(same)
                .filter(|line| !line.3 && line.2 > folds[place + 2])
                .map(|line| line.2);
            cards.push(Card {
                left: foot.0,
                right: foot.1,
                folds: [folds[place], folds[place + 1], folds[place + 2]],
                top: above.fold(f64::INFINITY, f64::min),
            });
        }
        cards
    }

    pub fn holds(&self, corners: &[Mm; 4]) -> bool {
        let inside = |[x, y]: &Mm| (self.left..self.right).contains(x) && (self.folds[0]..self.folds[2]).contains(y);
        corners.iter().all(inside)
    }

    /// Where points of the faces come to stand once the card is folded and its base stands on `feet`: the left and right foot
    /// of face A, then the right and left foot of face B.
    pub fn folded(&self, points: &[Mm; 4], feet: &[Point3<f64>; 4]) -> [Point3<f64>; 4] {
        let [a, b] = [self.folds[1] - self.folds[0], self.folds[2] - self.folds[1]];
        let base = self.top - self.folds[2];
        let along = (feet[1] - feet[0]).normalize();
        let inwards = (feet[3] - feet[0]).normalize();
        assert!(
            ((feet[1] - feet[0]).norm() - (self.right - self.left)).abs() < 0.01,
            "the outline is as wide as the card"
        );
        assert!(
            ((feet[3] - feet[0]).norm() - base).abs() < 0.01,
            "the outline is as deep as the base"
        );
        // Law of cosines: the ridge over the line from foot to foot.
        let forward = (a * a + base * base - b * b) / (2.0 * base);
        let ridge = inwards * forward + Vector3::z() * (a * a - forward * forward).sqrt();
        points.map(|[x, y]| {
            let on_ridge = feet[0] + along * (x - self.left) + ridge;
            if y < self.folds[1] {
                on_ridge - ridge * ((self.folds[1] - y) / a)
            } else {
                on_ridge + (inwards * base - ridge) * ((y - self.folds[1]) / b)
            }
        })
    }
}

/// How far four corners are from a tag's place in the scene: the farther of the centre and the corners in mm, and the larger of
/// the turns of right and normal in degrees.
pub fn off(corners: &[Point3<f64>; 4], tag: &Tag) -> (f64, f64) {
    let told = tag.corners_mm();
    let mm = corners
        .iter()
        .zip(&told)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    let axes = |c: &[Point3<f64>; 4]| {
        let right = (c[1] - c[0]) + (c[2] - c[3]);
        let up = (c[0] - c[3]) + (c[1] - c[2]);
        (right, right.cross(&up))
    };
    let ((right, normal), (told_right, told_normal)) = (axes(corners), axes(&told));
    (
        mm,
        right.angle(&told_right).max(normal.angle(&told_normal)).to_degrees(),
    )
}

/// Two tags that lean back to back, each turned in its plane, somewhere.
fn pair(tilt_deg: f64, ridge_deg: f64, turns: [f64; 2], sizes: [f64; 2], rooms: [f64; 2], at: [f64; 2]) -> Scene {
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    let (s, c) = ridge_deg.to_radians().sin_cos();
    let out = Vector3::new(c, s, 0.0);
    // A tag's white ring turned by 45° reaches 0.89 of its size from the centre.
    let largest = sizes[0].max(sizes[1]);
    let (below, above) = (0.89 * largest + rooms[0], 0.89 * largest + rooms[1]);
    let tag = |id: u32, to: Vector3<f64>, turn: f64| {
        let (slope, normal) = (Vector3::z() * sin - to * cos, to * sin + Vector3::z() * cos);
        let level = slope.cross(&normal);
        let (ts, tc) = turn.to_radians().sin_cos();
        Tag {
            id,
            family: TagFamily::Tag36h11,
            size_mm: sizes[id as usize],
            centre_mm: Point3::new(at[0], at[1], 0.0) + to * (above * cos) + Vector3::z() * (below * sin),
            right: level * tc + slope * ts,
            up: slope * tc - level * ts,
            sigma: None,
        }
    };
    Scene {
        model: ScaleModel {
            name: "m".into(),
            scale: 10.0,
            class: "car".parse().unwrap(),
            size_mm: [100.0, 50.0, 40.0],
            envelope: Envelope::Box,
            mesh: Default::default(),
        },
        bins: Bins {
            azimuth_deg: 45.0,
            pitch_deg: vec![0.0],
            distance_mm: vec![500.0],
        },
        tags: vec![tag(0, out, turns[0]), tag(1, -out, turns[1])],
    }
}

proptest! {
    /// Any two tags back to back make a card that folds to them, by the program's rigid transforms and by the triangle above;
    /// also when the scene went through a file.
    #[test]
    fn every_card_folds_to_its_tags(
        tilt_deg in 20.5..79.5_f64,
        ridge_deg in 0.0..360.0_f64,
        turns in prop::array::uniform2(0.0..360.0_f64),
        sizes in prop::array::uniform2(10.0..90.0_f64),
        rooms in prop::array::uniform2(0.1..30.0_f64),
        at in prop::array::uniform2(-500.0..500.0_f64),
    ) {
        let scene = pair(tilt_deg, ridge_deg, turns, sizes, rooms, at);
        let read = Scene::parse(&scene.to_toml(), std::path::Path::new("s.toml")).unwrap();
        for (scene, allowed_mm) in [(&scene, 1e-6), (&read, 0.02)] {
            let arrangement = arrange(scene);
            prop_assert_eq!(arrangement.tents.len(), 1);
            let tent = &arrangement.tents[0];
            let net = tent.net();
            let card = Card {
                left: 0.0,
                right: net.width_mm,
                folds: net.folds.map(|fold| fold.y_mm),
                top: net.height_mm,
            };
            for (flat, pose) in net.tags.iter().zip(net.folded(tent)) {
                let told = scene.tag(flat.tag.family, flat.tag.id).unwrap();
                let up = nalgebra::Vector2::new(-flat.right.y, flat.right.x);
                let corner = |p: Point3<f64>| flat.centre_mm + flat.right * p.x + up * p.y;
                let corners = corners_in_tag_mm(told.size_mm).map(|p| corner(p).coords.into());
                prop_assert!(card.holds(&corners), "a tag leaves its card");
                let by_triangle = off(&card.folded(&corners, &tent.foot_mm()), told);
                let by_transforms = off(&corners_in_tag_mm(told.size_mm).map(|p| tent.place * pose * p), told);
                for (mm, deg) in [by_triangle, by_transforms] {
                    prop_assert!(mm < allowed_mm && deg < 0.01, "{mm} mm, {deg}°");
                }
            }
            // The tab, folded with the rest, lies on the base.
            let tab = net.folded_panels(tent)[0];
            for [x, y] in &net.tab {
                let end = tab * Point3::new(*x, *y, 0.0);
                prop_assert!(end.z.abs() < 1e-6 && end.y.abs() < tent.base_mm / 2.0 + 1e-6, "{end}");
            }
        }
    }

    /// Two tags that are not each other's mirror image stand on their own.
    #[test]
    fn a_pair_that_does_not_meet_makes_plain_cards(
        tilt_deg in 20.5..79.5_f64,
        ridge_deg in 0.0..360.0_f64,
        wrong in 0_usize..4,
    ) {
        let mut scene = pair(tilt_deg, ridge_deg, [0.0, 0.0], [50.0, 50.0], [5.0, 5.0], [0.0, 0.0]);
        let tag = &mut scene.tags[1];
        match wrong {
            0 => tag.centre_mm.z += 0.3,
            1 => tag.centre_mm += tag.right * 0.3,
            2 => {
                let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(tag.right), 0.006);
                tag.up = turn * tag.up;
            }
            _ => tag.size_mm = 80.0,
        }
        let arrangement = arrange(&scene);
        prop_assert_eq!((arrangement.tents.len(), arrangement.cards.len()), (0, 2));
    }
}
