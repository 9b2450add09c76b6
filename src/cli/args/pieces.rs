//! Arguments of `print wrap`.

/// How the model is cut into pieces, and what is printed of them.
#[derive(clap::Args)]
pub struct PiecesArgs {
    /// Print five panels instead: the model's sides as they are seen straight on, which is exact for a box
    #[arg(long, conflicts_with_all = ["pieces", "max_stretch", "mean_stretch", "tabs", "paint"])]
    pub panels: bool,
    /// At most so many pieces; up to 3 % of the paint, the smallest parts, may be left out for it
    #[arg(long, value_name = "N", default_value_t = 24)]
    pub pieces: usize,
    /// The stretch (mm on the surface for 1 mm on paper, or the inverse) that 99 % of the paint stay below
    #[arg(long, value_name = "RATIO", default_value_t = 1.2, allow_negative_numbers = true)]
    pub max_stretch: f64,
    /// The mean stretch
    #[arg(long, value_name = "RATIO", default_value_t = 1.03, allow_negative_numbers = true)]
    pub mean_stretch: f64,
    /// Glue tabs on one side of each seam, this wide in mm
    #[arg(long, value_name = "MM", num_args = 0..=1, default_missing_value = "6", allow_negative_numbers = true, conflicts_with = "paint")]
    pub tabs: Option<f64>,
    /// Pixels per inch of the printed texture
    #[arg(
        long,
        value_name = "DPI",
        default_value_t = 300.0,
        allow_negative_numbers = true,
        conflicts_with = "paint"
    )]
    pub dpi: f64,
}
