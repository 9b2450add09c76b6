//! One table in all its forms: each says the same, and each as its readers need it.

use scaleproof_core::statistics::Interval;
use scaleproof_score::report::table::{Cell, Column, Table, Value};

/// Two detectors on two textures.
fn table() -> Table {
    let columns = vec![
        Column::words("detector"),
        Column::words("texture"),
        Column::numbers("drop").called("drop_ap50").in_unit("95 %"),
        Column::numbers("hits"),
        Column::numbers("confidence"),
    ];
    let mut table = Table::new("Drops", columns);
    let interval = Interval { low: -0.06, high: 0.52 };
    table.add_block([
        vec![
            Cell::text("yolo_a"),
            Cell::text("random"),
            Cell::number(0.155, 2).with_interval(Some(interval)),
            Cell::of(Value::ShareChange { from: 6, to: 4, of: 8 }),
            Cell::change(0.584, 0.371, 2),
        ],
        vec![
            Cell::text("yolo_a"),
            Cell::text("ours, [2]"),
            Cell::number(0.5, 2).strong(true),
            Cell::of(Value::ShareChange { from: 6, to: 0, of: 8 }),
            Cell::change(0.584, 0.1, 2),
        ],
    ]);
    table.add_block([vec![
        Cell::text("b"),
        Cell::text("random"),
        Cell::default(),
        Cell::default(),
        Cell::default(),
    ]]);
    table
}

#[test]
fn a_screen_has_aligned_columns_and_names_once() {
    let lines = table().lines();
    assert_eq!(
        lines,
        [
            "detector  texture    drop [95 %]               hits   confidence",
            "yolo_a    random     0.16 [-0.06, 0.52]  6 → 4 of 8  0.58 → 0.37",
            "          ours, [2]  0.50*               6 → 0 of 8  0.58 → 0.10",
            "b         random     –                            –            –",
        ]
        .map(|line| line.to_owned())
    );
}

#[test]
fn a_narrow_screen_loses_the_last_columns_and_keeps_four() {
    for letters in 1..80 {
        let lines = table().lines_within(letters);
        let widest = lines.iter().map(|line| line.chars().count()).max().unwrap();
        let of_four = 51;
        assert!(widest <= letters || widest == of_four, "{letters}: {lines:?}");
        assert!(lines[1].starts_with("yolo_a    random"), "{lines:?}");
    }
    assert_eq!(table().lines_within(80), table().lines());
    // Names whose ends differ stay two names.
    let mut long = Table::new("Names", vec![Column::words("texture"), Column::words("effect")]);
    let names = [
        "a_pattern_of_many_letters_on_the_left",
        "a_pattern_of_many_letters_on_the_right",
    ];
    long.add_block(names.map(|name| vec![Cell::text(name), Cell::text("weakens")]));
    let lines = long.lines_within(100);
    assert_eq!(
        lines[1..],
        ["a_pattern_o…n_the_left  weakens", "a_pattern_o…_the_right  weakens"]
    );
}

#[test]
fn a_paper_gets_true_minus_signs_bold_findings_and_escaped_texts() {
    let tex = table().tex();
    assert!(tex.starts_with(
        "\\begin{tabular}{lllrr}\n\\toprule\ndetector & texture & drop, 95\\,\\% & hits & confidence \\\\\n\\midrule\n"
    ));
    assert!(tex.contains("yolo\\_a & random & 0.16 [$-0.06$, 0.52] & 6 $\\to$ 4 of 8 & 0.58 $\\to$ 0.37 \\\\\n"));
    assert!(tex.contains(" & ours, {[}2] & \\textbf{0.50} & "), "{tex}");
    assert_eq!(
        tex.matches("\\midrule").count(),
        2,
        "a line below the head, and between two detectors"
    );
}

#[test]
fn programs_get_every_number_in_full() {
    let csv = table().csv().unwrap();
    let mut rows = csv::Reader::from_reader(csv.as_bytes());
    let heads = "detector,texture,drop_ap50,drop_ap50_low,drop_ap50_high,hits_from,hits_to,hits_of,confidence_from,confidence_to";
    assert_eq!(rows.headers().unwrap(), heads.split(',').collect::<Vec<_>>());
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(
        rows[0],
        "yolo_a,random,0.155,-0.06,0.52,6,4,8,0.584,0.371"
            .split(',')
            .collect::<Vec<_>>()
    );
    // Names that a screen writes once, spreadsheets have in each row.
    assert_eq!((&rows[1][0], &rows[1][1], &rows[1][3]), ("yolo_a", "ours, [2]", ""));
    let json = table().json();
    assert_eq!(json[0]["drop_ap50_low"], -0.06);
    assert!(json[2]["drop_ap50"].is_null() && json[2]["detector"] == "b");
    assert_eq!(json.as_array().unwrap().len(), rows.len());
}
