//! The words of a diagnosis.

use scaleproof_pose::locate::diagnosis::ids_in_words;

#[test]
fn ids_are_said_in_ranges() {
    let words = |ids: &[u32]| ids_in_words(ids);
    assert_eq!(words(&[7]), "id 7");
    assert_eq!(words(&[3, 0, 1, 2]), "ids 0 to 3");
    assert_eq!(words(&[1, 2, 9]), "ids 1, 2 and 9");
    let even: Vec<u32> = (0..40).step_by(2).collect();
    assert_eq!(words(&even), "ids 0, 2, 4, 6, 8, 10, 12 and others");
}
