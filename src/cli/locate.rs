//! `scaleproof locate`: where did the camera stand in these photos?

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, Outcome, Result, photos, progress};
use scaleproof_core::geometry::angle::direction_text;
use scaleproof_core::geometry::rigid;
use scaleproof_core::{spelling, workers};
use scaleproof_photo::copies;
use scaleproof_photo::{Photo, PhotoError};
use scaleproof_pose::camera::{Camera, FittedCamera};
use scaleproof_pose::locate::{
    Abstention, BinProbability, IgnoredTag, LocateFiles, Located, LocatedPhoto, MOST_LISTED, Rival, Sigma, Warning,
    locate_photo,
};
use scaleproof_pose::scene::{Bin, Scene};
use scaleproof_pose::tags::{StartError, TagDetector, TagDetectorChoice};
use scaleproof_session::Session;
use scaleproof_session::envelope::EnvelopeShape;
use scaleproof_session::overlay;

/// Find each photo's camera pose, viewpoint and bin from the AprilTags around the model.
///
/// A photo whose pose cannot be known is answered with the reason instead. Exit code 2 when a photo cannot be read or when
/// no photo at all is located.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Photos (JPEG or PNG), or folders of them; they are never changed.
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// What stands on the table: scene.toml.
    #[arg(long)]
    scene: PathBuf,
    /// Camera file: YAML or XML of OpenCV, YAML of ROS camera_info or Kalibr, or a .cameramodel of mrcal; see `scaleproof camera`.
    #[arg(long)]
    camera: PathBuf,
    /// What finds the tags: cascade, coarse-to-fine, apriltag, aruco or locus.
    #[arg(long, value_name = "NAME", default_value_t)]
    tag_detector: TagDetectorChoice,
    /// Write copies of the photos here, with the tags, the model's box and axes, the pose or the reason drawn on them.
    #[arg(long, value_name = "DIR")]
    overlay: Option<PathBuf>,
    /// One JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
}

/// `locate --json`: one object a line for each photo, in the order given.
#[derive(Serialize, JsonSchema)]
#[allow(non_snake_case)]
pub(in crate::cli) struct OutputLine {
    /// As it was given.
    file: String,
    /// `located` or `abstained` (also of a photo that cannot be read).
    status: &'static str,
    /// Why there is no pose, as a sentence.
    reason: Option<String>,
    /// Why there is no pose, as a word for programs (explained in codes.md).
    code: Option<&'static str>,
    /// The viewpoint, with the next two.
    azimuth_deg: Option<f64>,
    pitch_deg: Option<f64>,
    distance_mm: Option<f64>,
    /// Standard deviations of the three, by corner noise, bent paper and tags that stand off.
    sigma: Option<Sigma>,
    /// The bin of the scene.
    bin: Option<Bin>,
    /// That the bin is the right one, 0 to 1.
    bin_probability: Option<f64>,
    /// Of a lone tag, also of one that gives no pose: its other pose.
    rival: Option<Rival>,
    /// Of a lone tag, also of one that gives no pose: the bins it may have been seen from, the most probable first.
    bins: Vec<BinProbability>,
    warnings: Vec<Warning>,
    /// Ids of the tags that the pose rests on.
    tags: Vec<u32>,
    /// Tags that were seen and not used, and why.
    ignored_tags: Vec<IgnoredTag>,
    /// Reprojection error, root mean square.
    rms_px: Option<f64>,
    /// The pose, mm, row by row.
    T_camera_model: Option<[[f64; 4]; 4]>,
    /// Width of the photo over that of the camera file's image; also of photos without a pose, where the camera fits them.
    camera_scale: Option<f64>,
    /// Clockwise, with the photo, as EXIF says.
    camera_turned_deg: Option<u32>,
    /// What to know before believing the pose, as sentences.
    cautions: Vec<String>,
}

/// Result of one photo, or the reason why it cannot be read.
type PhotoAnswer = Result<LocatedPhoto, PhotoError>;

/// Photos, each with what was found.
type Answered<'a> = [(&'a Path, PhotoAnswer)];

const UNREADABLE: &str = "unreadable";

pub(super) fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    args.photos = photos::of(&args.photos)?;
    let files = LocateFiles {
        scene: Scene::open(&args.scene)?,
        camera: Camera::open(&args.camera)?,
        scene_file: args.scene,
        camera_file: args.camera,
    };
    let places = |folder: &PathBuf| copies::places(folder, &args.photos, "overlay", overlay_name);
    let overlays = args.overlay.as_ref().map(places).transpose()?;
    let answers = locate_all(&args.photos, &files.scene, &files.camera, args.tag_detector)?;
    let read: Vec<_> = answers
        .iter()
        .filter_map(|(path, answer)| Some((*path, answer.as_ref().ok()?)))
        .collect();
    let cause = files.cause(&read);
    let alike = is_alike(&answers, cause.is_some());
    if args.json {
        for (path, answer) in &answers {
            writeln!(out, "{}", serde_json::to_string(&line(path, answer))?)?;
        }
    } else {
        write_table(&answers, alike, out)?;
    }
    explain(&answers, alike);
    cause.iter().for_each(|cause| say!("note: {cause}"));
    if let (Some(folder), Some(places)) = (&args.overlay, &overlays) {
        draw(&answers, places, &files)?;
        let images = spelling::count(read.len(), "image");
        say!("note: {images} of what was found in {}", folder.display());
    }
    let none_located = answers.iter().all(|(_, answer)| located(answer).is_none());
    Ok(if read.len() < answers.len() || none_located {
        Outcome::SomeInputBad
    } else {
        Outcome::Done
    })
}

/// Locates the photos of a session and returns how many have a pose. With `table`, writes the answers into it and explains them on standard error.
pub(super) fn count_located(session: &Session, table: Option<&mut dyn Write>) -> Result<usize> {
    let photos: Vec<PathBuf> = session.photos.iter().map(|p| session.photo_path(p)).collect();
    let answers = locate_all(
        &photos,
        &session.scene,
        session.known_camera()?,
        TagDetectorChoice::default(),
    )?;
    if let Some(table) = table {
        write_table(&answers, false, table)?;
        explain(&answers, false);
    }
    Ok(answers.iter().filter(|(_, answer)| located(answer).is_some()).count())
}

/// One answer per photo, in their order.
fn locate_all<'a>(
    photos: &'a [PathBuf],
    scene: &Scene,
    camera: &Camera,
    tag_detector: TagDetectorChoice,
) -> Result<Vec<(&'a Path, PhotoAnswer)>, StartError> {
    let families = scene.families();
    let look = |tags: &mut Box<dyn TagDetector>, path: &PathBuf| {
        let photo = Photo::open(path);
        let note = photo.as_ref().ok().and_then(Photo::note);
        Ok((note, photo.and_then(|photo| locate_photo(&photo, scene, camera, tags))))
    };
    let looked = progress::photos("locating", photos.len())
        .during(|bar| workers::map(photos, || tag_detector.open(&families), look, || bar.inc(1)))?;
    let (notes, answers): (Vec<_>, Vec<_>) = looked.into_iter().unzip();
    notes.iter().flatten().for_each(|note| say!("note: {note}"));
    Ok(photos.iter().map(PathBuf::as_path).zip(answers).collect())
}

fn located(answer: &PhotoAnswer) -> Option<&Located> {
    answer.as_ref().ok()?.result.as_ref().ok()
}

/// Why a photo that could be read has no pose.
fn abstention(answer: &PhotoAnswer) -> Option<&Abstention> {
    answer.as_ref().ok()?.result.as_ref().err()
}

/// The photos that could be read and have no pose, and why.
fn abstained<'a>(answers: &'a Answered) -> impl Iterator<Item = (&'a Path, &'a Abstention)> {
    answers
        .iter()
        .filter_map(|(path, answer)| Some((*path, abstention(answer)?)))
}

/// The word for programs why there is no pose.
fn code(answer: &PhotoAnswer) -> Option<&'static str> {
    match answer {
        Ok(examined) => examined.result.as_ref().err().map(Abstention::code),
        Err(_) => Some(UNREADABLE),
    }
}

/// Returns true if the photos without a pose are reported together: they have one cause, or no photo has a pose and all lack it for one reason.
fn is_alike(answers: &Answered, has_cause: bool) -> bool {
    let codes: BTreeSet<Option<&str>> = answers.iter().map(|(_, answer)| code(answer)).collect();
    abstained(answers).count() > MOST_LISTED && (has_cause || codes.len() == 1)
}

/// `alike`: one row for all photos that were read and have no pose.
fn write_table(answers: &Answered, alike: bool, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<28} {:>9} {:>7} {:>8} {:>11} {:>16} {:>6} {:>5} {:>7}",
        "photo", "azimuth", "±", "pitch", "distance", "bin", "sure", "tags", "rms"
    )?;
    for (path, answer) in answers
        .iter()
        .filter(|(_, answer)| !alike || abstention(answer).is_none())
    {
        writeln!(out, "{}", row(path, answer))?;
    }
    if alike {
        let codes: BTreeSet<&str> = abstained(answers).map(|(_, reason)| reason.code()).collect();
        let codes: Vec<&str> = codes.into_iter().collect();
        writeln!(out, "{}: no pose ({})", without_pose(answers), codes.join(", "))?;
    }
    Ok(())
}

/// `all 24 photos`, `23 of 24 photos`.
fn without_pose(answers: &Answered) -> String {
    let count = abstained(answers).count();
    if count == answers.len() {
        format!("all {count} photos")
    } else {
        format!("{count} of {} photos", answers.len())
    }
}

/// Says on standard error why photos got no pose, which tags were rejected, and once each what to know before believing
/// the answers.
fn explain(answers: &Answered, alike: bool) {
    for (path, found) in answers
        .iter()
        .filter_map(|(path, answer)| Some((path.display(), located(answer)?)))
    {
        for tag in found.ignored_tags.iter().filter(|tag| tag.why.is_outlier()) {
            say!("note on {path}: tag {} {}; it was left out", tag.id, tag.why);
        }
    }
    unreadable(answers);
    match abstained(answers).next() {
        Some((first, reason)) if alike => {
            let photos = without_pose(answers);
            say!("no pose for {photos}; {}, for one: {reason}", first.display());
        }
        _ => abstained(answers).for_each(|(path, reason)| say!("no pose for {}: {reason}", path.display())),
    }
    let cautions: BTreeSet<String> = answers
        .iter()
        .flat_map(|(_, answer)| answer)
        .filter(|examined| examined.result.is_ok())
        .flat_map(|examined| &examined.fitted)
        .flat_map(FittedCamera::cautions)
        .collect();
    cautions.iter().for_each(|caution| say!("note: {caution}"));
}

/// Prints the errors of photos that cannot be read, which name their files. Of many errors of one kind, prints the first and the number of the others.
fn unreadable(answers: &Answered) {
    let errors: Vec<&PhotoError> = answers.iter().filter_map(|(_, answer)| answer.as_ref().err()).collect();
    let kinds: Vec<_> = errors.iter().map(|e| std::mem::discriminant(*e)).collect();
    let is_one_kind = kinds.windows(2).all(|pair| pair[0] == pair[1]);
    match &errors[..] {
        [first, others @ ..] if is_one_kind && errors.len() > MOST_LISTED => {
            say!("error: {first}");
            say!("error: {} more photos cannot be read for the same reason", others.len());
        }
        all => all.iter().for_each(|e| say!("error: {e}")),
    }
}

/// Writes the image of every photo that could be read.
fn draw(answers: &Answered, places: &[PathBuf], files: &LocateFiles) -> Result<()> {
    let folder = files.scene_file.parent().unwrap_or(Path::new(""));
    let outline = EnvelopeShape::open(&files.scene.model, folder)?;
    let read = answers.iter().zip(places);
    let read: Vec<_> = read
        .filter_map(|((photo, answer), place)| Some((*photo, answer.as_ref().ok()?, place)))
        .collect();
    let draw = |(): &mut (), (photo, examined, place): &(&Path, &LocatedPhoto, &PathBuf)| {
        overlay::write(place, photo, examined, &files.scene, &outline)
    };
    progress::photos("drawing", read.len()).during(|bar| workers::map(&read, || Ok(()), draw, || bar.inc(1)))?;
    Ok(())
}

pub(super) fn line(path: &Path, answer: &PhotoAnswer) -> OutputLine {
    let found = located(answer);
    let lone = answer.as_ref().ok().and_then(|examined| match &examined.result {
        Ok(found) => found.lone.as_ref(),
        Err(abstention) => abstention.lone(),
    });
    let fitted = answer.as_ref().ok().and_then(|examined| examined.fitted.as_ref().ok());
    let reason = match answer {
        Ok(examined) => examined.result.as_ref().err().map(Abstention::to_string),
        Err(e) => Some(e.to_string()),
    };
    OutputLine {
        file: path.display().to_string(),
        status: if found.is_some() { "located" } else { "abstained" },
        reason,
        code: code(answer),
        azimuth_deg: found.map(|l| l.viewpoint.azimuth_deg),
        pitch_deg: found.map(|l| l.viewpoint.pitch_deg),
        distance_mm: found.map(|l| l.viewpoint.distance_mm),
        sigma: found.map(|l| l.sigma),
        bin: found.map(|l| l.bin),
        bin_probability: found.map(|l| l.bin_probability),
        rival: lone.and_then(|lone| lone.rival),
        bins: lone.map(|lone| lone.bins.clone()).unwrap_or_default(),
        warnings: found.map(|l| l.warnings.clone()).unwrap_or_default(),
        tags: found.map(|l| l.tags.clone()).unwrap_or_default(),
        ignored_tags: found.map(|l| l.ignored_tags.clone()).unwrap_or_default(),
        rms_px: found.map(|l| l.rms_px),
        T_camera_model: found.map(|l| rigid::rows(&l.pose)),
        camera_scale: fitted.map(|f| f.scale),
        camera_turned_deg: fitted.map(|f| f.turned_deg),
        cautions: fitted.map(FittedCamera::cautions).unwrap_or_default(),
    }
}

/// `NAME.overlay.jpg`, and `NAME-2.overlay.jpg` for the next photo of that name.
fn overlay_name(stem: &str, number: u32) -> String {
    let number = if number == 1 { "" } else { &format!("-{number}") };
    format!("{stem}{number}.overlay.jpg")
}

fn row(path: &Path, answer: &PhotoAnswer) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // A row is a line, whatever the name is.
    let name = name.replace('\n', "\\u000a").replace('\t', "\\u0009");
    match located(answer) {
        Some(l) => {
            let (v, b) = (&l.viewpoint, &l.bin);
            let bin = format!("{}°/{}°/{} mm", b.azimuth_deg, b.pitch_deg, b.distance_mm);
            format!(
                "{name:<28} {:>8}° {:>6.3}° {:>7.2}° {:>8.1} mm {bin:>16} {:>4.0} % {:>5} {:>4.2} px",
                direction_text(v.azimuth_deg, 2),
                l.sigma.azimuth_deg,
                v.pitch_deg,
                v.distance_mm,
                (100.0 * l.bin_probability).floor(),
                l.tags.len(),
                l.rms_px
            )
        }
        None => format!("{name:<28} no pose ({})", code(answer).unwrap_or_default()),
    }
}
