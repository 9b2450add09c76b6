//! Arguments of `attack baseline`.

use std::path::PathBuf;

use clap::Subcommand;

use crate::cli::args::attack::on_frames::OnFrames;
use crate::cli::args::patch::PlaceArgs;

#[derive(Subcommand)]
pub enum Method {
    /// Uniformly random cells
    Random {
        #[command(flatten)]
        on: OnFrames,
    },
    /// One colour
    Flat {
        #[command(flatten)]
        on: OnFrames,
        /// Hex sRGB, as in 808080
        #[arg(long, value_name = "HEX")]
        flat: String,
    },
    /// ER: a genetic search that asks the detector, without looking into it
    Er(SearchArgs),
    /// CAMOU: a network that imitates renderer and detector, and is looked into in their place
    Camou(SearchArgs),
    /// A finished pattern: a PNG with one pixel per cell
    Import {
        #[command(flatten)]
        on: OnFrames,
        /// As many rows as columns, one pixel per cell
        #[arg(long, value_name = "PNG")]
        pattern: PathBuf,
    },
    /// Finished patches on the hood, doors, roof or rear of a model of one colour (UPC, DAS)
    Patches(PatchesArgs),
}

#[derive(clap::Args)]
pub struct SearchArgs {
    #[command(flatten)]
    pub on: OnFrames,
    /// Images it may look at
    #[arg(long, default_value_t = 2400, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub queries: u64,
}

#[derive(clap::Args)]
pub struct PatchesArgs {
    #[command(flatten)]
    pub on: OnFrames,
    #[command(flatten)]
    pub places: PlaceArgs,
    /// The model's colour beside the patches, as hex sRGB
    #[arg(long, value_name = "HEX", default_value = "808080")]
    pub flat: String,
}

impl Method {
    pub fn on(&self) -> &OnFrames {
        match self {
            Self::Random { on }
            | Self::Flat { on, .. }
            | Self::Import { on, .. }
            | Self::Er(SearchArgs { on, .. })
            | Self::Camou(SearchArgs { on, .. })
            | Self::Patches(PatchesArgs { on, .. }) => on,
        }
    }
}
