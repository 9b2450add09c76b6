//! The one pinhole camera of frames made of photos.

use crate::Pinhole;
use crate::raster::ray;
use scaleproof_pose::camera::Camera;

/// Factor of the focal length in a step, until the frame lies inside the photo, and its largest factor in all.
const STEP: f64 = 1.002;
const MOST: f64 = 1.5;
/// Places along each side of the frame that are checked.
const PLACES: usize = 64;

/// Finds the pinhole of frames of this size that show nothing beyond the images of a camera: its lens without the distortion, and so much longer
/// that no corner of the frame is empty. `None` when there is none.
pub(super) fn inside(camera: &Camera, size_px: [u32; 2]) -> Option<Pinhole> {
    let scale = f64::from(size_px[0]) / f64::from(camera.width);
    let place = |c: f64| (c + 0.5) * scale - 0.5;
    let start = Pinhole {
        focal_length_px: scale * (camera.fx * camera.fy).sqrt(),
        centre_px: [place(camera.cx), place(camera.cy)],
    };
    longer(start, camera, size_px)
}

/// Makes the focal length of `start` longer until frames of this size lie inside a camera's images; `None` when 1.5 times is too little.
pub(super) fn longer(start: Pinhole, camera: &Camera, size_px: [u32; 2]) -> Option<Pinhole> {
    let steps = (MOST.ln() / STEP.ln()) as i32;
    (0..=steps)
        .map(|step| Pinhole {
            focal_length_px: start.focal_length_px * STEP.powi(step),
            ..start
        })
        .find(|pinhole| is_inside(pinhole, camera, size_px))
}

/// Returns the size of frames of this width with the aspect of the camera's images.
pub(super) fn size_px(camera: &Camera, width_px: u32) -> [u32; 2] {
    let height = f64::from(width_px) * f64::from(camera.height) / f64::from(camera.width);
    [width_px, (height.round() as u32).max(1)]
}

fn is_inside(pinhole: &Pinhole, camera: &Camera, size_px: [u32; 2]) -> bool {
    // Without distortion the frame's border is the photo's, up to rounding.
    const ROUNDING_PX: f64 = 1e-6;
    let [width, height] = size_px.map(f64::from);
    let within = |at: f64, side: u32| (-0.5 - ROUNDING_PX..=f64::from(side) - 0.5 + ROUNDING_PX).contains(&at);
    let is_in_photo = |pixel: [f64; 2]| {
        let seen = camera.project(&ray(pinhole, pixel));
        seen.is_some_and(|[u, v]| within(u, camera.width) && within(v, camera.height))
    };
    let along = |i: usize, side: f64| side * i as f64 / PLACES as f64 - 0.5;
    (0..=PLACES).all(|i| {
        let (x, y) = (along(i, width), along(i, height));
        let border = [[x, -0.5], [x, height - 0.5], [-0.5, y], [width - 0.5, y]];
        border.into_iter().all(is_in_photo)
    })
}
