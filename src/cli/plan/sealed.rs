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
use scaleproof_core::{files, spelling};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_score as score;
use scaleproof_score::{Aim, ClusteredBy, Endpoint, PlanError, Protocol, SealedDetector, SealedPlan, Stopping};
use scaleproof_surface::pattern::Pattern;

/// What a sealed plan fixes.
#[derive(clap::Args)]
pub(super) struct Sealing {
    /// Fix the experiment before its photos are taken, in a new file that `compare --plan` holds it against: textures, detectors, thresholds, views, places, the drop
    /// that shall be shown with which power, and when it stops. With --scene, --drop, --texture and --detector; --sequential and --least as for `compare`.
    #[arg(long, value_name = "JSON", requires_all = ["scene", "textures", "detectors", "drop"])]
    pub(super) seal: Option<PathBuf>,
    /// With --seal: a texture that will be photographed, with the file of its pattern where there is one; once for each.
    #[arg(long = "texture", value_name = "NAME[=PNG]", requires = "seal", num_args = 1..)]
    textures: Vec<String>,
    /// With --seal: the texture that the others are held against.
    #[arg(long, value_name = "NAME", default_value = score::BASE_VARIANT)]
    base: String,
    /// With --seal: a detector that will look; once for each, or a list with commas.
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',', requires = "seal")]
    pub(super) detectors: Vec<String>,
    /// With --seal: places that are photographed.
    #[arg(long, default_value_t = 1, requires = "seal", value_parser = clap::value_parser!(u16).range(1..=200))]
    places: u16,
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
    aim: Aim,
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
    let views = args.views(&scene)?;
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
        views: views
            .iter()
            .map(|v| [v.azimuth_deg, v.pitch_deg, v.distance_mm])
            .collect(),
        places: sealing.places,
        stopping,
        aim: None,
    };
    let aim = aim(args, &plan)?;
    let plan = SealedPlan { aim: Some(aim), ..plan };
    let photos = plan.photos();
    let seal = plan.write(path)?;
    let file = path.display();
    let words = format!(
        "plan: {file} ({photos} photos)\n{}\nseal: {seal}\nPublish the seal before the first photo; `compare --plan {file}` states it and lists whatever differs.",
        aim_in_words(&aim, sealing.places, stopping)
    );
    let plan = path.to_owned();
    told(
        args.json,
        Sealed {
            plan,
            seal,
            photos,
            aim,
        },
        words,
        out,
    )
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

/// Returns the effect that the experiment is to show, with the number of places that it needs.
fn aim(args: &Args, plan: &SealedPlan) -> Result<Aim> {
    let (views, textures) = (plan.views.len(), plan.textures.len() - 1);
    let question = args.asked_of(plan.detectors.len(), textures)?;
    let needed = match plan.stopping {
        Stopping::EveryView => question.views_needed().map(|needed| needed.views),
        Stopping::Decided { .. } => args.simulated(&question, views).map(|plan| plan.most_views),
    };
    let places_needed = match needed {
        Err(PlanError::TooMany) => None,
        needed => Some(needed?.div_ceil(views)),
    };
    Ok(Aim {
        primary_endpoint: Endpoint::MeanConfidence,
        drop: question.drop,
        base_rate: None,
        power: question.power,
        comparisons: plan.detectors.len() * textures,
        places_needed,
        spread: Some(question.spread),
    })
}

/// The aim and the stop in two sentences.
fn aim_in_words(aim: &Aim, places: u16, stopping: Stopping) -> String {
    let Aim { drop, power, .. } = aim;
    let among = match aim.comparisons {
        1 => String::new(),
        n => format!(", for one of {n} comparisons (detectors × textures)"),
    };
    let looks = match stopping {
        Stopping::EveryView => "looked at once, when every view is there",
        Stopping::Decided { .. } => "looked at after each pair until it is decided",
    };
    let planned = spelling::count(usize::from(places), "place");
    let enough = match aim.places_needed {
        Some(needed) if needed <= usize::from(places) => format!(
            "it takes {}, and {planned} are planned",
            spelling::count(needed, "place")
        ),
        Some(needed) => {
            format!("{planned} planned: too few, it takes {needed} (--places {needed}, or a larger --drop)")
        }
        None => format!("{planned} planned: too few, as any number of photos: plan for a larger --drop"),
    };
    format!(
        "primary endpoint: mean confidence, {looks}\nto be shown: a drop of {drop} with a chance of {power}{among}: {enough}"
    )
}
