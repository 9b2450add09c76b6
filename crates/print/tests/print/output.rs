//! What a name says of a format.

use std::path::Path;

use scaleproof_print::output::{SheetFormat, SheetOutput};

#[test]
fn the_ending_chooses_the_format_and_no_other_is_taken() {
    let format = |name: &str| {
        SheetOutput::named(Path::new(name), None)
            .map(|output| output.format)
            .ok()
    };
    let (pdf, svg) = (Some(SheetFormat::Pdf), Some(SheetFormat::Svg));
    assert_eq!(["a.pdf", "out/A.PDF", "-"].map(format), [pdf; 3]);
    assert_eq!(["a.svg", "out/A.Svg"].map(format), [svg; 2]);
    assert_eq!(["a.png", "a", "a.pdf.", "pdf", ".svg"].map(format), [None; 5]);
    assert!(SheetOutput::named(Path::new("a.png"), pdf).is_ok());
    assert!(SheetOutput::named(Path::new("-"), svg).is_err());
}
