//! The colour chart: its [`layout`], and reading it in a photo.
//!
//! Steps of reading a photo: [`find`] the chart by its tags, [`sample`] its patches, divide out the [`light`] measured at the bare paper between
//! them, and check the result ([`read`]). Colours are relative to the paper's white in the photo's light. The camera's own tone curve and colours are
//! not corrected: they could only be fitted to the requested colours, and that would hide what is measured, the printer.

pub mod find;
pub mod layout;
pub mod light;
pub mod read;
pub mod sample;

use layout::ChartCell;

/// Reason why a photo of a chart was not read. Each variant says what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ColourChartError {
    #[error("no colour chart is in the photo; photograph the whole sheet of `scaleproof print chart`, sharply")]
    NoChart,
    #[error("two colour charts are in the photo, or a copy of one; photograph one at a time")]
    TwoCharts,
    #[error(
        "of the chart's five tags {ids} cannot be read: covered, cut off, blurred or in a reflection; take the photo again with the \
         whole chart in it"
    )]
    TagsMissing { ids: String },
    #[error("tag {id} of the chart is partly covered or has a reflection on it; take the photo again")]
    TagCovered { id: u32 },
    #[error(
        "the chart's tags are {off_mm:.1} mm from a flat sheet in a straight lens; lay the paper flat, tape it to something stiff, or take the photo from further away"
    )]
    NotFlat { off_mm: f64 },
    #[error("a patch of the chart has only {pixels:.0} pixels a side, and {least:.0} are needed; go nearer")]
    TooSmall { pixels: f64, least: f64 },
    #[error("the photo is overexposed at {place} ({share_percent:.0} % of it is at the end of the scale); expose less")]
    Overexposed { place: String, share_percent: f64 },
    #[error(
        "the paper's white is too dark ({level:.0} of 255 in its weakest channel); give more light or expose longer"
    )]
    TooDark { level: f64 },
    #[error(
        "the light on the paper is too uneven to be taken out (bare paper is off by {off_percent:.0} % at {place}): avoid shadows, \
         reflections and lamps close by"
    )]
    UnevenLight { off_percent: f64, place: String },
    #[error("{place} is {percent:.0} % as bright as the paper around it: a reflection; light the chart from the side")]
    Reflection { place: String, percent: f64 },
    #[error(
        "the same black is L* {low:.0} in one place and {high:.0} in another: reflections or stray light; light the chart from the \
         side"
    )]
    UnevenBlack { low: f64, high: f64 },
    #[error(
        "{patches} patches, as {place}, are not of one colour: the photo is blurred or shaken, the paper is wavy, or there are spots on it"
    )]
    Patchy { patches: usize, place: String },
    #[error(
        "no colours are in the photos (L* only): they are greyscale, or the print is; photograph a colour print in colour"
    )]
    Colourless,
    #[error("the photos show different charts ({first} and {other}); average photos of one print")]
    MixedCharts { first: &'static str, other: &'static str },
    #[error("the photos disagree by a mean ΔE2000 of {delta_e:.1}; average only photos of one print in the same light")]
    PhotosDisagree { delta_e: f64 },
    #[error("the chart could not be placed: the corners of its tags lie on a line")]
    OnALine,
}

/// Formats a cell's position counted from 1: `row 3, column 12`, from the upper left.
fn place(cell: ChartCell) -> String {
    format!("row {}, column {}", cell.row + 1, cell.column + 1)
}
