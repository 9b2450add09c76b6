//! Arguments of `calibrate`.

use std::path::PathBuf;

/// Find the camera's focal length, centre and distortion from photos or a video of a calibration board, or from a video of a scene's tags.
///
/// The smallest camera model that the photos bear out is taken, a fisheye among them; what was dropped is said. Photos that do not determine a
/// camera are refused with the reason. Of a video, sharp frames that differ are taken: video crops and stabilises, so that photos' camera file
/// does not hold for it.
#[derive(clap::Args)]
pub struct Args {
    /// Photos of the board (JPEG or PNG), folders of them, or one video (MP4, MOV, MKV, WebM or AVI); they are never changed
    #[arg(required = true)]
    pub photos: Vec<PathBuf>,
    /// What was printed: the .toml of `print board`
    #[arg(long, value_name = "TOML")]
    pub board: Option<PathBuf>,
    /// Without a board: the scene (scene.toml) whose tags the video shows from all sides
    #[arg(long, value_name = "TOML", conflicts_with = "board")]
    pub scene: Option<PathBuf>,
    /// The camera file to write (OpenCV YAML)
    #[arg(short, long, value_name = "YAML")]
    pub output: Option<PathBuf>,
    /// The page to write: errors, coverage, uncertainty
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}
