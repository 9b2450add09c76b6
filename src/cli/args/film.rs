//! Arguments of `session from-video`.

use std::path::PathBuf;

use crate::cli::Result;

/// Make photos of a video of a walk round the model: the best frames of each bin, in a session
///
/// Every frame is located by its tags; kept are the sharpest that show the whole model as the scene's bins ask. Where the session has photos of another
/// texture at the same place, the frames nearest to their viewpoints are kept, so that pairs differ in the texture alone. The video is never changed.
/// Videos are read with ffmpeg.
#[derive(clap::Args)]
pub struct FilmArgs {
    /// The video: MP4, MOV, MKV or WebM, as the camera wrote it
    pub video: PathBuf,
    /// What stands on the table, scene.toml [default: that of the session]
    #[arg(long, value_name = "TOML")]
    pub scene: Option<PathBuf>,
    /// The camera file of this camera's videos, whose crop is another than that of its photos [default: that of the session]
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// The texture on the model; `normal` is the plain one
    #[arg(long, value_name = "NAME")]
    pub variant: String,
    /// Where it was filmed; photos of one place are not independent
    #[arg(long, value_name = "NAME")]
    pub place: String,
    /// The session's folder; one that is there gets the photos besides those it has
    #[arg(short, long, value_name = "SESSION")]
    pub output: PathBuf,
    /// Frames of each bin; as many as there are photos to pair with, where the session has another texture
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub per_bin: u16,
    /// Seconds between two frames of one bin, at least
    #[arg(long, value_name = "S", default_value = "0.3", value_parser = seconds)]
    pub apart: f64,
    /// Begin at this time of the video, s
    #[arg(long, value_name = "S", default_value = "0", value_parser = seconds)]
    pub from: f64,
    /// End at this time of the video, s
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub to: Option<f64>,
    /// Look at every so-manieth frame only [default: as leaves 30 a second or so]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub every: Option<u64>,
    /// Keep frames as PNG instead of JPEG of quality 95
    #[arg(long)]
    pub png: bool,
    /// Print what was made as one JSON object
    #[arg(long)]
    pub json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|s| (0.0..=1e6).contains(s));
    number.ok_or_else(|| "give seconds, from 0 to 1000000".into())
}
