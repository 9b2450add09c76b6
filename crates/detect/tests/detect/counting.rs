//! Which labels count as the model.

use scaleproof_detect::Manifest;

/// A built-in manifest with labels and a map of its own.
fn manifest(labels: &str, map: &str) -> Result<Manifest, String> {
    let text = Manifest::named("yolox_nano").unwrap().to_toml().unwrap();
    let text = text.replace("labels = \"coco80\"", labels);
    Manifest::parse(&format!("{text}\n[class_map]\n{map}\n"), "x.toml").map_err(|e| e.to_string())
}

fn counted(manifest: &Manifest, classes: &[&str]) -> Result<Vec<usize>, String> {
    let classes: Vec<String> = classes.iter().map(|c| (*c).to_owned()).collect();
    manifest.counted(&classes).map_err(|e| e.to_string())
}

#[test]
fn a_mapped_label_counts_as_what_it_is_mapped_to_and_as_nothing_else() {
    let german = manifest(r#"labels = ["Baum", "PKW", "LKW"]"#, "PKW = \"car\"\nLKW = \"truck\"").unwrap();
    assert_eq!(counted(&german, &["car"]), Ok(vec![1]));
    assert_eq!(counted(&german, &["car", "truck", "bus"]), Ok(vec![1, 2]));
    assert_eq!(german.unknown_classes(&["bus".into(), "car".into()]), ["bus"]);
    assert!(counted(&german, &["PKW"]).is_err());
    assert_eq!(Manifest::parse(&german.to_toml().unwrap(), "x.toml").unwrap(), german);
}

#[test]
fn a_class_that_is_not_there_names_the_nearest_labels() {
    let coco = Manifest::named("yolox_nano").unwrap();
    let refused = counted(&coco, &["Trucks", "lorry"]).unwrap_err();
    for words in [
        "yolox_nano has no label `Trucks` or `lorry`",
        "the nearest of its 80 labels are `truck`",
        "[class_map] \"truck\" = \"Trucks\"",
    ] {
        assert!(refused.contains(words), "{refused}");
    }
}

#[test]
fn a_map_that_does_not_fit_is_refused() {
    for (map, words) in [
        (
            "vna = \"car\"",
            "class_map has `vna`, which is no label of this detector; its labels are `van`, `PKW`",
        ),
        ("PKW = \"\"", "class_map counts `PKW` as \"\""),
    ] {
        let refused = manifest(r#"labels = ["PKW", "van"]"#, map).unwrap_err();
        assert!(refused.contains(words), "{refused}");
    }
}
