//! stub
use super::Calibration;
/// x
pub fn page(_: &Calibration) -> String {
    String::new()
}
