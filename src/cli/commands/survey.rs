//! `scaleproof survey`: where do the tags stand that were placed by hand?

use std::error::Error;
use std::io::Write;
use std::path::Path;

use crate::cli::args::survey::Args;
use crate::cli::print::survey::json;
use crate::cli::{CommandResult, Outcome, advice, photos, progress};
use scaleproof_core::files;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, TagFamily};
use scaleproof_print::tags::arrange;
use scaleproof_rig::survey::{LeftOutReason, Survey, SurveyInput, SurveyPhotos, detect_tags, survey};

pub fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
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

/// Returns the advice on an error of the library, or on a tag that is left out.
pub fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        LeftOutReason::NoSize => "name it in --sizes",
    }
}

pub fn fixed(args: &Args, scene: &Scene) -> Result<Vec<(TagFamily, u32)>, String> {
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
