//! What a log shows of long work.

use super::*;

fn seconds(seconds: u64) -> String {
    duration(Duration::from_secs(seconds))
}

#[test]
fn times_are_short() {
    assert_eq!(
        [1, 40, 119, 120, 719, 7200 + 310].map(seconds),
        ["1 s", "40 s", "119 s", "2 min", "11 min", "2 h 5 min"]
    );
}

#[test]
fn a_line_says_how_far_the_work_is_and_how_it_goes() {
    let work = |unit| Work {
        what: "scoring".into(),
        unit,
    };
    let bar = ProgressBar::with_draw_target(Some(300), ProgressDrawTarget::hidden()).with_message("scoring");
    assert_eq!(work(Unit::Counted("photos")).line(&bar), "scoring 0/300 photos");
    bar.set_position(120);
    assert_eq!(work(Unit::Counted("photos")).far(&bar), "scoring 120/300 photos");
    bar.set_message("loss 0.5");
    assert_eq!(
        work(Unit::Counted("steps")).far(&bar),
        "scoring 120/300 steps, loss 0.5"
    );
    bar.set_message("scoring");
    bar.set_length(2_500_000);
    bar.set_position(1_240_000);
    assert_eq!(work(Unit::Bytes).far(&bar), "scoring 1.2 MB of 2.5 MB");
    assert_eq!(work(Unit::None).line(&bar), "scoring, 0 s so far");
}

/// The lines that `work` causes when one comes every 20 ms.
fn lines(work: impl FnOnce(&Progress)) -> Vec<String> {
    let said = Arc::new(Mutex::new(Vec::new()));
    let keep = said.clone();
    let bar = ProgressBar::with_draw_target(Some(4), ProgressDrawTarget::hidden()).with_message("looking");
    let what = Work {
        what: "looking".into(),
        unit: Unit::Counted("photos"),
    };
    let say = Arc::new(move |line: &str| keep.lock().unwrap().push(line.to_owned()));
    let progress = Progress::start(what, bar, Some(Duration::from_millis(20)), say);
    work(&progress);
    drop(progress);
    Arc::into_inner(said).map_or_else(Vec::new, |said| said.into_inner().unwrap())
}

#[test]
fn long_work_is_heard_of_between_its_steps_and_at_its_end_short_work_is_not() {
    let long = lines(|progress| {
        progress.inc(1);
        std::thread::sleep(Duration::from_millis(150));
        progress.inc(3);
        progress.finish_and_clear();
    });
    assert!(long.len() > 2, "{long:?}");
    assert!(long[0].starts_with("looking 1/4 photos"), "{long:?}");
    assert_eq!(long.last().unwrap(), "looking 4/4 photos, done in 0 s");
    assert_eq!(lines(Progress::finish_and_clear), [""; 0]);
    let given_up = lines(|_| std::thread::sleep(Duration::from_millis(100)));
    assert!(
        given_up.iter().all(|line| line.starts_with("looking 0/4 photos")),
        "{given_up:?}"
    );
}

#[test]
fn the_time_left_follows_the_mean_speed() {
    let after = |seconds: f64, done: u64, all: Option<u64>| left(done, all, Duration::from_secs_f64(seconds));
    assert_eq!(after(60.0, 60, Some(100)), ", 40 s left");
    // One slow step after sixty fast ones: twice the time, not days.
    assert_eq!(after(120.0, 60, Some(100)), ", 80 s left");
    // Nothing is promised by the first steps, by the last, or of unknown length.
    for (done, all) in [(0, Some(100)), (4, Some(100)), (100, Some(100)), (5, None)] {
        assert_eq!(after(9.0, done, all), "", "{done} of {all:?}");
    }
}
