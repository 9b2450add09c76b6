//! Tests of `cli/full/model.rs`.

use super::*;

#[test]
fn a_model_wider_than_long_is_noticed() {
    assert_eq!(turned([455.0, 186.0, 128.0]), None);
    assert_eq!(turned([100.0; 3]), None);
    assert_eq!(
        turned([186.0, 455.0, 128.0]).unwrap_or_default(),
        "the model is 186 mm long and 455 mm wide: is --mesh-front right?"
    );
}
