use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, scatter, sector};

#[test]
fn a_mark_is_filled_by_its_share() {
    // A quarter ends at the right, three quarters at the left, over the large arc.
    assert_eq!(sector(0.25), "M0 0V-5A5 5 0 0 1 5 -0Z");
    assert_eq!(sector(0.75), "M0 0V-5A5 5 0 1 1 -5 0Z");
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
    let svg = scatter(&cloud);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let y_of = |wanted: &str| -> f64 {
        let text = document.descendants().find(|n| n.text() == Some(wanted)).unwrap();
        text.attribute("y").unwrap().parse().unwrap()
    };
    assert!((y_of("a<b") - y_of("c")).abs() >= 11.0);
}
