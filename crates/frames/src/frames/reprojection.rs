//! Positions held against camera and pose: where a point of the surface is seen is where it is projected to.

use nalgebra::Point3;

use super::{Frame, FrameList, SurfacePoint};
use scaleproof_core::statistics::upper_median;

/// How far points may be off in the middle, px: they are stored to a fraction of a millimetre, at the centres of parts of pixels.
pub(super) const MOST_OFF_PX: f64 = 1.0;

/// The median distance between where points of the paint are seen and where camera and pose project them to, px; a point behind the camera is
/// infinitely far off. `None` without any paint. `points`: row by row of the image, `factor` times as fine along each side.
pub(super) fn median_off_px(list: &FrameList, frame: &Frame, points: &[SurfacePoint], factor: u32) -> Option<f64> {
    let (camera, pose) = (list.camera(), frame.pose());
    let (width, factor) = ((list.size_px[0] * factor) as usize, f64::from(factor));
    let off = |i: usize, point: &SurfacePoint| {
        let projected = camera.project(&(pose * Point3::from(point.place_mm)));
        let [x, y] = [i % width, i / width].map(|v| (v as f64 + 0.5) / factor - 0.5);
        projected.map_or(f64::INFINITY, |[u, v]| (u - x).hypot(v - y))
    };
    let painted = points.iter().enumerate().filter(|(_, point)| point.side.is_some());
    let all: Vec<f64> = painted.map(|(i, point)| off(i, point)).collect();
    upper_median(&all)
}
