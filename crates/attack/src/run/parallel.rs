//! Detectors on images in parallel. Results keep the images' order, so whatever is summed over them does not depend on the number of threads.

use crate::AttackError;
use scaleproof_core::workers;
use scaleproof_gradients::WhiteBox;

/// Evaluates every item: over `threads` threads where all detectors can be shared between threads, else one after the other.
pub(super) fn evaluate_each<T: Sync, R: Send>(
    threads: usize,
    detectors: &[Box<dyn WhiteBox>],
    items: &[T],
    evaluate: impl Fn(&[&dyn WhiteBox], &T) -> Result<R, AttackError> + Sync,
) -> Result<Vec<R>, AttackError> {
    let shared: Option<Vec<&(dyn WhiteBox + Sync)>> = detectors.iter().map(|detector| detector.shared()).collect();
    let Some(shared) = shared else {
        let detectors: Vec<&dyn WhiteBox> = detectors.iter().map(AsRef::as_ref).collect();
        return items.iter().map(|item| evaluate(&detectors, item)).collect();
    };
    let own = || Ok(Vec::from_iter(shared.iter().map(|detector| *detector as &dyn WhiteBox)));
    workers::map_over(threads, items, own, |detectors, item| evaluate(detectors, item), || {})
}
