//! Films made of others.

use std::path::Path;

/// A copy of an MP4 film of one track that players show turned clockwise by a multiple of 90°: cosine and sine stand in the matrix of the track's header
/// (`tkhd`; ISO 14496-12, 8.3.2). The options by which ffmpeg writes them differ between its versions.
///
/// # Panics
/// Where the film is no such file.
pub fn turn(film: &Path, clockwise_deg: u32, turned: &Path) {
    let mut bytes = std::fs::read(film).unwrap();
    let name = bytes.windows(4).position(|name| name == b"tkhd").unwrap();
    // Behind the name: the version, 0, and flags; times, number and duration; layers and volume.
    assert_eq!(bytes[name + 4], 0);
    let matrix = name + 4 + 4 + 20 + 16;
    let (sin, cos) = f64::from(clockwise_deg).to_radians().sin_cos();
    let [sin, cos] = [sin, cos].map(|v| v.round() as i32 * 0x10000);
    for (offset, value) in [(0, cos), (4, sin), (12, -sin), (16, cos)] {
        bytes[matrix + offset..][..4].copy_from_slice(&value.to_be_bytes());
    }
    std::fs::write(turned, bytes).unwrap();
}
