//! Views with a fault or none.

use nalgebra::{Point3, Vector3};
use rand::RngExt;

use super::fault::SimulatedFault;
use super::simulator::{SimulatedView, Simulator, looking_at};
use crate::scene::{Tag, Viewpoint, corners_in_tag_mm};

impl Simulator<'_> {
    /// Returns the view from a viewpoint towards the model, with a fault or none.
    pub fn view(&mut self, viewpoint: &Viewpoint, fault: Option<SimulatedFault>) -> SimulatedView {
        let pose = looking_at(viewpoint, self.scene.model.target_mm());
        let mut view = SimulatedView {
            viewpoint: *viewpoint,
            pose,
            seen: self.seen(&pose),
            scene: self.scene.clone(),
            camera: self.camera.clone(),
            struck: None,
        };
        if let Some(fault) = fault {
            self.strike(&mut view, fault);
        }
        view
    }

    /// Applies a fault to a view. A fault of one tag changes nothing if none is seen.
    fn strike(&mut self, view: &mut SimulatedView, fault: SimulatedFault) {
        match fault {
            SimulatedFault::Hidden { share } => view.seen.retain(|_| self.rng.random::<f64>() >= share),
            SimulatedFault::Cropped { share } => {
                let edge = share * f64::from(self.camera.width);
                view.seen.retain(|tag| tag.corners_px.iter().all(|[x, _]| *x < edge));
            }
            SimulatedFault::WrongTagSize { factor } => view.scene.tags.iter_mut().for_each(|tag| tag.size_mm *= factor),
            SimulatedFault::WrongFocal { factor } => {
                view.camera.fx *= factor;
                view.camera.fy *= factor;
            }
            SimulatedFault::WrongPrincipalPoint { px } => view.camera.cx += px,
            SimulatedFault::IgnoredDistortion => view.camera = view.camera.clone().with_distortion(&[]),
            SimulatedFault::BentPaper { mm } => self.bend(view, mm),
            _ if view.seen.is_empty() => {}
            of_one_tag => {
                let at = self.rng.random_range(0..view.seen.len());
                view.struck = self.strike_tag(view, at, of_one_tag).then(|| view.seen[at].id);
            }
        }
    }

    /// Applies a fault to the tag at an index; returns false if that is impossible.
    fn strike_tag(&mut self, view: &mut SimulatedView, at: usize, fault: SimulatedFault) -> bool {
        let corners = &mut view.seen[at].corners_px;
        match fault {
            SimulatedFault::MirroredTag => *corners = [corners[1], corners[0], corners[3], corners[2]],
            SimulatedFault::WrongCorner { px } => {
                let angle: f64 = self.rng.random_range(0.0..std::f64::consts::TAU);
                let corner = &mut corners[self.rng.random_range(0..4)];
                *corner = [corner[0] + px * angle.cos(), corner[1] + px * angle.sin()];
            }
            SimulatedFault::WrongId => {
                let ids = self.scene.tags.iter().map(|t| t.id);
                let unseen: Vec<u32> = ids.filter(|id| view.seen.iter().all(|s| s.id != *id)).collect();
                if unseen.is_empty() {
                    return false;
                }
                view.seen[at].id = unseen[self.rng.random_range(0..unseen.len())];
            }
            SimulatedFault::DuplicatedId => {
                let mut copy = view.seen[at].clone();
                let by: [f64; 2] = std::array::from_fn(|_| self.rng.random_range(-200.0..200.0));
                copy.corners_px = copy.corners_px.map(|[x, y]| [x + by[0], y + by[1]]);
                view.seen.push(copy);
            }
            SimulatedFault::MovedTag { mm } => {
                let angle: f64 = self.rng.random_range(0.0..std::f64::consts::TAU);
                let shift = mm * Vector3::new(angle.cos(), angle.sin(), 0.0);
                return self.displace(view, at, |tag| tag.centre_mm += shift);
            }
            SimulatedFault::TwistedTag { deg } => {
                let (sin, cos) = deg.to_radians().sin_cos();
                let twist = |tag: &mut Tag| {
                    (tag.right, tag.up) = (cos * tag.right + sin * tag.up, cos * tag.up - sin * tag.right);
                };
                return self.displace(view, at, twist);
            }
            _ => return false,
        }
        true
    }

    /// Bends the cards of all seen tags.
    fn bend(&mut self, view: &mut SimulatedView, mm: f64) {
        let scene = self.scene;
        for seen in &mut view.seen {
            let Some(tag) = scene.tag(seen.family, seen.id) else {
                continue;
            };
            let corners = bent(tag, mm, self.rng.random_range(0.0..std::f64::consts::TAU));
            let [a, b, c, d] = corners.map(|corner| self.camera.project(&(view.pose * corner)));
            if let (Some(a), Some(b), Some(c), Some(d)) = (a, b, c, d) {
                seen.corners_px = self.noisy([a, b, c, d]);
            }
        }
    }

    /// Shifts or turns the card of a seen tag; returns false, and changes nothing, if it would then be out of sight.
    fn displace(&mut self, view: &mut SimulatedView, at: usize, by: impl FnOnce(&mut Tag)) -> bool {
        let seen = &mut view.seen[at];
        let Some(mut tag) = self.scene.tag(seen.family, seen.id).cloned() else {
            return false;
        };
        by(&mut tag);
        let corners_px = self.seen_px(&tag, &view.pose);
        seen.corners_px = corners_px.unwrap_or(seen.corners_px);
        corners_px.is_some()
    }
}

/// Returns the corners of a bent card, model frame, mm, with the same mean depth as the flat card's.
fn bent(tag: &Tag, mm: f64, axis_rad: f64) -> [Point3<f64>; 4] {
    let corners = corners_in_tag_mm(tag.size_mm);
    let across = |corner: &Point3<f64>| (corner.x * axis_rad.cos() + corner.y * axis_rad.sin()) / (tag.size_mm / 2.0);
    let depth = |corner: &Point3<f64>| mm * tag.size_mm / 100.0 * (1.0 - across(corner).powi(2));
    let mean = corners.iter().map(depth).sum::<f64>() / 4.0;
    corners.map(|corner| tag.pose() * Point3::new(corner.x, corner.y, depth(&corner) - mean))
}
