//! The camera file.

use crate::camera::Camera;

/// The camera as OpenCV's FileStorage writes it: five coefficients where they do, else eight.
pub fn opencv_yaml(camera: &Camera) -> String {
    let all = camera.distortion();
    let used = if all[5..].iter().all(|k| *k == 0.0) { 5 } else { 8 };
    let list = |numbers: &[f64]| numbers.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ");
    let k = [camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0];
    format!(
        "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
         data: [ {} ]\ndistortion_coefficients: !!opencv-matrix\n   rows: {used}\n   cols: 1\n   dt: d\n   data: [ {} ]\n",
        camera.width,
        camera.height,
        list(&k),
        list(&all[..used])
    )
}
