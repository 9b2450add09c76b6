//! What counts as the model.

use scaleproof_pose::scene::Classes;

#[test]
fn a_set_is_said_as_people_say_it_and_written_as_it_was() {
    for (text, said, joined, written) in [
        ("car", "car", "car", "\"car\""),
        ("truck, car", "car or truck", "car+truck", "[\"car\", \"truck\"]"),
        (
            "car,bus,truck",
            "bus, car or truck",
            "bus+car+truck",
            "[\"bus\", \"car\", \"truck\"]",
        ),
    ] {
        let classes: Classes = text.parse().unwrap();
        assert_eq!(
            (classes.to_string(), classes.joined()),
            (said.to_owned(), joined.to_owned())
        );
        assert_eq!(classes.to_toml(), written);
    }
    let quoted = "car,truck".parse::<Classes>().unwrap().quoted();
    assert_eq!(quoted, "`car` or `truck`");
}

#[test]
fn sets_that_say_nothing_are_refused() {
    for (text, word) in [
        ("", "\"\" is no label"),
        ("car,car", "lists `car` twice"),
        ("a\nb", "no label"),
    ] {
        let refused = text.parse::<Classes>().unwrap_err().to_string();
        assert!(refused.contains(word), "{refused}");
    }
    assert!(Classes::new(Vec::new()).unwrap_err().to_string().contains("empty list"));
    assert!(
        Classes::new(vec!["x".repeat(101)])
            .unwrap_err()
            .to_string()
            .contains("1 to 100 characters")
    );
}
