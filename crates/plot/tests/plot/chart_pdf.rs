use scaleproof_plot::chart_pdf::{matrix, pdf_of_svg};

#[test]
fn steps_of_a_transform_follow_each_other() {
    let [a, b, c, d, e, f] = matrix("translate(10 20) rotate(-90)").unwrap();
    // One to the right on the turned axis is one up on the page.
    assert_eq!([a + e, b + f, c + e, d + f], [10.0, 19.0, 11.0, 20.0]);
    assert!(matrix("scale(2)").is_err() && matrix("rotate(30)").is_err());
}

#[test]
fn what_no_chart_has_is_refused() {
    for (mark, reason) in [
        ("<ellipse/>", "`ellipse`"),
        ("<rect fill='red'/>", "`red`"),
        ("<rect fill='#12345'/>", "`#12345`"),
        ("<path d='M0 0C1 1 2 2 3 3'/>", "the path"),
    ] {
        let svg = format!("<svg width='9' height='9'>{mark}</svg>");
        let error = pdf_of_svg("t", &svg).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
    assert!(pdf_of_svg("t", "no svg").is_err());
}
