//! Text and lengths in an SVG.

use scaleproof_print::svg::{escaped, length};

#[test]
fn text_cannot_break_the_file() {
    assert_eq!(escaped("a<b>&\"c\"\u{7}"), "a&lt;b&gt;&amp;&quot;c&quot;?");
}

#[test]
fn lengths_are_plain() {
    assert_eq!([0.0, -0.00001, 7.375, 100.0].map(length), ["0", "0", "7.375", "100"]);
}
