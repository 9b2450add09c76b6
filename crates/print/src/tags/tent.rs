//! Tent cards: the pairs of tags that share one back to back, and how it is cut and folded. Geometry only.
//!
//! *Tent frame*: origin on the ground under the middle of the ridge; x along the ridge, z up; face A looks towards −y.
//! *Flat frame*: the card before folding, printed side up: x along the ridge, y from the tab over face A, the ridge, face B to
//! the end of the base; origin at the corner where the tab begins. Millimetres in both.
use nalgebra::Isometry3;
use nalgebra::{Matrix3, Point2, Point3, UnitQuaternion, Vector2, Vector3};

use crate::shapes::{OutlineMm, stroke};
use scaleproof_core::geometry::{Rigid, rigid};
use scaleproof_pose::scene::Tag;

/// Maximum deviation of two tags from each other's mirror image for sharing a card: half of a scene's tolerance.
const MIRROR_MM: f64 = 0.1;
const MIRROR_DEG: f64 = 0.1;
/// Tilts at which a card stands.
pub const TILT_DEG: std::ops::RangeInclusive<f64> = 20.0..=80.0;
/// Tolerance of the room for a tag, for the rounding of scene files.
const FIT_MM: f64 = 0.05;
/// Width beside the tag, for its id and up mark.
pub const SIDE_MM: f64 = 12.0;
const TAB_MM: f64 = 12.0;
/// Slant of the tab's ends, so that it slides in.
const TAB_SLANT_MM: f64 = 5.0;

/// Length and width of the mark on the ground at the middle of a foot.
const MIDDLE_MM: f64 = 5.0;
const MIDDLE_LINE_MM: f64 = 0.4;

/// Indices of the faces among the panels of a card: tab, face A, face B, base.
pub const FACE_A: usize = 1;
pub const FACE_B: usize = 2;

/// Two tags that lean back to back on one folded card.
#[derive(Debug, Clone, PartialEq)]
pub struct Tent {
    /// Tags on face A and face B.
    pub tags: [Tag; 2],
    /// Pose of the card, `T_model_tent`.
    pub place: Rigid,
    /// Angle between each face and the ground.
    pub tilt_deg: f64,
    /// Width along the ridge.
    pub width_mm: f64,
    /// Length of a face from its foot to the ridge.
    pub face_mm: f64,
    /// Distance between the feet.
    pub base_mm: f64,
}

impl Tent {
    /// Returns the card for two tags, if they fit on one: their planes are mirror images in an upright plane, they face away from it and up, they
    /// have the same height and position along the ridge, and each fits with its white ring between the ground and the ridge, where the planes meet.
    pub fn new(a: &Tag, b: &Tag) -> Option<Tent> {
        let [normal_a, normal_b] = [a, b].map(|tag| tag.right.cross(&tag.up));
        let level = Vector3::new(normal_a.x - normal_b.x, normal_a.y - normal_b.y, 0.0);
        // Horizontal direction out of face A.
        let out = level.try_normalize(1e-6)?;
        let mirrored = normal_a - out * (2.0 * normal_a.dot(&out));
        if mirrored.angle(&normal_b) > MIRROR_DEG.to_radians() {
            return None;
        }
        // Sine and cosine of the tilt.
        let (sin, cos) = (level.norm() / 2.0, (normal_a.z + normal_b.z) / 2.0);
        let tilt_deg = sin.atan2(cos).to_degrees();
        if !TILT_DEG.contains(&tilt_deg) {
            return None;
        }
        let apart = a.centre_mm - b.centre_mm;
        let across_mm = apart.dot(&out);
        if across_mm <= 0.0 || (apart - out * across_mm).amax() > MIRROR_MM {
            return None;
        }
        let middle = (a.centre_mm.coords + b.centre_mm.coords) / 2.0;
        // Right-hand direction for an observer who looks at face A.
        let ridge = Vector3::z().cross(&out);
        // Lengths along a face, from the tags' centres down to the ground and up to the ridge.
        let (below_mm, above_mm) = (middle.z / sin, across_mm / 2.0 / cos);
        let mut width_mm = 0.0_f64;
        for (tag, out) in [(a, out), (b, -out)] {
            let slope = Vector3::z() * sin - out * cos;
            if half_along(tag, &slope) > below_mm.min(above_mm) + FIT_MM {
                return None;
            }
            width_mm = width_mm.max(2.0 * half_along(tag, &ridge));
        }
        let face_mm = below_mm + above_mm;
        let under_ridge = Vector3::new(middle.x, middle.y, 0.0);
        Some(Tent {
            tags: [a.clone(), b.clone()],
            place: rigid::from_matrix(Matrix3::from_columns(&[ridge, -out, Vector3::z()]), under_ridge),
            tilt_deg,
            width_mm: width_mm + 2.0 * SIDE_MM,
            face_mm,
            base_mm: 2.0 * face_mm * cos,
        })
    }

    pub fn net(&self) -> Net {
        let tab_mm = TAB_MM.min(0.8 * self.base_mm);
        let ends = [0.0, tab_mm, tab_mm + self.face_mm, tab_mm + 2.0 * self.face_mm];
        let top = ends[3] + self.base_mm;
        let slant = TAB_SLANT_MM.min(0.25 * self.width_mm);
        let folds = [180.0 - self.tilt_deg, 2.0 * self.tilt_deg, 180.0 - self.tilt_deg];
        let mut net = Net {
            width_mm: self.width_mm,
            height_mm: top,
            tab: [
                [slant, 0.0],
                [self.width_mm - slant, 0.0],
                [self.width_mm, tab_mm],
                [0.0, tab_mm],
            ],
            folds: [0, 1, 2].map(|i| Fold {
                y_mm: ends[i + 1],
                turn_deg: folds[i],
            }),
            tags: Vec::new(),
        };
        let panels = net.folded_panels(self);
        for (tag, panel) in self.tags.iter().zip([FACE_A, FACE_B]) {
            net.tags.push(FlatTag::on(panel, tag, &(self.place * panels[panel])));
        }
        net
    }

    /// Returns the four corners of the base on the ground, model frame: the left and the right foot of face A, then of face B.
    pub fn foot_mm(&self) -> [Point3<f64>; 4] {
        let (x, y) = (self.width_mm / 2.0, self.base_mm / 2.0);
        [[-x, -y], [x, -y], [x, y], [-x, y]].map(|[x, y]| self.place * Point3::new(x, y, 0.0))
    }

    /// Returns a short line on the ground at the middle of each foot, which leads away from the card and continues the mark at the foot of its face.
    pub fn middle_marks(&self) -> [OutlineMm; 2] {
        let at = |y: f64| {
            let place = self.place * Point3::new(0.0, y, 0.0);
            [place.x, place.y]
        };
        let (foot, end) = (self.base_mm / 2.0, self.base_mm / 2.0 + MIDDLE_MM);
        [-1.0, 1.0].map(|side| stroke(at(side * foot), at(side * end), MIDDLE_LINE_MM))
    }
}

/// Returns the extent of a tag with its white ring from its centre along a direction in its plane.
fn half_along(tag: &Tag, axis: &Vector3<f64>) -> f64 {
    let half = tag.size_mm * tag.family.width_with_white() / 2.0;
    half * (tag.right.dot(axis).abs() + tag.up.dot(axis).abs())
}

/// Card before folding, in the flat frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Net {
    pub width_mm: f64,
    pub height_mm: f64,
    /// Corners (x, y) of the tab; face A, face B and the base are as wide as the card.
    pub tab: [[f64; 2]; 4],
    /// Folds between tab, face A, face B and base.
    pub folds: [Fold; 3],
    /// Tags on face A and face B.
    pub tags: Vec<FlatTag>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fold {
    pub y_mm: f64,
    /// Angle by which the rest of the card is folded away from an observer of the printed side; 0 leaves it flat.
    pub turn_deg: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct FlatTag {
    /// Panel: [`FACE_A`] or [`FACE_B`].
    pub panel: usize,
    pub tag: Tag,
    pub centre_mm: Point2<f64>,
    pub right: Vector2<f64>,
}

impl FlatTag {
    /// Returns a scene's tag in the flat frame; `placed` is the pose of its folded panel (model ← flat).
    fn on(panel: usize, tag: &Tag, placed: &Rigid) -> Self {
        let centre = placed.inverse() * tag.centre_mm;
        let right = (placed.rotation.inverse() * tag.right).xy();
        Self {
            panel,
            tag: tag.clone(),
            centre_mm: Point2::new(centre.x, centre.y),
            right: right.normalize(),
        }
    }

    /// Returns `T_flat_tag`.
    fn pose(&self) -> Rigid {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.right.y.atan2(self.right.x));
        Isometry3::from_parts(self.centre_mm.coords.push(0.0).into(), turn)
    }
}

impl Net {
    /// Folds the card and returns each tag's pose: `T_tent_tag`, in the order of [`Net::tags`].
    pub fn folded(&self, tent: &Tent) -> Vec<Rigid> {
        let panels = self.folded_panels(tent);
        self.tags.iter().map(|flat| panels[flat.panel] * flat.pose()).collect()
    }

    /// Returns `T_tent_flat` of each panel: the base lies on the ground, and every fold rotates the panels beyond it.
    pub fn folded_panels(&self, tent: &Tent) -> [Rigid; 4] {
        // The base's printed side is down, and its fold lies at the foot of face B.
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let fold = Vector3::new(-self.width_mm / 2.0, tent.base_mm / 2.0 + self.folds[2].y_mm, 0.0);
        let base = Rigid::from_parts(fold.into(), down);
        let face_b = base * self.folds[2].before();
        let face_a = face_b * self.folds[1].before();
        [face_a * self.folds[0].before(), face_a, face_b, base]
    }
}

impl Fold {
    /// Returns the motion of the panels before the fold (smaller y), with those beyond it fixed.
    fn before(&self) -> Rigid {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.turn_deg.to_radians());
        let line = Vector3::new(0.0, self.y_mm, 0.0);
        Rigid::from_parts((line - turn * line).into(), turn)
    }
}
