//! What Ultralytics' exporter writes into an ONNX file.

use scaleproof_detect::{height_and_width, python_names};

#[test]
fn names_are_read_as_python_writes_them() {
    let read = |text: &str| python_names(text).map(|n| n.join("|"));
    assert_eq!(
        read("{0: 'person', 1: 'traffic light'}").as_deref(),
        Some("person|traffic light")
    );
    assert_eq!(
        read(r#"{0: "driver's seat", 1: 'a\'b: c, }'}"#).as_deref(),
        Some("driver's seat|a'b: c, }")
    );
    assert_eq!(read(r#"{"0": "car"}"#).as_deref(), Some("car"));
    for bad in [
        "{}",
        "{1: 'car'}",
        "{0: 'car'",
        "{0: car}",
        "['car']",
        "{0: 'a', 2: 'b'}",
        "{0: 'é",
    ] {
        assert_eq!(read(bad), None, "{bad}");
    }
    assert_eq!(height_and_width("[480, 640]"), Some([640, 480]));
}
