//! Lists of labels.

use scaleproof_detect::Labels;
use serde::Deserialize;

/// More labels than any detector has.
const MOST_LABELS: usize = 20_000;

#[derive(Deserialize)]
struct File {
    labels: Labels,
}

fn read(text: &str) -> Result<Labels, String> {
    let file: Result<File, _> = toml::from_str(text);
    file.map(|f| f.labels).map_err(|e| e.message().to_owned())
}

#[test]
fn names_numbers_and_category_ids_agree_in_every_list() {
    let own = read(r#"labels = ["van", "car"]"#).unwrap();
    for (labels, names, car) in [
        (Labels::Coco80, 80, 2),
        (Labels::Coco91, 80, 3),
        (Labels::Voc20, 20, 6),
        (own, 2, 1),
    ] {
        assert_eq!(labels.find("car"), Some(car));
        let named: Vec<usize> = (0..labels.count()).filter(|l| labels.name(*l).is_some()).collect();
        assert_eq!(named.len(), names, "{labels:?}");
        for label in named {
            assert_eq!(labels.find(labels.name(label).unwrap()), Some(label));
            assert_eq!(labels.of_category(labels.category_id(label).unwrap()), Some(label));
        }
    }
    // COCO's own ids, whichever way the detector counts.
    assert_eq!(
        (Labels::Coco80.category_id(79), Labels::Coco91.category_id(90)),
        (Some(90), Some(90))
    );
    assert_eq!((Labels::Coco91.name(12), Labels::Coco91.category_id(0)), (None, None));
}

#[test]
fn lists_that_say_nothing_are_refused() {
    for (text, word) in [
        (r#"labels = "coco82""#, "coco82"),
        ("labels = []", "empty"),
        (r#"labels = ["car", "van", "car"]"#, "\"car\" is listed twice"),
        ("labels = 3", "a list of names"),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains(word), "{text}: {error}");
    }
    let many = Labels::of_names((0..=MOST_LABELS).map(|i| i.to_string()).collect());
    let error = many.unwrap_err().to_string();
    assert_eq!(error, "there are 20001 labels, more than the 20000 that are read");
    assert!(Labels::of_names((0..MOST_LABELS).map(|i| i.to_string()).collect()).is_ok());
}
