use std::f64::consts::PI;

use scaleproof_plot::{Cloud, Dot, Mark, PlotAxis, Scale, Shape, scatter, sector};

/// By the shoelace formula.
fn area(points: &[[f64; 2]]) -> f64 {
    let sides = points.iter().zip(points.iter().cycle().skip(1));
    sides.map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs() / 2.0
}

#[test]
fn a_mark_is_filled_by_its_share() {
    for share in [0.05, 0.25, 0.5, 0.75, 0.99] {
        let filled = area(&sector(share)) / (PI * 25.0);
        assert!((filled - share).abs() < 0.005, "{filled} of {share}");
    }
    // Clockwise from the top: a quarter ends at the right, three quarters at the left.
    let ends = |share: f64| *sector(share).last().unwrap();
    assert_eq!(sector(0.25)[..2], [[0.0, 0.0], [0.0, -5.0]]);
    assert!((ends(0.25)[0] - 5.0).abs() < 1e-9 && (ends(0.75)[0] + 5.0).abs() < 1e-9);
}

/// The height of the text, wherever it stands.
fn y_of(marks: &[Mark], wanted: &str) -> Option<f64> {
    marks.iter().find_map(|mark| match &mark.shape {
        Shape::Text(text) => Some(text.at[1]).filter(|_| text.words == wanted),
        Shape::Group(_, marks) => y_of(marks, wanted),
        _ => None,
    })
}

#[test]
fn names_do_not_cover_each_other_and_are_escaped() {
    let dot = |y: f64, name: &str| Dot {
        x: 1.0,
        y,
        share: 1.0,
        series: 0,
        shape: 0,
        name: Some(name.into()),
        is_ringed: false,
    };
    let dots = vec![dot(1.0, "a<b"), dot(1.0, "c")];
    let axis = |t: &str| PlotAxis::around(t, Scale::Log, [0.5, 2.0]);
    let cloud = Cloud {
        title: "t".into(),
        note: String::new(),
        x: axis("x"),
        y: axis("y"),
        ringed: "best".into(),
        colours: vec!["one".into()],
        shapes: vec!["two".into()],
        groups: vec![("g".into(), dots)],
    };
    let drawn = scatter(&cloud);
    let y = |name: &str| y_of(&drawn.marks, name).unwrap();
    assert!((y("a<b") - y("c")).abs() >= 11.0);
    assert!(drawn.svg().contains("a&lt;b"));
}
