//! `plan --seal`: what is decided before the photos are taken.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::super::criteria::Reading;
use super::super::patterns::named;
use super::super::{CommandResult, Result, detectors};
use super::Args;
use crate::cli::answer::told;
use scaleproof_core::files;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bins, Scene};
use scaleproof_score::score::{self, ClusteredBy, Protocol, SealedDetector, SealedPlan, Stopping};
use scaleproof_surface::pattern::Pattern;

/// What a sealed plan fixes.
#[derive(clap::Args)]
pub(super) struct Sealing {
    /// Fix the experiment before its photos are taken, in a new file that `compare --plan` holds it against: textures, detectors, thresholds, views, places and when
    /// it stops. With --scene, --texture and --detector; --sequential and --least as for `compare`.
    #[arg(long, value_name = "JSON", requires_all = ["scene", "textures", "detectors"], conflicts_with = "drop")]
    pub(super) seal: Option<PathBuf>,
    /// With --seal: a texture that will be photographed, with the file of its pattern where there is one; once for each.
    #[arg(long = "texture", value_name = "NAME[=PNG]", requires = "seal", num_args = 1..)]
    textures: Vec<String>,
    /// With --seal: the texture that the others are held against.
    #[arg(long, value_name = "NAME", default_value = score::BASE_VARIANT)]
    base: String,
    /// With --seal: a detector that will look; once for each, or a list with commas.
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',', requires = "seal")]
    detectors: Vec<String>,
    /// With --seal: pitches of the scene's bins that are photographed [default: the one nearest to 15°]
    #[arg(
        long,
        value_name = "DEG,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "seal"
    )]
    pitch_deg: Vec<f64>,
    /// With --seal: distances of the scene's bins that are photographed [default: the middle one]
    #[arg(long, value_name = "MM,…", value_delimiter = ',', requires = "seal")]
    distance_mm: Vec<f64>,
    /// With --seal: the camera's file, which is then fixed, too.
    #[arg(long, value_name = "FILE", requires = "seal")]
    camera: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

/// `plan --seal --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Sealed {
    /// The path of the plan.
    plan: PathBuf,
    /// SHA-256 of what it says.
    seal: String,
    /// Photos that it asks for.
    photos: usize,
}

pub(super) fn seal(path: &Path, scene_file: &Path, args: &Args, out: &mut dyn Write) -> CommandResult {
    let sealing = &args.sealing;
    let scene = Scene::open(scene_file)?;
    let folder = scene_file.parent().unwrap_or(Path::new(""));
    if let Some(camera) = &sealing.camera {
        Camera::open(camera)?;
    }
    let hash = |path: &Path| files::read(path).map(|bytes| files::sha256_hex(&bytes));
    let criteria = sealing.reading.criteria()?;
    let manifests = detectors::chosen(&sealing.detectors)?;
    let sealed = manifests.iter().map(|m| Ok((m.name.clone(), SealedDetector::of(m)?)));
    let stopping = if args.sequential {
        Stopping::Decided {
            look_after_each: ClusteredBy::PlaceAndBin,
            least: args.least,
        }
    } else {
        Stopping::EveryView
    };
    let mesh = scene.model.envelope.mesh();
    let plan = SealedPlan {
        scaleproof: env!("CARGO_PKG_VERSION").into(),
        textures: textures(&sealing.textures, &sealing.base)?,
        base: sealing.base.clone(),
        classes: scene.model.class.clone(),
        ap: criteria.ap.name().into(),
        hit_confidence: criteria.hit_confidence,
        match_iou: criteria.match_iou(),
        protocol: criteria.protocol.map(Protocol::name).map(str::to_owned),
        detectors: sealed.collect::<Result<_>>()?,
        scene_sha256: hash(scene_file)?,
        mesh_sha256: mesh.map(|mesh| hash(&folder.join(mesh))).transpose()?,
        camera_sha256: sealing.camera.as_deref().map(hash).transpose()?,
        views: views(sealing, &scene.bins)?,
        places: args.places,
        stopping,
    };
    let photos = plan.photos();
    let seal = plan.write(path)?;
    let file = path.display();
    let words = format!(
        "plan: {file} ({photos} photos)\nseal: {seal}\nPublish the seal before the first photo; `compare --plan {file}` states it and lists whatever differs."
    );
    let plan = path.to_owned();
    told(args.json, Sealed { plan, seal, photos }, words, out)
}

fn textures(given: &[String], base: &str) -> Result<BTreeMap<String, Option<String>>> {
    let mut textures = BTreeMap::new();
    for text in given {
        let (name, sha256) = if text.contains('=') {
            let (name, path) = named(text)?;
            (name, Some(Pattern::load(path)?.sha256().to_owned()))
        } else {
            (text.as_str(), None)
        };
        if name.trim().is_empty() {
            return Err(format!("the texture {text:?} has no name").into());
        }
        if textures.insert(name.to_owned(), sha256).is_some() {
            return Err(format!("the texture {name} is named twice").into());
        }
    }
    if !textures.contains_key(base) || textures.len() < 2 {
        return Err(
            format!("name the base with --texture {base}, and at least one texture that is held against it").into(),
        );
    }
    Ok(textures)
}

/// The bins that are photographed.
fn views(sealing: &Sealing, bins: &Bins) -> Result<Vec<[f64; 3]>> {
    let (pitch, distance) = bins.usual_view();
    let of = |given: &[f64], usual: f64, all: &[f64], what: &str| -> Result<Vec<f64>> {
        let is_odd = |v: &&f64| !all.iter().any(|centre| (centre - *v).abs() < 1e-6);
        if let Some(odd) = given.iter().find(is_odd) {
            let all: Vec<String> = all.iter().map(f64::to_string).collect();
            return Err(format!("--{what} {odd} is no bin of the scene: it has {}", all.join(", ")).into());
        }
        Ok(if given.is_empty() { vec![usual] } else { given.to_vec() })
    };
    let pitches = of(&sealing.pitch_deg, pitch, &bins.pitch_deg, "pitch-deg")?;
    let distances = of(&sealing.distance_mm, distance, &bins.distance_mm, "distance-mm")?;
    let views = bins.viewpoints(&pitches, &distances);
    Ok(views
        .iter()
        .map(|v| [v.azimuth_deg, v.pitch_deg, v.distance_mm])
        .collect())
}
