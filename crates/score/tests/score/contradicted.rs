//! Lists that contradict the tags in their own photos: of the stored session, whose exact viewpoints and boxes are known.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use crate::common;

use scaleproof_core::geometry::BoxPx;
use scaleproof_pose::scene::Viewpoint;
use scaleproof_score::shard::ShardId;
use scaleproof_score::{Cache, Options, ScoreError, Scores, merge, observe, score};
use scaleproof_session::{PhotoEntry, Session};

/// Where the model is in each photo, in the order of the list, and from where it is seen.
fn truth() -> Vec<(Viewpoint, BoxPx)> {
    let truth = common::read_json(&common::skyline().join("truth.json"));
    let exact = truth["photos"].as_array().unwrap().iter().map(|photo| {
        let [azimuth_deg, pitch_deg, distance_mm] =
            ["azimuth_deg", "pitch_deg", "distance_mm"].map(|key| photo[key].as_f64().unwrap());
        let viewpoint = Viewpoint {
            azimuth_deg,
            pitch_deg,
            distance_mm,
        };
        let model = serde_json::from_value(photo["box_xyxy_px"].clone()).unwrap();
        (viewpoint, model)
    });
    exact.collect()
}

/// The stored session with a list of nominal viewpoints, in the middle of their bins, and of true boxes, of which `change` makes others.
fn listed(change: impl Fn(usize, &mut Viewpoint, &mut BoxPx)) -> Session {
    let mut session = Session::open(&common::skyline()).unwrap();
    for (i, (entry, (seen, mut model))) in session.photos.iter_mut().zip(truth()).enumerate() {
        let mut nominal = Viewpoint {
            azimuth_deg: session.scene.bins.bin_of(&seen).azimuth_deg,
            pitch_deg: 15.0,
            distance_mm: 850.0,
        };
        change(i, &mut nominal, &mut model);
        (entry.viewpoint, entry.box_xyxy_px) = (Some(nominal), Some(model));
    }
    session
}

/// Listed from the other side.
fn turned(session: &Session, at: usize) -> Viewpoint {
    let mut viewpoint = session.photos[at].viewpoint.unwrap();
    viewpoint.azimuth_deg = (viewpoint.azimuth_deg + 180.0) % 360.0;
    viewpoint
}

fn scored(session: Session) -> Result<Scores, ScoreError> {
    score(vec![session], Vec::new(), &Options::default(), || {})
}

/// The reasons of the photos that were left out, by file.
fn reasons(scores: &Scores) -> BTreeMap<&str, &str> {
    let left_out = scores.not_scored.iter();
    left_out
        .map(|photo| (photo.file.as_str(), photo.reason.as_str()))
        .collect()
}

/// The numbers of the words between two marks of a text.
fn numbers(text: &str, after: &str, before: &str) -> Vec<f64> {
    let end = text.find(before).unwrap();
    let start = text[..end].rfind(after).unwrap() + after.len();
    let plain = text[start..end].replace(['[', ']', ','], " ");
    plain.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// Fifteen of sixteen photos are listed wrongly: each is refused by name, with what the list says and what is true, and the honest one stays.
fn assert_all_but_one_refused(key: &str, session: Session, exact: impl Fn(usize) -> Vec<f64>, within: f64) {
    let honest = listed(|_, _, _| ()).photos.remove(5);
    let mut session = session;
    session.photos[5] = honest;
    let entries: Vec<PhotoEntry> = session.photos.clone();
    let scores = scored(session).unwrap();
    let reasons = reasons(&scores);
    assert_eq!(scores.photos.len(), 1, "{reasons:?}");
    assert_eq!(scores.photos[0].file, "normal_005.jpg");
    for (i, entry) in entries.iter().enumerate().filter(|(i, _)| *i != 5) {
        let reason = reasons[entry.file.as_str()];
        let own = reason.split(key).nth(1).expect(reason);
        let viewpoint = entry.viewpoint.unwrap();
        let listed = match key {
            "azimuth_deg" => vec![viewpoint.azimuth_deg],
            "pitch_deg" => vec![viewpoint.pitch_deg],
            "distance_mm" => vec![viewpoint.distance_mm],
            _ => {
                let b = entry.box_xyxy_px.unwrap();
                vec![b.x1, b.y1, b.x2, b.y2]
            }
        };
        assert_eq!(numbers(own, " is ", " in the list"), listed, "{reason}");
        let by_tags = numbers(own, " and ", " by the tags");
        let off = by_tags.iter().zip(exact(i)).map(|(is, exact)| (is - exact).abs());
        assert!(off.fold(0.0, f64::max) < within, "{reason}");
    }
}

#[test]
fn viewpoints_a_few_degrees_off_are_honest() {
    let scores = scored(listed(|i, v, _| {
        v.azimuth_deg = (v.azimuth_deg + [352.0, 8.0][i % 2]) % 360.0;
        v.pitch_deg += 5.0;
    }))
    .unwrap();
    assert_eq!(scores.photos.len(), 16, "{:?}", reasons(&scores));
    assert!(scores.photos.iter().all(|photo| photo.tag_marks.is_empty()));
}

#[test]
fn a_list_that_tags_contradict_is_refused_with_both_values_and_then_every_photo_is_looked_at() {
    let exact = truth();
    let turned = listed(|_, v, _| v.azimuth_deg = (v.azimuth_deg + 180.0) % 360.0);
    assert_all_but_one_refused("azimuth_deg", turned, |i| vec![exact[i].0.azimuth_deg], 0.2);
    let high = listed(|_, v, _| v.pitch_deg = 80.0);
    assert_all_but_one_refused("pitch_deg", high, |i| vec![exact[i].0.pitch_deg], 0.2);
    let far = listed(|_, v, _| v.distance_mm = 5000.0);
    assert_all_but_one_refused("distance_mm", far, |i| vec![exact[i].0.distance_mm], 2.0);
    // The scene's envelope is the box of the model's size, which is larger than its outline.
    let of = |b: &BoxPx| vec![b.x1, b.y1, b.x2, b.y2];
    let elsewhere = listed(|_, _, b| *b = BoxPx::new(20.0, 30.0, 300.0, 250.0));
    assert_all_but_one_refused("box_xyxy_px", elsewhere, |i| of(&exact[i].1), 80.0);
}

#[test]
fn where_every_photo_contradicts_the_list_nothing_is_scored() {
    let error = scored(listed(|_, v, _| v.pitch_deg = 80.0)).unwrap_err().to_string();
    assert!(error.starts_with("none of the 16 photos could be scored"), "{error}");
    assert!(
        error.contains("pitch_deg is 80.0 in the list and 15.1 by the tags"),
        "{error}"
    );
}

/// One photo of eight is listed from the other side: it is found where it is the one whose tags are searched.
#[test]
fn the_tags_of_one_photo_of_each_texture_are_searched() {
    let found = |wrong: usize| {
        let mut session = listed(|_, _, _| ());
        session.photos[wrong].viewpoint = Some(turned(&session, wrong));
        let file = session.photos[wrong].file.clone();
        let scores = scored(session).unwrap();
        let reasons = reasons(&scores);
        assert!(reasons.keys().all(|left_out| *left_out == file), "{reasons:?}");
        usize::from(!reasons.is_empty())
    };
    assert_eq!((0..8).map(found).sum::<usize>(), 1);
    assert_eq!((8..16).map(found).sum::<usize>(), 1);
}

/// Where the tags are searched in any case, they are held against what is listed in every photo.
#[test]
fn a_viewpoint_or_a_box_alone_is_checked_in_every_photo() {
    for is_box in [false, true] {
        let mut session = listed(|_, _, _| ());
        for (i, entry) in session.photos.iter_mut().enumerate() {
            if is_box {
                entry.viewpoint = None;
                let elsewhere = BoxPx::new(20.0, 30.0, 300.0, 250.0);
                entry.box_xyxy_px = entry.box_xyxy_px.map(|own| if i == 3 { elsewhere } else { own });
            } else {
                entry.box_xyxy_px = None;
            }
        }
        if !is_box {
            session.photos[3].viewpoint = Some(turned(&session, 3));
        }
        let scores = scored(session).unwrap();
        let reasons = reasons(&scores);
        assert_eq!(reasons.keys().collect::<Vec<_>>(), [&"normal_003.jpg"], "{reasons:?}");
    }
}

#[test]
fn nothing_contradicts_a_list_without_tags_without_a_camera_or_without_a_pose() {
    let wrong = || listed(|_, v, _| v.pitch_deg = 80.0);
    let mut no_tags = wrong();
    no_tags.scene.tags.clear();
    let mut no_camera = wrong();
    no_camera.camera = None;
    let mut other_tags = wrong();
    other_tags.scene.tags.iter_mut().for_each(|tag| tag.id += 100);
    for session in [no_tags, no_camera, other_tags] {
        let scores = scored(session).unwrap();
        assert_eq!(scores.photos.len(), 16, "{:?}", reasons(&scores));
    }
}

/// The photos that stay and those that were left out, with their reasons.
fn results(scores: &Scores) -> String {
    let photo = |p: &scaleproof_score::ScoredPhoto| format!("{} {:?} {:?}", p.file, p.truth, p.tag_marks);
    let photos: Vec<String> = scores.photos.iter().map(photo).collect();
    format!("{photos:?} {:?}", scores.not_scored)
}

#[test]
fn kept_results_and_shards_refuse_the_same_photos() {
    let wrong_of = |photos: std::ops::Range<usize>| {
        let mut session = listed(|_, _, _| ());
        for at in photos {
            session.photos[at].viewpoint = Some(turned(&session, at));
        }
        session
    };
    // All are wrong, those of a texture, one that every run looks at, and one that shards alone look at.
    for wrong in [0..16, 0..8, 6..7, 2..3] {
        let session = || vec![wrong_of(wrong.clone())];
        let fresh = score(session(), Vec::new(), &Options::default(), || {});
        let sharded = || {
            let mut observed = BTreeMap::new();
            for index in 1..=3 {
                let id = ShardId { index, count: 3 };
                observed.extend(observe(&session(), &[], &Options::default(), id, || {}).unwrap());
            }
            merge(session(), Vec::new(), observed, None)
        };
        let folder = tempfile::tempdir().unwrap();
        let again = |folder: &Path| {
            let cache = Some(Cache::open(folder, "").unwrap());
            let options = Options {
                cache,
                ..Options::default()
            };
            score(session(), Vec::new(), &options, || {})
        };
        let said = |scores: Result<Scores, ScoreError>| scores.as_ref().map_or_else(ToString::to_string, results);
        let fresh = said(fresh);
        for other in [sharded(), again(folder.path()), again(folder.path())] {
            assert_eq!(fresh, said(other), "{wrong:?}");
        }
    }
}

/// Prints what it costs to hold tags against a list: of two photos of sixteen, and of all.
#[test]
fn a_check_changes_no_figure_of_an_honest_list() {
    let timed = |has_camera: bool, has_textures: bool| {
        let (mut photos, mut ms) = (String::new(), f64::INFINITY);
        for _ in 0..5 {
            let mut session = listed(|_, _, _| ());
            session.camera = session.camera.filter(|_| has_camera);
            for (i, entry) in session.photos.iter_mut().enumerate().filter(|_| has_textures) {
                entry.variant = format!("{} {i}", entry.variant);
            }
            let options = Options {
                threads: 1,
                ..Options::default()
            };
            let begun = Instant::now();
            photos = results(&score(vec![session], Vec::new(), &options, || {}).unwrap());
            ms = ms.min(begun.elapsed().as_secs_f64() * 1e3);
        }
        (photos, ms)
    };
    let [(unchecked, ms), (checked, two_ms), (all_checked, all_ms)] =
        [(false, false), (true, false), (true, true)].map(|(camera, textures)| timed(camera, textures));
    assert_eq!(unchecked, checked);
    assert_eq!(unchecked, all_checked);
    println!(
        "16 listed photos, one thread, no detectors: {ms:.0} ms without a check, {two_ms:.0} ms with two, {all_ms:.0} ms with all"
    );
}
