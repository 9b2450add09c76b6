//! `scaleproof survey`: where do the tags stand that were placed by hand?

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::{CommandResult, Outcome, advice, photos, progress, scene};
use scaleproof_core::files;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_print::tags::arrange;
use scaleproof_rig::survey::{
    LeftOutReason, PhotoReport, Sizes, Survey, SurveyInput, SurveyPhotos, TagReport, detect_tags, survey,
};

/// Find out from photos where tags stand that were placed by hand, and write it as a scene.toml.
///
/// Only the sizes of the tags are needed, and some tags whose place is known: a printed ground mat, or one tag. Exit code 2
/// when a file is bad or the photos do not say where the tags stand; nothing is written then.
#[derive(clap::Args)]
pub(in crate::cli) struct Args {
    /// Photos (JPEG or PNG), or folders of them, of the tags from all sides; each shows tags that others show too
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// Camera file: OpenCV or ROS camera_info YAML
    #[arg(long)]
    camera: PathBuf,
    /// Scene file with the model, the bins, and where the fixed tags stand; of other tags only the size is used
    #[arg(long)]
    scene: PathBuf,
    /// Tags that keep their place of the scene file: `mat` for all that lie on the ground (the printed ground mat), or ids as in 0,5
    #[arg(long, value_name = "mat|ID,…")]
    fixed: String,
    /// Outer edge of the tags' black borders in mm, as in 50, or 0-7:50,8-15:40; without it those of the scene file
    #[arg(long, value_name = "MM|ID-ID:MM,…", allow_hyphen_values = true)]
    sizes: Option<Sizes>,
    /// Family of the tags that --fixed and --sizes name
    #[arg(long, default_value = "tag36h11", value_parser = scene::family)]
    family: TagFamily,
    /// The scene file to write
    #[arg(short, long, alias = "out", value_name = "TOML")]
    output: PathBuf,
    /// A JSON object instead of tables
    #[arg(long)]
    json: bool,
}

pub(in crate::cli) fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    args.photos = photos::of(&args.photos)?;
    let scene = for_output(Scene::open(&args.scene)?, &args)?;
    let camera = Camera::open(&args.camera)?;
    let fixed = fixed(&args, &scene)?;
    let SurveyPhotos { photos, cautions } = progress::photos("finding tags", args.photos.len())
        .during(|bar| detect_tags(&args.photos, &scene, args.family, &camera, || bar.inc(1)))?;
    let given = SurveyInput {
        scene: &scene,
        fixed: &fixed,
        sizes: args.sizes.as_ref(),
        family: args.family,
    };
    let found = progress::busy("adjusting").during(|_| survey(&photos, &given, &camera))?;
    let text = found.scene.to_toml();
    // The reader's checks are the checks.
    Scene::parse(&text, &args.output)?;
    files::write_atomically(&args.output, text.as_bytes())?;
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&json(&found))?)?;
    } else {
        write_tables(&found, out)?;
        writeln!(out, "{}: {} tags", args.output.display(), found.scene.tags.len())?;
    }
    cautions.iter().for_each(|caution| say!("note: {caution}"));
    Ok(Outcome::Done)
}

/// The scene with its mesh named so that a scene file in the output's folder finds it.
fn for_output(mut scene: Scene, args: &Args) -> std::io::Result<Scene> {
    let (from, to) = (args.scene.parent(), args.output.parent());
    if from != to {
        let folder = std::path::absolute(from.unwrap_or(Path::new("")).join("."))?;
        scene.model = scene.model.with_files(|file| folder.join(file));
    }
    Ok(scene)
}

/// What to do about an error of the library, or about a tag that is left out.
pub(in crate::cli) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        LeftOutReason::NoSize => "name it in --sizes",
    }
}

fn fixed(args: &Args, scene: &Scene) -> Result<Vec<(TagFamily, u32)>, String> {
    if args.fixed == "mat" {
        let mat: Vec<_> = arrange(scene).flat.iter().map(|t| (t.family, t.id)).collect();
        return if mat.is_empty() {
            Err(format!(
                "{} has no tag that lies on the ground: name the fixed tags by id",
                args.scene.display()
            ))
        } else {
            Ok(mat)
        };
    }
    let id = |text: &str| text.trim().parse().map(|id| (args.family, id));
    let ids: Result<Vec<_>, _> = args.fixed.split(',').map(id).collect();
    ids.map_err(|_| format!("--fixed `{}` is neither `mat` nor tag ids as in 0,5", args.fixed))
}

/// `survey --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct SurveyJson<'a> {
    /// Standard deviation of a corner coordinate, from the residuals.
    noise_px: f64,
    /// How far all tag edges were found too far in; taken out of the result.
    edge_shift_px: f64,
    /// How far the lens that the photos fit, and that was taken, moves a tag's corner at most from where the camera file has it; `null` where the file's fits.
    lens_px: Option<f64>,
    tags: &'a [TagReport],
    left_out: Vec<LeftOutJson>,
    /// In the order given.
    photos: &'a [PhotoReport],
}

/// A seen tag that is not in the scene.
#[derive(Serialize, JsonSchema)]
struct LeftOutJson {
    id: u32,
    family: TagFamily,
    /// Why the tag is not in the scene, as a word for programs (explained in codes.md).
    code: &'static str,
    /// Why the tag is not in the scene, as a sentence.
    reason: String,
}

fn json(found: &Survey) -> SurveyJson<'_> {
    let left_out = found.left_out.iter().map(|left| LeftOutJson {
        id: left.id,
        family: left.family,
        code: left.reason.code(),
        reason: advice::sentence(&left.reason),
    });
    SurveyJson {
        noise_px: found.noise_px,
        edge_shift_px: found.edge_shift_px,
        lens_px: found.lens_px,
        tags: &found.tags,
        left_out: left_out.collect(),
        photos: &found.photos,
    }
}

fn write_tables(found: &Survey, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{:>5} {:>7} {:>12} {:>10} {:>24}",
        "tag", "photos", "±σ place", "±σ turn", "from the given place"
    )?;
    for tag in &found.tags {
        let (place, turn) = match (tag.sigma_mm, tag.sigma_deg) {
            (Some(mm), Some(deg)) => (format!("{mm:.3} mm"), format!("{deg:.3}°")),
            _ => ("fixed".to_owned(), String::new()),
        };
        let shift = match (tag.shift_mm, tag.shift_deg) {
            (Some(mm), Some(deg)) if !tag.is_fixed => format!("{mm:.2} mm, {deg:.2}°"),
            _ => String::new(),
        };
        let (id, photos) = (tag.id, tag.photos);
        writeln!(out, "{id:>5} {photos:>7} {place:>12} {turn:>10} {shift:>24}")?;
    }
    let once = found.tags.iter().filter(|tag| !tag.cautions.is_empty());
    let once: Vec<String> = once.map(|tag| tag.id.to_string()).collect();
    if !once.is_empty() {
        writeln!(
            out,
            "caution: only one photo each shows tags {}, so that nothing checks their size, or that they did not move",
            once.join(", ")
        )?;
    }
    for left in &found.left_out {
        writeln!(out, "left out: tag {} {}", left.id, advice::sentence(&left.reason))?;
    }
    for photo in found.photos.iter().filter(|p| p.tags.is_empty()) {
        writeln!(out, "not used: {}, which shows no tag that helps", photo.name)?;
    }
    let used = found.photos.iter().filter(|p| !p.tags.is_empty()).count();
    writeln!(
        out,
        "{used} photos, corners within ±{:.2} px (σ), all tag edges {:.2} px too far in",
        found.noise_px, found.edge_shift_px
    )?;
    if let Some(px) = found.lens_px {
        writeln!(
            out,
            "caution: the photos fit another lens than the camera file's, which is up to {px:.1} px off at a tag's corner. The survey took the lens that fits: \
             calibrate again with the board in the image's corners, too"
        )?;
    }
    Ok(())
}
