//! The markers of OpenCV's dictionaries.

use scaleproof_pose::tags::MarkerDictionary;

#[test]
fn dictionaries_have_the_markers_their_names_say() {
    for name in MarkerDictionary::NAMES {
        let dictionary = MarkerDictionary::named(name).unwrap();
        let side = dictionary.marker(0).unwrap().side();
        if let Some(sizes) = name.strip_prefix("DICT_").filter(|s| s.contains('X')) {
            let (bits, count) = sizes.split_once('_').unwrap();
            assert_eq!(side, bits[..1].parse::<usize>().unwrap() + 2, "{name}");
            assert_eq!(dictionary.count(), count.parse::<usize>().unwrap(), "{name}");
        }
    }
    let error = MarkerDictionary::named("DICT_9X9").unwrap_err().to_string();
    assert!(error.starts_with("dictionary 'DICT_9X9' is not known"), "{error}");
}
