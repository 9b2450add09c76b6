use scaleproof_session::new::{free_name, path_between};
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn the_way_between_folders_goes_up_then_down() {
    for (from, to, wanted) in [
        ("/a/session", "/a/photos/monday", "../photos/monday"),
        ("/a/photos/session", "/a/photos", ".."),
        ("/a", "/a/photos", "photos"),
        ("/a", "/a", ""),
        ("/a/b", "/c", "../../c"),
    ] {
        assert_eq!(
            path_between(Path::new(from), Path::new(to)),
            Path::new(wanted),
            "{from} to {to}"
        );
    }
}

#[test]
fn folders_of_one_name_get_numbers() {
    let mut taken = BTreeSet::new();
    let names = ["Photos", "photos", "x", "photos"].map(|name| free_name(name, &mut taken));
    assert_eq!(names, ["Photos", "photos_2", "x", "photos_3"]);
}
