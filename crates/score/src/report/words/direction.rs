//! Sides of the model in words.

/// Returns the side of the model that is seen from an azimuth: `front left`.
pub(crate) fn side(azimuth_deg: f64) -> &'static str {
    const SIDES: &str = "front, front left, left, rear left, rear, rear right, right, front right";
    let eighth = ((azimuth_deg / 45.0).round() as usize) % 8;
    SIDES.split(", ").nth(eighth).unwrap_or_default()
}
