//! A scene as the text of a `scene.toml`.

use super::{Scene, Tag, TagFamily};

impl Scene {
    /// The file that [`Scene::parse`] reads back, places to a thousandth of a millimetre.
    pub fn to_toml(&self) -> String {
        let model = &self.model;
        let (name, class) = (toml::Value::from(model.name.as_str()), model.class.to_toml());
        let mesh = model.envelope.mesh().map(|path| {
            let path = toml::Value::from(path.to_string_lossy().into_owned());
            format!("mesh = {path}\n")
        });
        let mesh = mesh.unwrap_or_default();
        let head = format!(
            "# Millimetres; model frame: x to the front, y to the left, z up, origin on the ground under the model's centre.\n\n\
             [model]\nname = {name}\nscale = {}\nclass = {class}\nsize_mm = {}\nenvelope = \"{}\"\n{mesh}\n\
             [bins]\nazimuth_deg = {}\npitch_deg = {}\ndistance_mm = {}\n",
            model.scale,
            list(&model.size_mm, 3),
            model.envelope.name(),
            self.bins.azimuth_deg,
            list(&self.bins.pitch_deg, 3),
            list(&self.bins.distance_mm, 3),
        );
        self.tags.iter().fold(head, |text, tag| text + &table(tag))
    }
}

fn table(tag: &Tag) -> String {
    let is_named = tag.family != TagFamily::default();
    let family = is_named.then(|| format!("family = \"{}\"\n", tag.family.name()));
    let sigma = |s: super::TagSigma| format!("sigma_mm = {:.4}\nsigma_deg = {:.4}\n", s.mm, s.deg);
    format!(
        "\n[[tag]]\nid = {}\n{}size_mm = {}\ncentre_mm = {}\nright = {}\nup = {}\n{}",
        tag.id,
        family.unwrap_or_default(),
        tag.size_mm,
        list(tag.centre_mm.coords.as_slice(), 3),
        list(tag.right.as_slice(), 7),
        list(tag.up.as_slice(), 7),
        tag.sigma.map(sigma).unwrap_or_default(),
    )
}

/// Numbers with as many decimals as they need, and no minus before a zero.
fn list(values: &[f64], decimals: usize) -> String {
    let unit = 10_f64.powi(decimals as i32);
    let number = |value: &f64| format!("{:?}", (value * unit).round() / unit + 0.0);
    format!("[{}]", values.iter().map(number).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;

    use super::super::{Bins, Envelope, ScaleModel, TagRing};
    use super::*;

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
        ) {
            let model = ScaleModel { name, scale: 10.0, class: class.parse().unwrap(), size_mm: [455.0, 186.5, 128.0], envelope };
            let bins = Bins { azimuth_deg: 45.0, pitch_deg: vec![0.0, 15.0], distance_mm: vec![850.0] };
            let mut scene = TagRing { model, bins, radius_mm, count, tag_mm, family: family.0, tilt_deg }.scene().unwrap();
            scene.tags[0].sigma = Some(super::super::TagSigma { mm: tilt_deg / 64.0, deg: radius_mm / 8192.0 });
            let back = Scene::parse(&scene.to_toml(), Path::new("scene.toml")).unwrap();
            prop_assert_eq!((&scene.model, &scene.bins), (&back.model, &back.bins));
            for (tag, read) in scene.tags.iter().zip(&back.tags) {
                prop_assert_eq!((tag.id, tag.family, tag.size_mm), (read.id, read.family, read.size_mm));
                prop_assert!((tag.centre_mm - read.centre_mm).norm() < 0.001);
                let off = |a: Option<super::super::TagSigma>, b: Option<super::super::TagSigma>| match (a, b) {
                    (Some(a), Some(b)) => (a.mm - b.mm).abs().max((a.deg - b.deg).abs()),
                    (None, None) => 0.0,
                    _ => f64::INFINITY,
                };
                prop_assert!(off(tag.sigma, read.sigma) < 1e-4);
                prop_assert!(tag.right.angle(&read.right) < 1e-6 && tag.up.angle(&read.up) < 1e-6);
            }
        }
    }
}
