//! Tag sizes as text.

use proptest::prelude::*;
use scaleproof_rig::survey::Sizes;

#[test]
fn ranges_single_ids_and_one_size_for_all() {
    let sizes: Sizes = "0-7:50, 8:40.5".parse().unwrap();
    assert_eq!(
        [0, 7, 8, 9].map(|id| sizes.size_mm(id)),
        [Some(50.0), Some(50.0), Some(40.5), None]
    );
    assert_eq!("50".parse::<Sizes>().unwrap().size_mm(500), Some(50.0));
}

#[test]
fn what_is_unclear_is_refused() {
    for (text, reason) in [
        ("0-7", "not a tag size"),
        ("0-7:50,3:40", "second size"),
        ("7-0:50", "backwards"),
        ("a:50", "not ID:MM"),
        ("0:50,40", "not ID:MM"),
        ("0:-5", "not a tag size"),
        ("nan", "not a tag size"),
    ] {
        let sentence = text.parse::<Sizes>().unwrap_err().to_string();
        assert!(sentence.contains(reason), "{text}: {sentence}");
    }
}

proptest! {
    #[test]
    fn any_text_is_sizes_or_a_sentence(text in "[0-9,:. -]{0,20}|\\PC*") {
        let _ = text.parse::<Sizes>();
    }
}
