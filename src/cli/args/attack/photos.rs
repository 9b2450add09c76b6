//! Arguments of `attack photos`.

use std::path::PathBuf;

/// Make frames of photos of the model in flat colours: one photo of each colour from about the same place is a view
///
/// Photos are located by their tags and mapped onto the reference photo of their view through the mesh that the scene names, at its
/// exposure. Photos and views that do not fit are left out and named; the photos are never changed.
#[derive(clap::Args)]
pub struct PhotosArgs {
    /// Sessions with photos of the model: photos of one place may be in several
    #[arg(value_name = "SESSION", required = true)]
    pub sessions: Vec<PathBuf>,
    /// Which variant of the session was painted in which flat colour: the paint's reflectance as hex sRGB, as in black=0a0a0a white=f0f0f0
    #[arg(long, value_name = "VARIANT=HEX", num_args = 1.., required = true)]
    pub flat: Vec<String>,
    /// The materials of the mesh that are the paint; without it, the scene's paint, or all
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub material: Vec<String>,
    /// Width of the frames in pixels; they are as high as the photos' shape makes them
    #[arg(long, value_name = "PX", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=2048))]
    pub size_px: u32,
    /// Folder for the frames
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}
