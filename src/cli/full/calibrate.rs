//! `scaleproof calibrate`: photos of a board become a camera file.

use std::io::Write;
use std::path::PathBuf;

use crate::cli::answer::answer;
use crate::cli::{CommandResult, Outcome, photos, progress};
use scaleproof_core::files;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::CameraFormat;
use scaleproof_rig::calibrate;

/// Find the camera's focal length, centre and distortion from photos of a calibration board.
///
/// The smallest camera model that the photos bear out is taken, a fisheye among them; what was dropped is said. Photos that do not determine a
/// camera are refused with the reason.
#[derive(clap::Args)]
pub(in crate::cli) struct Args {
    /// Photos of the board (JPEG or PNG), or folders of them; they are never changed
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// What was printed: the .toml of `print board`
    #[arg(long, value_name = "TOML")]
    board: PathBuf,
    /// The camera file to write (OpenCV YAML)
    #[arg(short, long, value_name = "YAML")]
    output: Option<PathBuf>,
    /// The page to write: errors, coverage, uncertainty
    #[arg(long, value_name = "HTML")]
    report: Option<PathBuf>,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Runs `scaleproof calibrate`.
pub(in crate::cli) fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    args.photos = photos::of(&args.photos)?;
    let board = Definition::open(&args.board)?;
    calibrate::check(&board)?;
    let bar = progress::photos("looking", args.photos.len());
    let (board_photos, left_out) = calibrate::look(&args.photos, &board, || bar.inc(1));
    bar.finish_and_clear();
    let found =
        progress::busy("fitting the camera").during(|_| calibrate::calibrate(board_photos, left_out, &board))?;
    let mut files = Vec::new();
    if let Some(path) = &args.output {
        let text = found.camera.write(CameraFormat::OpenCv)?;
        files.push((path.clone(), text.into_bytes()));
    }
    let page = |path: &PathBuf| (path.clone(), calibrate::page(&found).into_bytes());
    files.extend(args.report.iter().map(page));
    files::write_all_atomically(&files)?;
    if args.json {
        answer(&calibrate::answer(&found), out)?;
    } else {
        write!(out, "{}", calibrate::table(&found))?;
        for (path, _) in &files {
            writeln!(out, "written: {}", path.display())?;
        }
    }
    for left in &found.left_out {
        say!("left out {}: {}", left.file, left.reason);
    }
    found.cautions.iter().for_each(|c| say!("note: {}", c.0));
    Ok(Outcome::Done)
}
