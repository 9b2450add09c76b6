//! A QR code for the terminal.

use qrcode::QrCode;
use qrcode::render::unicode::Dense1x2;

/// The code with its quiet zone, two rows of modules to a line, for dark characters on a light ground.
pub(super) fn drawn(text: &str) -> Result<String, String> {
    let code = QrCode::new(text).map_err(|e| e.to_string())?;
    Ok(code.render::<Dense1x2>().build())
}
