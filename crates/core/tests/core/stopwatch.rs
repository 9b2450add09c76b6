//! Time by stage.

use scaleproof_core::workers::stopwatch::{Stage, StageMs, take, timed};
use std::time::{Duration, Instant};

#[test]
fn a_moment_counts_for_the_innermost_stage() {
    let pause = |ms: u64| std::thread::sleep(Duration::from_millis(ms));
    let begin = Instant::now();
    timed(Stage::Rest, || {
        timed(Stage::Tags, || {
            pause(20);
            timed(Stage::Read, || pause(60));
        });
        timed(Stage::Network, || pause(40));
    });
    let spent = take();
    let in_all = begin.elapsed().as_secs_f64() * 1000.0;
    let of = |stage: Stage| spent[stage as usize];
    // A sleep may last longer, and never shorter.
    assert!(of(Stage::Read) >= 60.0 && of(Stage::Network) >= 40.0 && of(Stage::Tags) >= 20.0);
    // No moment counts twice.
    assert!(spent.iter().sum::<f64>() <= in_all, "{spent:?} in {in_all} ms");
    assert_eq!(take(), StageMs::default());
}
