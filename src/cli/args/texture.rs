//! Arguments of `--texture`.

use std::path::PathBuf;

/// The pattern or texture.
#[derive(clap::Args)]
pub struct TextureArgs {
    /// The pattern: a PNG with one pixel per cell
    #[arg(long, value_name = "PNG", conflicts_with = "texture")]
    pub pattern: Option<PathBuf>,
    /// Printed width of one repeat of the pattern, in mm; without it, what the pattern's card says
    #[arg(long, value_name = "MM", requires = "pattern", allow_negative_numbers = true)]
    pub tile_mm: Option<f64>,
    /// A texture instead of a pattern: an image for the mesh's texture coordinates, a .obj, .glb or .ply with images of its own (also the mesh
    /// without --mesh), or a .npy with the texels of each triangle
    #[arg(long, value_name = "FILE")]
    pub texture: Option<PathBuf>,
}
