//! Writing `scene.toml`.

use proptest::prelude::*;
use scaleproof_pose::scene::{Bins, Envelope, MeshFacts, Paint, ScaleModel, Scene, TagFamily, TagRing, TagSigma};
use std::path::Path;

proptest! {
    /// Whatever the ring, its file says the same.
    #[test]
    fn a_written_scene_reads_back(
        radius_mm in 1100.0..2500.0_f64,
        count in 3_u32..10,
        tag_mm in 20.0..90.0_f64,
        tilt_deg in 30.0..75.0_f64,
        family in prop::sample::select(TagFamily::ALL.to_vec()),
        name in "\\PC{0,12}",
        class in prop::sample::select(vec!["car", "car,truck", "a \"b\",c"]),
        envelope in prop::sample::select(vec![Envelope::Box, Envelope::Hull("a \"b\".stl".into()), Envelope::Mesh("m/c.glb".into())]),
        paint in prop::sample::select(vec![Paint::All, Paint::Materials(vec!["a \"b\"".into(), "c".into()]), Paint::Faces("f \"x\".txt".into())]),
        axes in prop::sample::select(vec![None, Some(["-x", "+y"])]),
    ) {
        let axes = axes.map(|words| words.map(|word| word.parse().unwrap()));
        let mesh = if envelope == Envelope::Box { MeshFacts::default() } else { MeshFacts { axes, paint } };
        let model = ScaleModel { name, scale: 10.0, class: class.parse().unwrap(), size_mm: [455.0, 186.5, 128.0], envelope, mesh };
        let bins = Bins { azimuth_deg: 45.0, pitch_deg: vec![0.0, 15.0], distance_mm: vec![850.0] };
        let mut scene = TagRing { model, bins, radius_mm, count, tag_mm, family: family.0, tilt_deg }.scene().unwrap();
        scene.tags[0].sigma = Some(TagSigma { mm: tilt_deg / 64.0, deg: radius_mm / 8192.0 });
        let back = Scene::parse(&scene.to_toml(), Path::new("scene.toml")).unwrap();
        prop_assert_eq!((&scene.model, &scene.bins), (&back.model, &back.bins));
        for (tag, read) in scene.tags.iter().zip(&back.tags) {
            prop_assert_eq!((tag.id, tag.family, tag.size_mm), (read.id, read.family, read.size_mm));
            prop_assert!((tag.centre_mm - read.centre_mm).norm() < 0.001);
            let off = |a: Option<TagSigma>, b: Option<TagSigma>| match (a, b) {
                (Some(a), Some(b)) => (a.mm - b.mm).abs().max((a.deg - b.deg).abs()),
                (None, None) => 0.0,
                _ => f64::INFINITY,
            };
            prop_assert!(off(tag.sigma, read.sigma) < 1e-4);
            prop_assert!(tag.right.angle(&read.right) < 1e-6 && tag.up.angle(&read.up) < 1e-6);
        }
    }
}
