//! Which photo a name of another program means.

use std::path::Path;

use scaleproof_detect::{PhotoName, PhotoNames};

#[test]
fn a_name_means_the_photo_whose_folders_agree_furthest() {
    let photo = |folder: &str, file: &str| PhotoName::new(Path::new(folder), file);
    let photos = [
        photo("/s/one", "a.jpg"),
        photo("/s/two", "a.jpg"),
        photo("/s/two", "../x/b.jpg"),
        photo("/s/two", "c/d.jpg"),
    ];
    let names = PhotoNames::new(&photos);
    for (name, found) in [
        ("two/a.jpg", Ok(Some(1))),
        ("/elsewhere/one/a.jpg", Ok(Some(0))),
        ("one\\a", Ok(Some(0))),
        (
            "a.jpg",
            Err("a.jpg may be a.jpg or a.jpg: name it with its folder".to_owned()),
        ),
        ("b", Ok(Some(2))),
        ("x_b.jpg", Ok(Some(2))),
        ("c_d", Ok(Some(3))),
        ("e.jpg", Ok(None)),
        ("", Ok(None)),
        ("/", Ok(None)),
    ] {
        assert_eq!(names.find(name, name), found, "{name}");
    }
}
