//! Detection of the chart by its tags, and the mapping between chart millimetres and photo pixels.

use nalgebra::Matrix3;

use super::ColourChartError;
use super::layout::{CELL_MM, ChartKind, ChartLayout, FAMILY, PATCH_MM};
use scaleproof_core::geometry::distance;
use scaleproof_core::geometry::homography::{self, mapped};
use scaleproof_core::spelling::list;
use scaleproof_pose::tags::SeenTag;

/// Maximum root mean square distance of the 20 tag corners from the image of a flat sheet, mm. A patch is sampled 2.5 mm from its edges, so an error
/// of this size, several times over in the middle of a bulge, still stays inside.
const MOST_OFF_MM: f64 = 0.4;
/// Minimum side of a patch, px; below it the parts of a patch cannot be distinguished.
const LEAST_PATCH_PX: f64 = 20.0;

#[derive(Debug, Clone)]
pub struct FoundChart {
    pub layout: ChartLayout,
    /// Homography from the chart frame (mm) to pixels.
    to_px: Matrix3<f64>,
    to_mm: Matrix3<f64>,
    /// Root mean square distance of the tag corners from their places on a flat sheet.
    pub off_mm: f64,
    /// Pixels a side of the smallest patch, along its shorter direction.
    pub patch_px: f64,
}

impl FoundChart {
    /// Returns the pixel of a point of the chart; (0, 0) is the centre of the top-left pixel.
    pub fn px(&self, at_mm: [f64; 2]) -> [f64; 2] {
        mapped(&self.to_px, at_mm)
    }

    pub fn mm(&self, at_px: [f64; 2]) -> [f64; 2] {
        mapped(&self.to_mm, at_px)
    }
}

/// Finds the chart that the tags belong to. Other tags may be in the photo.
pub fn find(seen: &[SeenTag]) -> Result<FoundChart, ColourChartError> {
    let kind = the_kind(seen)?;
    let layout = ChartLayout::new(kind);
    let (mut chart_mm, mut image_px) = (Vec::new(), Vec::new());
    let mut missing = Vec::new();
    for tag in &layout.tags {
        let of_this: Vec<_> = seen.iter().filter(|s| s.family == FAMILY && s.id == tag.id).collect();
        match of_this[..] {
            [] => missing.push(tag.id),
            [one] if one.is_whole => {
                chart_mm.extend(tag.corners_mm());
                image_px.extend(one.corners_px);
            }
            [_] => return Err(ColourChartError::TagCovered { id: tag.id }),
            _ => return Err(ColourChartError::TwoCharts),
        }
    }
    if !missing.is_empty() {
        let ids = list(&missing);
        return Err(ColourChartError::TagsMissing { ids });
    }
    placed(layout, &chart_mm, &image_px)
}

fn the_kind(seen: &[SeenTag]) -> Result<ChartKind, ColourChartError> {
    let is_of = |tag: &SeenTag, kind: &ChartKind| tag.family == FAMILY && kind.tag_ids().contains(&tag.id);
    let is_seen = |kind: &ChartKind| seen.iter().any(|tag| is_of(tag, kind));
    let mut kinds = ChartKind::ALL.into_iter().filter(is_seen);
    match (kinds.next(), kinds.next()) {
        (None, _) => Err(ColourChartError::NoChart),
        (Some(kind), None) => Ok(kind),
        _ => Err(ColourChartError::TwoCharts),
    }
}

fn placed(layout: ChartLayout, chart_mm: &[[f64; 2]], image_px: &[[f64; 2]]) -> Result<FoundChart, ColourChartError> {
    let to_px = homography::fitted(chart_mm, image_px).ok_or(ColourChartError::OnALine)?;
    let to_mm = to_px.try_inverse().ok_or(ColourChartError::OnALine)?;
    let mut found = FoundChart {
        layout,
        to_px,
        to_mm,
        off_mm: 0.0,
        patch_px: 0.0,
    };
    let pairs = chart_mm.iter().zip(image_px);
    let squares = pairs.map(|(mm, px)| distance(found.mm(*px), *mm).powi(2));
    found.off_mm = (squares.sum::<f64>() / chart_mm.len() as f64).sqrt();
    found.patch_px = smallest_patch(&found);
    // False for NaN, too.
    let is_flat = found.off_mm <= MOST_OFF_MM;
    if !is_flat {
        return Err(ColourChartError::NotFlat { off_mm: found.off_mm });
    }
    if found.patch_px < LEAST_PATCH_PX {
        return Err(ColourChartError::TooSmall {
            pixels: found.patch_px,
            least: LEAST_PATCH_PX,
        });
    }
    Ok(found)
}

/// Returns the side of the smallest patch, px: perspective makes one of the corner patches the smallest.
fn smallest_patch(chart: &FoundChart) -> f64 {
    let (width, height) = chart.layout.size_mm;
    let half = CELL_MM / 2.0;
    let (right, bottom) = (width - half, height - half);
    let corners = [[half, half], [right, half], [half, bottom], [right, bottom]];
    let side = |[x, y]: [f64; 2]| {
        let h = PATCH_MM / 2.0;
        let across = distance(chart.px([x - h, y]), chart.px([x + h, y]));
        across.min(distance(chart.px([x, y - h]), chart.px([x, y + h])))
    };
    corners.into_iter().map(side).fold(f64::INFINITY, f64::min)
}
