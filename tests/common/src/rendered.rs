//! Photos of a ring of tags around a model, cast ray by ray: sessions whose truth is exact, of any scene and camera.

use std::convert::Infallible;

use image::{GrayImage, Luma};
use nalgebra::{Point3, Vector3};
use scaleproof_core::geometry::Rigid;
use scaleproof_core::workers;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, Tag, Viewpoint};
use scaleproof_pose::simulate::looking_at;
use scaleproof_pose::tags::TagImage;

/// Rays along each side of a pixel.
const FINE: u32 = 3;
const PAPER: f64 = 225.0;
const INK: f64 = 28.0;
const TABLE: f64 = 150.0;
const BODY: f64 = 90.0;

/// Photos from these viewpoints, in their order.
pub fn photos(scene: &Scene, camera: &Camera, viewpoints: &[Viewpoint]) -> Vec<GrayImage> {
    let cards: Vec<Card> = scene.tags.iter().map(Card::of).collect();
    let rays = rays(camera);
    let photo = |view: &Viewpoint| {
        let pose = looking_at(view, scene.model.target_mm());
        Caster {
            scene,
            camera,
            rays: &rays,
            pose,
            centre: (pose.inverse() * Point3::origin()),
        }
        .photo(&cards)
    };
    let taken: Result<_, Infallible> = workers::map(viewpoints, || Ok(()), |(), view| Ok(photo(view)), || {});
    let Ok(taken) = taken;
    taken
}

/// A tag with the white around it.
struct Card {
    tag: Tag,
    image: TagImage,
}

impl Card {
    fn of(tag: &Tag) -> Card {
        Card {
            image: TagImage::new(tag.family, tag.id).unwrap(),
            tag: tag.clone(),
        }
    }

    fn width_mm(&self) -> f64 {
        self.image.width_mm(self.tag.size_mm)
    }

    /// Where a ray from `centre` meets it: how far along, and the colour.
    fn hit(&self, centre: &Point3<f64>, ray: &Vector3<f64>) -> Option<(f64, f64)> {
        let normal = self.tag.right.cross(&self.tag.up);
        let along = normal.dot(ray);
        let t = normal.dot(&(self.tag.centre_mm - centre)) / along;
        let at = centre + ray * t - self.tag.centre_mm;
        let side = self.image.modules().side();
        let module = |offset: f64| {
            let at = (offset / self.width_mm() + 0.5) * side as f64;
            (0.0..side as f64).contains(&at).then_some(at as usize)
        };
        let (column, row) = (module(at.dot(&self.tag.right))?, module(-at.dot(&self.tag.up))?);
        let colour = if self.image.modules().is_black(row, column) {
            INK
        } else {
            PAPER
        };
        // Only its front is printed.
        (along < 0.0 && t > 0.0).then(|| (t, lit(colour, &normal)))
    }
}

/// A lamp above, to the front and the left.
fn lit(colour: f64, normal: &Vector3<f64>) -> f64 {
    let lamp = Vector3::new(0.4, 0.5, 0.77).normalize();
    colour * (0.62 + 0.38 * normal.dot(&lamp).max(0.0))
}

/// In the camera frame, z = 1; row by row of the fine image.
fn rays(camera: &Camera) -> Vec<Option<Vector3<f64>>> {
    let fine = f64::from(FINE);
    let at = |i: u32| (f64::from(i) + 0.5) / fine - 0.5;
    let rows = 0..camera.height * FINE;
    rows.flat_map(|y| (0..camera.width * FINE).map(move |x| [at(x), at(y)]))
        .map(|pixel| camera.point_at(pixel).map(|[x, y]| Vector3::new(x, y, 1.0)))
        .collect()
}

struct Caster<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    rays: &'a [Option<Vector3<f64>>],
    /// `T_camera_model`.
    pose: Rigid,
    /// Of the camera, model frame.
    centre: Point3<f64>,
}

impl Caster<'_> {
    fn photo(&self, cards: &[Card]) -> GrayImage {
        let (width, height) = (self.camera.width * FINE, self.camera.height * FINE);
        let mut fine: Vec<(f64, f64)> = self.rays.iter().map(|ray| self.without_cards(ray)).collect();
        for card in cards {
            let [left, top, right, bottom] = self.bounds(card);
            for y in top..bottom.min(height) {
                for x in left..right.min(width) {
                    let i = (y * width + x) as usize;
                    let hit = self.rays[i].and_then(|ray| card.hit(&self.centre, &self.to_model(&ray)));
                    fine[i] = hit.filter(|(t, _)| *t < fine[i].0).unwrap_or(fine[i]);
                }
            }
        }
        GrayImage::from_fn(self.camera.width, self.camera.height, |x, y| {
            let rows = y * FINE..(y + 1) * FINE;
            let sum: f64 = rows
                .flat_map(|y| (x * FINE..(x + 1) * FINE).map(move |x| (y * width + x) as usize))
                .map(|i| fine[i].1)
                .sum();
            Luma([(sum / f64::from(FINE * FINE)).round() as u8])
        })
    }

    fn to_model(&self, ray: &Vector3<f64>) -> Vector3<f64> {
        self.pose.rotation.inverse() * ray
    }

    /// Pixels of the fine image around a card, with some to spare: a lens bends straight edges.
    fn bounds(&self, card: &Card) -> [u32; 4] {
        let h = card.width_mm() / 2.0;
        let corner = |(u, v): (f64, f64)| card.tag.centre_mm + card.tag.right * u + card.tag.up * v;
        let corners = [(-h, -h), (-h, h), (h, -h), (h, h)].map(corner);
        let at: Vec<[f64; 2]> = corners
            .iter()
            .filter_map(|p| self.camera.project(&(self.pose * p)))
            .collect();
        if at.len() < 4 {
            return [0; 4];
        }
        let fold = |axis: usize, of: fn(f64, f64) -> f64, start: f64| at.iter().map(|p| p[axis]).fold(start, of);
        let spare = 6.0;
        let fine = |v: f64| (v * f64::from(FINE)).max(0.0) as u32;
        [
            fine(fold(0, f64::min, f64::INFINITY) - spare),
            fine(fold(1, f64::min, f64::INFINITY) - spare),
            fine(fold(0, f64::max, 0.0) + spare),
            fine(fold(1, f64::max, 0.0) + spare),
        ]
    }

    /// The table or the model's box: how far along a ray, and the colour.
    fn without_cards(&self, ray: &Option<Vector3<f64>>) -> (f64, f64) {
        let Some(ray) = ray.map(|ray| self.to_model(&ray)) else {
            return (f64::INFINITY, 0.0);
        };
        // A card that lies flat is thicker than nothing.
        let table = match -self.centre.z / ray.z {
            t if t > 0.0 => {
                let at = self.centre + ray * t;
                let wave = 8.0 * (at.x / 70.0).sin() * (at.y / 110.0).cos();
                (t, lit(TABLE + wave, &Vector3::z()))
            }
            _ => (f64::INFINITY, 200.0),
        };
        match self.model(&ray) {
            Some(model) if model.0 < table.0 => model,
            _ => (table.0 + 2.0 / ray.norm(), table.1),
        }
    }

    /// Where a ray enters the model's box (slabs: Kay & Kajiya 1986).
    fn model(&self, ray: &Vector3<f64>) -> Option<(f64, f64)> {
        let [length, width, height] = self.scene.model.size_mm;
        let slabs = [
            (-length / 2.0, length / 2.0),
            (-width / 2.0, width / 2.0),
            (0.0, height),
        ];
        let (mut enter, mut leave, mut normal) = (0.0, f64::INFINITY, Vector3::z());
        for (axis, (low, high)) in slabs.into_iter().enumerate() {
            let (a, b) = (
                (low - self.centre[axis]) / ray[axis],
                (high - self.centre[axis]) / ray[axis],
            );
            if a.min(b) > enter {
                enter = a.min(b);
                normal = Vector3::zeros();
                normal[axis] = -ray[axis].signum();
            }
            leave = leave.min(a.max(b));
        }
        (enter < leave && enter > 0.0).then(|| (enter, lit(BODY, &normal)))
    }
}
