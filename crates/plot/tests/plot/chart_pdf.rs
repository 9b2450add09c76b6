use scaleproof_plot::lettering::width_mm;
use scaleproof_plot::{Anchor, BLACK, Drawing, FAINT, Mark, colour};

fn drawing(marks: Vec<Mark>) -> Drawing {
    Drawing {
        area: [-20.0, -10.0, 100.0, 60.0],
        label: "a chart".to_owned(),
        marks,
    }
}

/// The operators of the one page, in their order: each with its numbers.
fn operators(marks: Vec<Mark>) -> Vec<(String, Vec<f64>)> {
    let document = lopdf::Document::load_mem(&drawing(marks).pdf().unwrap()).unwrap();
    let page = document.page_iter().next().unwrap();
    let content = document.get_and_decode_page_content(page).unwrap();
    let numbers = |o: &lopdf::content::Operation| {
        o.operands
            .iter()
            .filter_map(|v| v.as_float().ok())
            .map(f64::from)
            .collect()
    };
    content
        .operations
        .iter()
        .map(|o| (o.operator.clone(), numbers(o)))
        .collect()
}

fn numbers_of(all: &[(String, Vec<f64>)], operator: &str) -> Vec<f64> {
    let found = all.iter().find(|(name, _)| name == operator);
    found.unwrap_or_else(|| panic!("no {operator} in {all:?}")).1.clone()
}

#[test]
fn the_corners_of_the_area_are_those_of_the_page() {
    let all = operators(Vec::new());
    let m = numbers_of(&all, "cm");
    let place = |x: f64, y: f64| [m[0] * x + m[2] * y + m[4], m[1] * x + m[3] * y + m[5]];
    // A pixel is three quarters of a point; PDF's origin is the lower left corner.
    assert_eq!((place(-20.0, 50.0), place(80.0, -10.0)), ([0.0, 0.0], [75.0, 45.0]));
}

#[test]
fn upright_text_runs_upwards_and_ends_at_its_place() {
    let text = Mark::text([10.0, 20.0], 8.0, Anchor::End, BLACK, "AP@0.5").upright();
    let m = numbers_of(&operators(vec![text]), "Tm");
    let place = |x: f64, y: f64| [m[0] * x + m[2] * y + m[4], m[1] * x + m[3] * y + m[5]];
    let [end, above] = [place(width_mm("AP@0.5", 8.0), 0.0), place(0.0, 1.0)];
    assert!((end[0] - 10.0).abs() < 1e-3 && (end[1] - 20.0).abs() < 1e-3, "{end:?}");
    // The tops of the letters are on the left.
    assert!((above[0] - 9.0).abs() < 1e-3, "{above:?}");
}

#[test]
fn both_files_have_the_same_places() {
    let bar = Mark::rect([3.0, 4.0], [20.04, 10.0])
        .filled(colour(0))
        .sheer(0.5)
        .titled("<bar>".to_owned());
    let line = Mark::line([0.0, 1.26], [5.0, f64::NAN], FAINT).dashed(true);
    let marks = vec![Mark::group([7.0, 9.0], vec![bar, line])];
    let svg = drawing(marks.clone()).svg();
    for words in [
        "viewBox=\"-20 -10 100 60\"",
        "<g transform=\"translate(7 9)\"><rect x=\"3\" y=\"4\" width=\"20\" height=\"10\" fill=\"#0072b2\" fill-opacity=\"0.5\">\
         <title>&lt;bar&gt;</title></rect>",
        "<line x1=\"0\" y1=\"1.3\" x2=\"5\" y2=\"0\" stroke=\"#d7dce2\" stroke-width=\"1\" stroke-dasharray=\"4 3\">",
    ] {
        assert!(svg.contains(words), "{words} in {svg}");
    }
    let all = operators(marks);
    assert!(
        all.contains(&("cm".into(), vec![1.0, 0.0, 0.0, 1.0, 7.0, 9.0])),
        "{all:?}"
    );
    assert_eq!(numbers_of(&all, "re"), [3.0, 4.0, 20.0, 10.0]);
    let [x, y] = [numbers_of(&all, "m"), numbers_of(&all, "l")];
    assert!(x[0] == 0.0 && (x[1] - 1.3).abs() < 1e-6 && y == [5.0, 0.0]);
}

#[test]
fn neighbours_leave_no_gap() {
    let ends = |left: f64, width: f64| {
        let svg = drawing(vec![Mark::rect([left, 0.0], [width, 1.0]).filled(BLACK)]).svg();
        let after = |name: &str| -> f64 {
            let bar = svg.split("<rect ").nth(2).unwrap();
            bar.split(&format!("{name}=\""))
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap()
                .parse()
                .unwrap()
        };
        [after("x"), after("x") + after("width")]
    };
    for start in 0..40 {
        let left = 0.013 * f64::from(start);
        assert!((ends(0.0, left)[1] - ends(left, 0.27)[0]).abs() < 1e-9);
    }
}
