//! Arguments of `survey`.

use std::path::PathBuf;

use crate::cli::scene;
use scaleproof_pose::scene::TagFamily;
use scaleproof_rig::survey::Sizes;

/// Find out from photos where tags stand that were placed by hand, and write it as a scene.toml.
///
/// Only the sizes of the tags are needed, and some tags whose place is known: a printed ground mat, or one tag. Exit code 2
/// when a file is bad or the photos do not say where the tags stand; nothing is written then.
#[derive(clap::Args)]
pub struct Args {
    /// Photos (JPEG or PNG), or folders of them, of the tags from all sides; each shows tags that others show too
    #[arg(required = true)]
    pub photos: Vec<PathBuf>,
    /// Camera file: OpenCV or ROS camera_info YAML
    #[arg(long)]
    pub camera: PathBuf,
    /// Scene file with the model, the bins, and where the fixed tags stand; of other tags only the size is used
    #[arg(long)]
    pub scene: PathBuf,
    /// Tags that keep their place of the scene file: `mat` for all that lie on the ground (the printed ground mat), or ids as in 0,5
    #[arg(long, value_name = "mat|ID,…")]
    pub fixed: String,
    /// Outer edge of the tags' black borders in mm, as in 50, or 0-7:50,8-15:40; without it those of the scene file
    #[arg(long, value_name = "MM|ID-ID:MM,…", allow_hyphen_values = true)]
    pub sizes: Option<Sizes>,
    /// Family of the tags that --fixed and --sizes name
    #[arg(long, default_value = "tag36h11", value_parser = scene::family)]
    pub family: TagFamily,
    /// The scene file to write
    #[arg(short, long, alias = "out", value_name = "TOML")]
    pub output: PathBuf,
    /// A JSON object instead of tables
    #[arg(long)]
    pub json: bool,
}
