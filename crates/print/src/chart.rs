//! Drawing of the colour chart ([`crate::colour_chart::layout`]) on one sheet.

use super::SheetError;
use super::frame::PageFrame;
use super::media::Media;
use super::shapes::{TagPlacement, black_modules};
use super::sheet::{Mark, RectMm, Sheet};
use super::template::making;
use crate::colour_chart::layout::{ChartKind, ChartLayout, FAMILY, PATCH_MM, TAG_MM};
use scaleproof_plot::lettering::{number, size};
use scaleproof_pose::tags::TagImage;

/// Reason why no chart was printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChartPrintError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error("the smallest colour chart is {chart_mm} mm and the paper has {free_mm} mm for it; use larger paper")]
    NoRoom { chart_mm: String, free_mm: String },
    #[error("tag {id} of the colour chart could not be drawn by the AprilTag library")]
    NoTagImage { id: u32 },
}

#[derive(Debug, Clone)]
pub struct PrintedChart {
    pub layout: ChartLayout,
    /// Area of the chart (page frame).
    pub area: RectMm,
    pub sheet: Sheet,
}

/// Draws the chart with the most colours that fits on the paper.
pub fn chart(media: Media) -> Result<PrintedChart, ChartPrintError> {
    let (layout, page, area) = placed(media)?;
    // The chart's y runs down, the page's up.
    let on_page = |[x, y]: [f64; 2]| [area.left_mm + x, area.top_mm - y];
    let mut marks = Vec::new();
    for patch in &layout.patches {
        let (centre, h) = (on_page(patch.cell.centre_mm()), PATCH_MM / 2.0);
        let area = RectMm::new(centre[0] - h, centre[1] - h, centre[0] + h, centre[1] + h);
        marks.push(Mark::fill(area, patch.asked_rgb));
    }
    for tag in &layout.tags {
        let image = TagImage::new(FAMILY, tag.id).ok_or(ChartPrintError::NoTagImage { id: tag.id })?;
        let place = TagPlacement::new(&image, TAG_MM, on_page(tag.centre_mm), [1.0, 0.0]);
        marks.push(Mark::black(black_modules(image.modules(), &place)));
    }
    let label = format!("chart {}", layout.kind.name());
    let sheet = page.labelled(page.printable, marks, &captions(&layout, &media), &label);
    Ok(PrintedChart { layout, area, sheet })
}

fn placed(media: Media) -> Result<(ChartLayout, PageFrame, RectMm), ChartPrintError> {
    media.check_is_cut()?;
    for layout in ChartKind::ALL.map(ChartLayout::new) {
        if let Some((page, area)) = media.with_room(layout.size_mm, 0.0)? {
            return Ok((layout, page, area));
        }
    }
    let [.., smallest] = ChartKind::ALL;
    let free = media.both_ways()?.first().map(PageFrame::usable_size);
    Err(ChartPrintError::NoRoom {
        chart_mm: size(ChartLayout::new(smallest).size_mm),
        free_mm: size(free.unwrap_or_default()),
    })
}

fn captions(layout: &ChartLayout, media: &Media) -> Vec<String> {
    let (kind, ids) = (layout.kind.name(), layout.kind.tag_ids());
    let contents = format!(
        "Colour chart {kind}: {} patches, {} cells of bare paper, tag36h11 {} to {} of {} mm",
        layout.patches.len(),
        layout.whites.len(),
        ids[0],
        ids[4],
        number(TAG_MM)
    );
    let then = "Then: scaleproof colour read PHOTO -o printer.toml";
    [
        "Print at 100 %, on the paper and with the settings of the later sheets; let the ink dry. Lay it flat, in even light from the side.",
        "Photograph all of it sharply, from above, without flash and a little dark: white paper must not be at the end of the scale.",
        &contents,
        &format!("{then} · {}", making(media)),
    ]
    .map(str::to_owned)
    .to_vec()
}
