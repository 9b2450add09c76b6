//! Where outputs go.

use scaleproof_core::files::is_stream;
use std::path::Path;

#[test]
#[cfg(unix)]
fn a_device_is_written_to_and_never_replaced() {
    let place = is_stream(Path::new("/dev/null"));
    assert!(matches!(place, Ok(true)), "{place:?}");
}
