//! `scaleproof locate`: where did the camera stand in these photos?

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{CommandResult, Outcome, progress};
use crate::camera::{Camera, Fitted};
use crate::geometry::rigid;
use crate::locate::{self, Abstention, IgnoredTag, Located, Sigma, Warning};
use crate::photo::{PhotoError, PhotoFile};
use crate::scene::{Bin, Scene};
use crate::session::Session;
use crate::tags::{StartError, TagDetector, TagDetectorChoice};
use crate::workers;

/// Find each photo's camera pose, viewpoint and bin from the AprilTags around the model.
///
/// A photo whose pose cannot be known is answered with the reason instead. Exit code 2 when a photo cannot be read or when
/// no photo at all is located.
#[derive(clap::Args)]
pub struct Args {
    /// Photos (JPEG or PNG); they are never changed.
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// What stands on the table: scene.toml.
    #[arg(long)]
    scene: PathBuf,
    /// Camera file: YAML of OpenCV, ROS camera_info or Kalibr, or a .cameramodel of mrcal; see `scaleproof camera`.
    #[arg(long)]
    camera: PathBuf,
    /// What finds the tags: coarse-to-fine, apriltag, aruco, aruco-subpix, aruco-contour, aruco-apriltag or locus.
    #[arg(long, value_name = "NAME", default_value_t)]
    tag_detector: TagDetectorChoice,
    /// One JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
}

/// One line of `--json`.
#[derive(Serialize)]
#[allow(non_snake_case)]
struct Line {
    file: String,
    status: &'static str,
    /// Why there is no pose, as a sentence.
    reason: Option<String>,
    /// The same as a word for programs.
    code: Option<&'static str>,
    azimuth_deg: Option<f64>,
    pitch_deg: Option<f64>,
    distance_mm: Option<f64>,
    /// Standard deviations of the three, from corner noise alone.
    sigma: Option<Sigma>,
    bin: Option<Bin>,
    bin_probability: Option<f64>,
    warnings: Vec<Warning>,
    tags: Vec<u32>,
    ignored_tags: Vec<IgnoredTag>,
    rms_px: Option<f64>,
    T_camera_model: Option<[[f64; 4]; 4]>,
    /// Photo width by camera file width.
    camera_scale: Option<f64>,
    /// Clockwise, with the photo, as EXIF says.
    camera_turned_deg: Option<u32>,
    /// What to know before believing the pose, as sentences.
    cautions: Vec<String>,
}

/// A photo with a pose, and the camera it was found with.
struct Found {
    located: Located,
    fitted: Fitted,
}

/// A photo without a pose: the word for programs and the sentence.
struct NoPose {
    code: &'static str,
    reason: String,
}

const UNREADABLE: &str = "unreadable";

pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    let scene = Scene::open(&args.scene)?;
    let camera = Camera::open(&args.camera)?;
    let results = locate_all(&args.photos, &scene, &camera, args.tag_detector)?;
    if args.json {
        for (path, result) in args.photos.iter().zip(&results) {
            writeln!(out, "{}", serde_json::to_string(&line(path, result))?)?;
        }
    } else {
        write_table(&args.photos, &results, out)?;
    }
    explain(&args.photos, &results);
    let unreadable = results.iter().any(|r| r.as_ref().is_err_and(|e| e.code == UNREADABLE));
    let none_located = results.iter().all(Result::is_err);
    Ok(if unreadable || none_located {
        Outcome::SomeInputBad
    } else {
        Outcome::Done
    })
}

/// Locates every photo of a session and writes the table.
pub fn table(session: &Session, out: &mut dyn Write) -> Result<(), Box<dyn std::error::Error>> {
    let photos: Vec<PathBuf> = session.photos.iter().map(|p| session.photo_path(p)).collect();
    let results = locate_all(
        &photos,
        &session.scene,
        session.known_camera()?,
        TagDetectorChoice::default(),
    )?;
    write_table(&photos, &results, out)?;
    explain(&photos, &results);
    Ok(())
}

/// One answer per photo, in their order.
fn locate_all(
    photos: &[PathBuf],
    scene: &Scene,
    camera: &Camera,
    tag_detector: TagDetectorChoice,
) -> Result<Vec<Result<Found, NoPose>>, StartError> {
    let families = scene.families();
    let bar = progress::photos("locating", photos.len());
    let results = workers::map(
        photos,
        || tag_detector.open(&families),
        |tags, path| Ok(locate_file(path, tags, scene, camera)),
        || bar.inc(1),
    );
    bar.finish_and_clear();
    results
}

fn write_table(photos: &[PathBuf], results: &[Result<Found, NoPose>], out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "{}", heading())?;
    photos
        .iter()
        .zip(results)
        .try_for_each(|(path, result)| writeln!(out, "{}", row(path, result)))
}

/// Says on standard error why photos got no pose, which tags the others outvoted, and once each what to know before believing
/// the answers.
fn explain(photos: &[PathBuf], results: &[Result<Found, NoPose>]) {
    for (path, found) in photos
        .iter()
        .zip(results)
        .filter_map(|(p, r)| Some((p, r.as_ref().ok()?)))
    {
        for tag in found.located.ignored_tags.iter().filter(|tag| tag.why.is_outvoted()) {
            say!(
                "note on {}: tag {} {}; it was left out",
                path.display(),
                tag.id,
                tag.why
            );
        }
    }
    for (path, no_pose) in photos
        .iter()
        .zip(results)
        .filter_map(|(p, r)| Some((p, r.as_ref().err()?)))
    {
        // What is wrong with a file names the file already.
        match no_pose.code {
            UNREADABLE => say!("error: {}", no_pose.reason),
            _ => say!("no pose for {}: {}", path.display(), no_pose.reason),
        }
    }
    let cautions: BTreeSet<String> = results
        .iter()
        .flatten()
        .flat_map(|found| found.fitted.cautions())
        .collect();
    cautions.iter().for_each(|caution| say!("note: {caution}"));
}

fn locate_file(path: &Path, tags: &mut dyn TagDetector, scene: &Scene, camera: &Camera) -> Result<Found, NoPose> {
    let unreadable = |e: PhotoError| NoPose {
        code: UNREADABLE,
        reason: e.to_string(),
    };
    let photo = PhotoFile::open(path).map_err(unreadable)?;
    let grey = photo.grey().map_err(unreadable)?;
    let fitted = camera.for_photo(photo.width, photo.height, photo.turned_deg);
    fitted
        .map_err(Abstention::from)
        .and_then(|fitted| {
            let located = locate::locate(&tags.find(&grey), scene, &fitted.camera)?;
            Ok(Found { located, fitted })
        })
        .map_err(|e| NoPose {
            code: e.code(),
            reason: e.to_string(),
        })
}

fn line(path: &Path, result: &Result<Found, NoPose>) -> Line {
    let (found, no_pose) = (result.as_ref().ok(), result.as_ref().err());
    let (found, fitted) = (found.map(|f| &f.located), found.map(|f| &f.fitted));
    Line {
        file: path.display().to_string(),
        status: if found.is_some() { "located" } else { "abstained" },
        reason: no_pose.map(|n| n.reason.clone()),
        code: no_pose.map(|n| n.code),
        azimuth_deg: found.map(|l| l.viewpoint.azimuth_deg),
        pitch_deg: found.map(|l| l.viewpoint.pitch_deg),
        distance_mm: found.map(|l| l.viewpoint.distance_mm),
        sigma: found.map(|l| l.sigma),
        bin: found.map(|l| l.bin),
        bin_probability: found.map(|l| l.bin_probability),
        warnings: found.map(|l| l.warnings.clone()).unwrap_or_default(),
        tags: found.map(|l| l.tags.clone()).unwrap_or_default(),
        ignored_tags: found.map(|l| l.ignored_tags.clone()).unwrap_or_default(),
        rms_px: found.map(|l| l.rms_px),
        T_camera_model: found.map(|l| rigid::rows(&l.pose)),
        camera_scale: fitted.map(|f| f.scale),
        camera_turned_deg: fitted.map(|f| f.turned_deg),
        cautions: fitted.map(Fitted::cautions).unwrap_or_default(),
    }
}

fn heading() -> String {
    format!(
        "{:<28} {:>9} {:>7} {:>8} {:>11} {:>16} {:>6} {:>5} {:>7}",
        "photo", "azimuth", "±", "pitch", "distance", "bin", "sure", "tags", "rms"
    )
}

fn row(path: &Path, result: &Result<Found, NoPose>) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match result {
        Ok(Found { located: l, .. }) => {
            let (v, b) = (&l.viewpoint, &l.bin);
            let bin = format!("{}°/{}°/{} mm", b.azimuth_deg, b.pitch_deg, b.distance_mm);
            format!(
                "{name:<28} {:>8.2}° {:>6.3}° {:>7.2}° {:>8.1} mm {bin:>16} {:>4.0} % {:>5} {:>4.2} px",
                v.azimuth_deg,
                l.sigma.azimuth_deg,
                v.pitch_deg,
                v.distance_mm,
                (100.0 * l.bin_probability).floor(),
                l.tags.len(),
                l.rms_px
            )
        }
        Err(no_pose) => format!("{name:<28} no pose ({})", no_pose.code),
    }
}
