//! `scaleproof camera`: convert a camera file, show what one says, guess one from a photo.

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;
use schemars::JsonSchema;
use serde::Serialize;

use super::choice::one_of;
use super::{CommandResult, Outcome};
use crate::cli::answer::told;
use scaleproof_core::files;
use scaleproof_photo::Photo;
use scaleproof_pose::camera::{Camera, CameraFormat, DistortionModel};

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Write a camera file in another format; the projection stays the same
    Convert(ConvertArgs),
    /// Say in words what a camera file says: image size, fields of view, focal length, lens model
    Show(ShowArgs),
    /// Guess a camera from the EXIF data of a photo, with how far it may be off
    Guess(GuessArgs),
}

#[derive(clap::Args)]
pub(crate) struct ConvertArgs {
    /// Camera file of OpenCV, ROS, Kalibr, EuRoC, mrcal, COLMAP (cameras.txt) or a NeRF program (transforms.json); with a pinhole or fisheye lens
    input: PathBuf,
    /// Which camera of a file of several: its name or id there
    #[arg(long)]
    name: Option<String>,
    /// The camera file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Its format; not needed for a name that ends in .cameramodel
    #[arg(long, value_parser = one_of(CameraFormat::ALL))]
    format: Option<CameraFormat>,
}

#[derive(clap::Args)]
pub(crate) struct ShowArgs {
    /// Camera file of any format
    file: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
pub(crate) struct GuessArgs {
    /// A photo straight from the camera (JPEG or PNG with EXIF data)
    photo: PathBuf,
    /// The camera file to write (OpenCV YAML); without it the guess is only shown
    #[arg(short, long, value_name = "YAML")]
    output: Option<PathBuf>,
}

/// Runs `scaleproof camera …`.
pub(crate) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Convert(args) => convert(&args, out),
        Command::Show(args) => {
            let camera = Camera::open(&args.file)?;
            told(args.json, json(&camera), in_words(&camera), out)
        }
        Command::Guess(args) => guess(&args, out),
    }
}

fn convert(args: &ConvertArgs, out: &mut dyn Write) -> CommandResult {
    let name = args.output.display();
    let mrcal = args
        .output
        .extension()
        .is_some_and(|e| e == "cameramodel")
        .then_some(CameraFormat::Mrcal);
    let format = args
        .format
        .or(mrcal)
        .ok_or_else(|| format!("{name} can be of several formats: say --format opencv, ros, kalibr or mrcal"))?;
    let text = Camera::open_named(&args.input, args.name.as_deref())?.write(format)?;
    files::write_atomically(&args.output, text.as_bytes())?;
    writeln!(out, "{name}: {} format", format.name())?;
    Ok(Outcome::Done)
}

/// `camera show --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct Answer {
    /// Width and height.
    size_px: [u32; 2],
    /// fx, fy.
    focal_px: [f64; 2],
    /// cx, cy.
    centre_px: [f64; 2],
    /// Standard deviations of fx, fy, cx, cy.
    sigma_px: Option<[f64; 4]>,
    /// Across and down, without distortion: of a pinhole, or of an ideal fisheye.
    field_of_view_deg: [f64; 2],
    /// k1, k2, p1, p2, k3, k4, k5, k6; `null` for a fisheye.
    distortion: Option<Vec<f64>>,
    /// k1, k2, k3, k4 of a fisheye; `null` for other lenses.
    fisheye: Option<Vec<f64>>,
    /// How far a guessed focal length may be off.
    guessed_focal_percent: Option<f64>,
}

fn json(camera: &Camera) -> Answer {
    Answer {
        size_px: [camera.width, camera.height],
        focal_px: [camera.fx, camera.fy],
        centre_px: [camera.cx, camera.cy],
        sigma_px: camera.sigma_px,
        field_of_view_deg: camera.field_of_view_deg(),
        distortion: (!camera.is_fisheye()).then(|| camera.distortion().to_vec()),
        fisheye: camera.is_fisheye().then(|| camera.distortion().to_vec()),
        guessed_focal_percent: camera.guess.map(|guess| guess.focal_percent),
    }
}

fn in_words(camera: &Camera) -> String {
    let [across, down] = camera.field_of_view_deg();
    let sigma =
        |[fx, fy, cx, cy]: [f64; 4]| format!("± one sigma      fx {fx:.2}, fy {fy:.2}, cx {cx:.2}, cy {cy:.2} px\n");
    let mut words = format!(
        "image            {} × {} px\nfocal length     fx {:.2}, fy {:.2} px\nprincipal point  {:.2}, {:.2} px\n\
         {}field of view    {across:.1}° × {down:.1}°, without distortion\nlens model       {}",
        camera.width,
        camera.height,
        camera.fx,
        camera.fy,
        camera.cx,
        camera.cy,
        camera.sigma_px.map(sigma).unwrap_or_default(),
        lens_model(camera)
    );
    if let Some(guess) = camera.guess {
        words += &format!(
            "\nguessed          focal length ± {:.1} %, so distances ± {:.1} %, azimuths about {:.2}° off",
            guess.focal_percent,
            guess.distance_percent(),
            guess.azimuth_deg()
        );
    }
    words
}

/// The coefficients that are not zero, by name.
fn lens_model(camera: &Camera) -> String {
    let names = camera.distortion_model().names().iter();
    let named = names.zip(camera.distortion()).filter(|(_, value)| **value != 0.0);
    let terms: Vec<String> = named.map(|(name, value)| format!("{name} {value}")).collect();
    match (camera.distortion_model(), terms.is_empty()) {
        (DistortionModel::BrownConrady, true) => "pinhole without distortion".into(),
        (DistortionModel::BrownConrady, false) => format!("Brown–Conrady with {}", terms.join(", ")),
        (DistortionModel::Fisheye, true) => "fisheye, equidistant".into(),
        (DistortionModel::Fisheye, false) => format!("fisheye (Kannala–Brandt) with {}", terms.join(", ")),
    }
}

fn guess(args: &GuessArgs, out: &mut dyn Write) -> CommandResult {
    let photo = Photo::open(&args.photo)?;
    let camera = Camera::guessed(photo.width, photo.height, &photo.lens())
        .map_err(|e| format!("no camera can be guessed from {}: {e}", args.photo.display()))?;
    if let Some(path) = &args.output {
        files::write_atomically(path, camera.write(CameraFormat::OpenCv)?.as_bytes())?;
    }
    writeln!(out, "{}", in_words(&camera))?;
    Ok(Outcome::Done)
}
