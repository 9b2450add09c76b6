//! The stated σ of a pose is true, and where it is not, the chart shows it.

use scaleproof_session::Session;
use scaleproof_study::chart::sigma::{SigmaRow, draw, errors, measure, of_photos, simulated, table};

fn skyline() -> Session {
    Session::open(&crate::common::skyline()).unwrap()
}

/// Corner noise and paper as real photos show them: within each multiple of σ are as many errors of one, two, three, and more tags as of normal errors.
/// None is less by 5 points. From 2 σ on none is more by 5, either; below, σ is up to a sixth too large for several tags, and more for the lone tags that
/// are answered, whose few large errors it holds too.
#[test]
fn the_stated_sigma_is_met_by_one_two_three_and_more_tags() {
    let session = skyline();
    let materials = simulated(&session.scene, session.known_camera().unwrap(), 2500, 3);
    let (name, views) = materials.last().unwrap();
    let rows: Vec<SigmaRow> = (1..)
        .zip(errors(views))
        .map(|(tags, errors)| errors.row(name, tags))
        .collect();
    println!("{}", table(&rows));
    for row in &rows {
        assert!(row.answered >= 500, "{row:?}");
        for coverage in [&row.azimuth, &row.pitch, &row.distance].into_iter().flatten() {
            let off = coverage.met - coverage.expected;
            assert!(off >= -0.05, "{} tags: {coverage:?}", row.tags);
            assert!(off <= 0.05 || coverage.sigmas < 2.0, "{} tags: {coverage:?}", row.tags);
        }
        // A bin stated with 99 % is wrong at most once in a hundred.
        assert!(100 * row.wrong_sure_bins <= row.sure_bins, "{row:?}");
    }
}

/// A program that states half of its σ is seen at once.
#[test]
fn half_of_the_true_sigma_shows() {
    let session = skyline();
    let materials = simulated(&session.scene, session.known_camera().unwrap(), 300, 5);
    // Of the lone tags too few are answered to tell.
    for mut errors in errors(&materials.last().unwrap().1).into_iter().skip(1) {
        errors.in_sigmas.iter_mut().flatten().for_each(|off| *off *= 2.0);
        let row = errors.row("half of σ", 1);
        for coverages in [&row.azimuth, &row.pitch, &row.distance] {
            assert!(
                coverages[1..].iter().all(|c| c.met_95.high < c.expected),
                "{coverages:?}"
            );
        }
    }
}

/// Each tag of each photo alone, twos, threes, and more; the same for the same seed; every panel drawn.
#[test]
fn photos_are_charted_by_how_many_tags_are_used() {
    let (session, truth) = (skyline(), crate::common::skyline().join("truth.json"));
    let views = of_photos(&session, &truth, false, 1, || ()).unwrap();
    let count = |tags: usize| views.iter().filter(|view| view.seen.len().min(4) == tags).count();
    assert!(count(1) >= 150, "{}", count(1));
    for tags in 2..=4 {
        assert!(count(tags) > count(1) / 2, "{tags}: {}", count(tags));
    }
    for view in &views {
        let ids: Vec<u32> = view.scene.tags.iter().map(|tag| tag.id).collect();
        assert_eq!(ids, view.seen.iter().map(|tag| tag.id).collect::<Vec<_>>());
    }
    let sessions = [(session, truth)];
    let rows = measure(&sessions, 10, 1, || ()).unwrap();
    println!("{}", table(&rows));
    assert_eq!(rows, measure(&sessions, 10, 1, || ()).unwrap());
    let drawn = draw(&rows);
    for words in [
        "skyline<",
        "skyline: uneven light<",
        "simulated: bent paper<",
        "four tags or more",
    ] {
        assert!(drawn.contains(words), "{words}");
    }
    // On clean renders σ is not too small by 5 points, as far as some hundred poses tell.
    for row in rows.iter().filter(|row| row.material == "skyline") {
        assert_eq!(row.wrong_sure_bins, 0);
        for coverage in [&row.azimuth, &row.pitch, &row.distance].into_iter().flatten() {
            assert!(
                coverage.met_95.high >= coverage.expected - 0.05,
                "{} tags: {coverage:?}",
                row.tags
            );
        }
    }
}
