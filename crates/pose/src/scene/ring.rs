//! Preset `ring`: tags in a circle around the model, so that from every direction some are visible that are not parallel.

use nalgebra::{Point3, Vector3};

use super::file::{check_tag_count, checked_bins, checked_scale};
use super::{Bins, ScaleModel, Scene, Tag, TagFamily};
use scaleproof_core::geometry::length::{shown, size_mm};
use scaleproof_core::message::{Message, bail, message};

/// Margin between a tag's white ring and the ground or the ridge of its card.
const CARD_MARGIN_MM: f64 = 2.0;
/// Margin beside the tag on a tent card; the printed card is a little narrower.
const CARD_SIDE_MM: f64 = 15.0;
/// Minimum gap between a row of flat tags and the model, and between neighbouring tags.
const ROW_GAP_MM: f64 = 5.0;
/// Tilts at which a card stands.
const TILT_DEG: std::ops::RangeInclusive<f64> = 30.0..=75.0;
const FEWEST: u32 = 3;

/// Ring of `count` tent cards at equal angles, the first before the model's front, and as many flat tags: in a row along each side of the model, so
/// that few sheets carry them all; or, if the ring leaves no room for rows, half way between neighbouring cards.
#[derive(Debug, Clone, PartialEq)]
pub struct TagRing {
    pub model: ScaleModel,
    pub bins: Bins,
    /// Radius of the circle of the cards.
    pub radius_mm: f64,
    /// Number of tent cards, and of flat tags.
    pub count: u32,
    /// Outer edge of a tag's black border.
    pub tag_mm: f64,
    pub family: TagFamily,
    /// Angle between a tent card's faces and the ground.
    pub tilt_deg: f64,
}

impl TagRing {
    /// Lays the ring out. Ids: the flat tags from 0, counter-clockwise from the first after the front; then two for each tent
    /// card, the outer face first.
    pub fn scene(&self) -> Result<Scene, Message> {
        self.check()?;
        let bins = checked_bins(self.bins.clone())?;
        let step_deg = 360.0 / f64::from(self.count);
        let around = |i: u32| {
            let out = outwards((f64::from(i) + 0.5) * step_deg);
            (out * self.radius_mm, out)
        };
        let places = self.rows().unwrap_or_else(|| (0..self.count).map(around).collect());
        let flat = (0..)
            .zip(places)
            .map(|(id, (at, up))| self.tag(id, at, up, Vector3::z()));
        let tents = (0..self.count).flat_map(|i| self.tent_tags(self.count + 2 * i, f64::from(i) * step_deg));
        Ok(Scene {
            model: self.model.clone(),
            bins,
            tags: flat.chain(tents).collect(),
        })
    }

    fn check(&self) -> Result<(), Message> {
        let [length, width, height] = self.model.size_mm;
        size_mm("radius", self.radius_mm)?;
        size_mm("tag size", self.tag_mm)?;
        size_mm("model length", length)?;
        size_mm("model width", width)?;
        size_mm("model height", height)?;
        checked_scale(self.model.scale)?;
        let tilt_deg = self.tilt_deg;
        if !TILT_DEG.contains(&tilt_deg) {
            bail!(
                "faces at {}° do not make a card that stands; give 30 to 75",
                shown(tilt_deg)
            );
        }
        let (ids, needed) = (self.family.count(), 3 * u64::from(self.count));
        if self.count < FEWEST || needed > u64::from(ids) {
            bail!(
                "a ring of {count} has {needed} tags and the family has {ids}; give {FEWEST} to {most}, or a larger family",
                count = self.count,
                most = ids / 3
            );
        }
        check_tag_count(needed)?;
        self.check_room(length.hypot(width) / 2.0)
    }

    /// Returns an error if cards could overlap in any orientation.
    fn check_room(&self, model_mm: f64) -> Result<(), Message> {
        let flat_mm = self.with_white_mm() / 2.0 * std::f64::consts::SQRT_2;
        let tent_mm = self.card_reach_mm();
        let neighbours = (90.0 / f64::from(self.count)).to_radians().sin();
        let (beside_model, in_ring) = (model_mm + tent_mm.max(flat_mm), (tent_mm + flat_mm) / 2.0 / neighbours);
        let (reason, least_mm) = if self.radius_mm < beside_model {
            ("the model and the cards around it need", beside_model)
        } else {
            ("so many cards of this size need", in_ring)
        };
        if self.radius_mm >= least_mm {
            return Ok(());
        }
        Err(message!(
            "a radius of {radius_mm} mm is too small: {reason} at least {least_mm:.0} mm",
            radius_mm = self.radius_mm,
            least_mm = least_mm.ceil()
        ))
    }

    fn with_white_mm(&self) -> f64 {
        self.tag_mm * self.family.width_with_white()
    }

    fn face_mm(&self) -> f64 {
        self.with_white_mm() + 2.0 * CARD_MARGIN_MM
    }

    /// Returns centres and tops of the flat tags in a row on the left from front to rear, and one on the right back to the front. A row stands a
    /// tag's size off the model, where it hides few of them, or nearer if the cards need the room.
    fn rows(&self) -> Option<Vec<(Vector3<f64>, Vector3<f64>)>> {
        let [length, width, _] = self.model.size_mm;
        let half = self.with_white_mm() / 2.0;
        let left = self.count.div_ceil(2);
        let apart = length / f64::from(left);
        let outmost = (length - apart) / 2.0 + half;
        // Everything within this radius is clear of every card in any orientation.
        let free = self.radius_mm - self.card_reach_mm();
        let reach = (free > outmost).then(|| (free * free - outmost * outmost).sqrt())?;
        let gap = self.tag_mm.min(reach - width / 2.0 - 2.0 * half);
        if gap < ROW_GAP_MM || apart < 2.0 * half + ROW_GAP_MM {
            return None;
        }
        let row = |count: u32, side: f64| {
            let up = Vector3::y() * side;
            let at = move |i: u32| {
                let along = (f64::from(i) + 0.5) / f64::from(count) - 0.5;
                Vector3::x() * (-side * length * along) + up * (width / 2.0 + gap + half)
            };
            (0..count).map(move |i| (at(i), up)).collect::<Vec<_>>()
        };
        Some([row(left, 1.0), row(self.count - left, -1.0)].concat())
    }

    /// Returns the distance from the middle of a tent card to its farthest corner.
    fn card_reach_mm(&self) -> f64 {
        let foot_mm = self.face_mm() * self.tilt_deg.to_radians().cos();
        foot_mm.hypot(self.with_white_mm() / 2.0 + CARD_SIDE_MM)
    }

    /// Returns the upright tags on the two faces of a card whose ridge is tangential to the ring.
    fn tent_tags(&self, first_id: u32, azimuth_deg: f64) -> [Tag; 2] {
        let (sin, cos) = self.tilt_deg.to_radians().sin_cos();
        let out = outwards(azimuth_deg);
        let half = self.face_mm() / 2.0;
        [(first_id, out), (first_id + 1, -out)].map(|(id, to)| {
            let centre = out * self.radius_mm + to * (half * cos) + Vector3::z() * (half * sin);
            self.tag(id, centre, Vector3::z() * sin - to * cos, to * sin + Vector3::z() * cos)
        })
    }

    fn tag(&self, id: u32, centre: Vector3<f64>, up: Vector3<f64>, normal: Vector3<f64>) -> Tag {
        Tag {
            id,
            family: self.family,
            size_mm: self.tag_mm,
            centre_mm: Point3::from(centre),
            right: up.cross(&normal),
            up,
            sigma: None,
        }
    }
}

fn outwards(azimuth_deg: f64) -> Vector3<f64> {
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    Vector3::new(cos, sin, 0.0)
}
