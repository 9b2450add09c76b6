//! Writing of a scene as `scene.toml`.

use super::{MeshFacts, Paint, Scene, Tag, TagFamily};

impl Scene {
    /// Returns the file that [`Scene::parse`] reads back, with positions to a thousandth of a millimetre.
    pub fn to_toml(&self) -> String {
        let model = &self.model;
        let (name, class) = (toml::Value::from(model.name.as_str()), model.class.to_toml());
        let mesh = model.envelope.mesh().map(|path| {
            let path = toml::Value::from(path.to_string_lossy().into_owned());
            format!("mesh = {path}\n")
        });
        let mesh = mesh.unwrap_or_default() + &facts(&model.mesh);
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

fn facts(mesh: &MeshFacts) -> String {
    let axes = mesh
        .axes
        .map(|[front, up]| format!("mesh_front = \"{front}\"\nmesh_up = \"{up}\"\n"));
    let paint = match &mesh.paint {
        Paint::All => None,
        Paint::Materials(names) => Some(toml::Value::from(names.clone())),
        Paint::Faces(path) => Some(toml::Value::from(path.to_string_lossy().into_owned())),
    };
    let paint = paint.map(|paint| format!("paint = {paint}\n"));
    axes.unwrap_or_default() + &paint.unwrap_or_default()
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

/// Formats numbers with as many decimals as they need, and no minus before a zero.
fn list(values: &[f64], decimals: usize) -> String {
    let unit = 10_f64.powi(decimals as i32);
    let number = |value: &f64| format!("{:?}", (value * unit).round() / unit + 0.0);
    format!("[{}]", values.iter().map(number).collect::<Vec<_>>().join(", "))
}
