//! `scaleproof scene show`: what a scene says.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::answer::told;
use crate::cli::{CommandResult, units};
use scaleproof_core::spelling::{choose, count, list};
use scaleproof_plot::lettering::number;
use scaleproof_pose::scene::Scene;
use scaleproof_session::envelope::{self, EnvelopeShape};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The scene file
    #[arg(value_name = "TOML")]
    scene: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// `scene show --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Shown {
    name: String,
    /// 10 for a 1:10 model.
    scale: f64,
    /// The labels that count as the model.
    classes: Vec<String>,
    /// Length, width, height of the printed model.
    size_mm: [f64; 3],
    /// What truth boxes are drawn around: `box`, `hull` or `mesh`.
    envelope: &'static str,
    /// The mesh's path; `null` without one.
    mesh: Option<PathBuf>,
    /// Where the front and the top are in the mesh's file; `null` where its format says so.
    mesh_axes: Option<[String; 2]>,
    /// The materials that are the paint; empty when all of the mesh is, or when `paint_faces` says it.
    paint_materials: Vec<String>,
    /// The path of the file that lists the painted triangles.
    paint_faces: Option<PathBuf>,
    /// How many there are of each family.
    tags: BTreeMap<&'static str, usize>,
    /// Bins in which photos are counted.
    bins: usize,
}

pub(super) fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let scene = Scene::open(&args.scene)?;
    let folder = args.scene.parent().unwrap_or(Path::new(""));
    // A mesh that cannot be the model is said here, before anything is printed or photographed.
    EnvelopeShape::open(&scene.model, folder)?;
    let mesh = scene.model.envelope.mesh().map(|mesh| folder.join(mesh));
    units::note(mesh.and_then(|mesh| envelope::lies_otherwise(&mesh, &scene.model)));
    let (model, bins) = (&scene.model, &scene.bins);
    let mut tags: BTreeMap<&'static str, Vec<u32>> = BTreeMap::new();
    for tag in &scene.tags {
        tags.entry(tag.family.name()).or_default().push(tag.id);
    }
    let (paint_materials, paint_faces) = model.mesh.paint.named();
    let shown = Shown {
        name: model.name.clone(),
        scale: model.scale,
        classes: model.class.labels().to_vec(),
        size_mm: model.size_mm,
        envelope: model.envelope.name(),
        mesh: model.envelope.mesh().map(|mesh| folder.join(mesh)),
        mesh_axes: model.mesh.axes.map(|axes| axes.map(|axis| axis.to_string())),
        paint_materials: paint_materials.to_vec(),
        paint_faces: paint_faces.map(|path| folder.join(path)),
        tags: tags.iter().map(|(family, ids)| (*family, ids.len())).collect(),
        bins: bins.count(),
    };
    let words = in_words(&shown, &scene, &tags);
    units::note(units::model(model.class.labels(), model.size_mm, model.scale));
    told(args.json, shown, words, out)
}

fn in_words(shown: &Shown, scene: &Scene, tags: &BTreeMap<&str, Vec<u32>>) -> String {
    let bins = &scene.bins;
    let mut lines = vec![
        format!(
            "model  {}, 1:{}, counts as {}",
            shown.name,
            number(shown.scale),
            scene.model.class
        ),
        format!(
            "size   {} mm (length × width × height), {} of the real thing",
            units::sides(&shown.size_mm, " × "),
            units::real(shown.size_mm, shown.scale)
        ),
    ];
    match (&shown.mesh, &shown.mesh_axes) {
        (None, _) => lines.push("mesh   none; commands that need a surface take the box of this size".into()),
        (Some(mesh), Some([front, up])) => {
            lines.push(format!(
                "mesh   {}; in the file its front is to {front} and its top to {up}",
                mesh.display()
            ));
        }
        (Some(mesh), None) => lines.push(format!("mesh   {}; it lies as its format says", mesh.display())),
    }
    let paint = match (&shown.paint_faces, &shown.paint_materials[..]) {
        (Some(path), _) => format!("the triangles that {} lists", path.display()),
        (None, []) => "all of it".into(),
        (None, names) => names.join(", "),
    };
    lines.push(format!("paint  {paint}"));
    lines.push(format!(
        "truth  boxes around the model's {}",
        match shown.envelope {
            "box" => "box, which is larger than its outline",
            "hull" => "convex hull",
            _ => "outline",
        }
    ));
    for (family, ids) in tags {
        let mut sizes: Vec<f64> = scene
            .tags
            .iter()
            .filter(|tag| tag.family.name() == *family)
            .map(|tag| tag.size_mm)
            .collect();
        sizes.sort_by(f64::total_cmp);
        sizes.dedup();
        lines.push(format!(
            "tags   {} of {family}, {} mm wide: {}",
            ids.len(),
            units::sides(&sizes, " and "),
            list(ids)
        ));
    }
    if tags.is_empty() {
        lines.push("tags   none: photos need a known viewpoint".into());
    }
    let counts = [bins.pitch_deg.len(), bins.distance_mm.len()];
    lines.push(format!(
        "bins   {}: an azimuth every {}°, {} and {} of the camera",
        shown.bins,
        number(bins.azimuth_deg),
        format_args!("{} {}", counts[0], choose(counts[0], "pitch", "pitches")),
        count(counts[1], "distance"),
    ));
    lines.join("\n")
}
