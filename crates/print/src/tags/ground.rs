//! Layout of the ground on paper: the sheets of the mat, their seams, and the tent cards with place strips.
//!
//! Of all layouts the one with the least paper is chosen; of those the one that cuts the fewest tags; of those the one with the fewest strips.

use super::arrange::Arrangement;
use super::mat::Mat;
use super::seams::SeamAxis;
use super::strip::{PlaceStrip, Standing};
use super::{TagPrintError, TagRequest, piece};
use crate::SheetError;
use crate::frame::PageFrame;
use crate::media::Media;
use crate::paper::Stock;
use crate::shapes::{clipped, stroked};
use crate::sheet::RectMm;
use crate::template::{MAX_SHEETS, SheetLayout, SheetPlan, TemplateRect};

/// Overlap of neighbouring sheets for gluing.
const OVERLAP_MM: f64 = 8.0;
/// Length up to which strips fit beside tent cards.
const SHORT_MM: f64 = 178.0;

/// The mat with its sheets, and the strips beyond it.
#[derive(Debug, Clone)]
pub struct Ground {
    pub mat: Mat,
    pub layout: SheetLayout,
    /// Area of all sheets together, including those left out (ground frame).
    pub paper: RectMm,
    pub strips: Vec<PlaceStrip>,
    /// Ids of the flat tags cut by a seam.
    pub cut_tags: Vec<u32>,
}

impl Ground {
    /// Chooses the best layout of the ground of a scene; `others` are the sizes of the other pieces to cut out.
    pub fn new(
        mat: Mat,
        arrangement: &Arrangement,
        request: &TagRequest,
        others: &[(f64, f64)],
    ) -> Result<Self, TagPrintError> {
        let media = request.media;
        let mut best: Option<(Cost, Ground)> = None;
        let mut refused = SheetError::TooManySheets { most: MAX_SHEETS }.into();
        for page in media.both_ways()? {
            for with_strips in [false, true] {
                if with_strips && (request.whole_mat || matches!(media.paper, Stock::Roll { .. })) {
                    continue;
                }
                match Self::on(page, &mat, arrangement, media, with_strips) {
                    Ok(ground) => {
                        let cost = ground.cost(media, others)?;
                        if best.as_ref().is_none_or(|(held, _)| cost < *held) {
                            best = Some((cost, ground));
                        }
                    }
                    Err(e) => refused = e,
                }
            }
        }
        let (_, mut best) = best.ok_or(refused)?;
        // The outline of each strip's root is drawn on the mat.
        for strip in &best.strips {
            let name = format!("strip T{}", strip.tent + 1);
            best.mat.add_outline(&strip.outline(), strip.name_at(), name);
        }
        Ok(best)
    }

    /// Lays the ground out on one paper in one orientation. Tent cards that no strip reaches stand on the mat, which is enlarged for them.
    fn on(
        page: PageFrame,
        mat: &Mat,
        arrangement: &Arrangement,
        media: Media,
        with_strips: bool,
    ) -> Result<Self, TagPrintError> {
        let (wide, high) = page.usable_size();
        let longest = SHORT_MM.min(wide.max(high));
        let mut content = if with_strips { mat.core } else { mat.whole() };
        loop {
            let (layout, paper) = tiled(page, media, mat, content)?;
            let mut strips = Vec::new();
            let mut beyond = None;
            for (i, tent) in arrangement.tents.iter().enumerate() {
                match Standing::new(i, tent, mat, paper, longest) {
                    Standing::OnMat => {}
                    Standing::OnStrip(strip) => strips.push(strip),
                    Standing::OutOfReach => beyond = beyond.or(Some(mat.tents[i])),
                }
            }
            if let Some(tent) = beyond.filter(|tent| !tent.is_within(&content)) {
                content = content.union(tent);
                continue;
            }
            let ground = Self {
                cut_tags: cut_tags(mat, &layout, paper),
                mat: mat.clone(),
                layout,
                paper,
                strips,
            };
            return Ok(ground.without_empty_sheets());
        }
    }

    /// Leaves out every empty sheet, as long as the others stay connected.
    fn without_empty_sheets(mut self) -> Self {
        let roots = self.strips.iter().flat_map(|strip| stroked(&strip.root(), 0.1));
        let roots: Vec<_> = roots.collect();
        let drawn = self.mat.shapes.iter().flat_map(|shape| &shape.outlines);
        let shapes: Vec<_> = drawn.chain(&roots).collect();
        let carries = |own: RectMm| shapes.iter().any(|outline| clipped(outline, own).len() > 2);
        let sheets = self.layout.sheets.iter().cloned();
        let empty: Vec<_> = sheets.filter(|plan| !carries(self.ground(plan.own))).collect();
        for plan in empty {
            let mut rest = self.layout.sheets.clone();
            rest.retain(|other| *other != plan);
            if hang_together(&rest) {
                self.layout.sheets = rest;
            }
        }
        self
    }

    /// Returns the names of the sheets, in their order.
    pub fn names(&self) -> Vec<String> {
        self.layout.sheets.iter().map(SheetPlan::id).collect()
    }

    pub fn ground(&self, region: TemplateRect) -> RectMm {
        on_ground(self.paper, region)
    }
}

fn on_ground(paper: RectMm, region: TemplateRect) -> RectMm {
    RectMm::new(
        paper.left_mm + region.left_mm,
        paper.top_mm - region.bottom_mm,
        paper.left_mm + region.right_mm,
        paper.top_mm - region.top_mm,
    )
}

/// Returns the sheets for some content of the mat, and the area of all of them together on the ground.
fn tiled(page: PageFrame, media: Media, mat: &Mat, content: RectMm) -> Result<(SheetLayout, RectMm), TagPrintError> {
    let tags: Vec<RectMm> = mat.tags.iter().map(|(_, tag)| RectMm::around(tag)).collect();
    let (wide, high) = page.usable_size();
    let axis = |(low_mm, high_mm), usable_mm, span: fn(&RectMm) -> (f64, f64)| SeamAxis {
        low_mm,
        high_mm,
        usable_mm,
        overlap_mm: OVERLAP_MM,
        keep: tags.iter().map(span).collect(),
    };
    let across = axis((content.left_mm, content.right_mm), wide, |tag| {
        (tag.left_mm, tag.right_mm)
    });
    // Rows count from the top.
    let down = axis((-content.top_mm, -content.bottom_mm), high, |tag| {
        (-tag.top_mm, -tag.bottom_mm)
    });
    if across.sheets().saturating_mul(down.sheets()) > MAX_SHEETS {
        return Err(SheetError::TooManySheets { most: MAX_SHEETS }.into());
    }
    let (mut x, mut y) = (across.edges(), down.edges());
    // A roll is cut off where the mat ends.
    let along = if page.setup.turned {
        (&mut x, &across)
    } else {
        (&mut y, &down)
    };
    if let (Stock::Roll { .. }, (edges, axis)) = (media.paper, along)
        && edges.len() == 2
    {
        *edges = vec![axis.low_mm, axis.high_mm];
    }
    let longest = |edges: &[f64]| {
        let carried = edges.windows(2).enumerate().map(|(i, pair)| {
            let overlap = if i + 2 == edges.len() { 0.0 } else { OVERLAP_MM };
            pair[1] - pair[0] + overlap
        });
        carried.fold(0.0, f64::max)
    };
    let page = page.cut_off(media.paper, longest(if page.setup.turned { &x } else { &y }))?;
    let ends = |edges: &[f64]| (edges[0], edges[edges.len() - 1]);
    let ((left, right), (top, bottom)) = (ends(&x), ends(&y));
    let from = |edges: &[f64], zero: f64| edges.iter().map(|edge| edge - zero).collect::<Vec<_>>();
    let layout = SheetLayout::cut_at(page, &from(&x, left), &from(&y, top), [0.0, OVERLAP_MM, 0.0]);
    Ok((layout, RectMm::new(left, -bottom, right, -top)))
}

/// Returns the flat tags that do not lie wholly on any sheet.
fn cut_tags(mat: &Mat, layout: &SheetLayout, paper: RectMm) -> Vec<u32> {
    let is_on = |plan: &SheetPlan, tag: RectMm| tag.is_within(&on_ground(paper, plan.own));
    let is_cut = |tag: RectMm| !layout.sheets.iter().any(|plan| is_on(plan, tag));
    let cut = mat.tags.iter().filter(|(_, tag)| is_cut(RectMm::around(tag)));
    cut.map(|(id, _)| *id).collect()
}

/// Returns true if the sheets are connected across seams.
fn hang_together(sheets: &[SheetPlan]) -> bool {
    let mut reached: Vec<usize> = sheets.first().map(|_| 0).into_iter().collect();
    let mut next = 0;
    while let Some(here) = reached.get(next).map(|i| &sheets[*i]) {
        let beside = |plan: &SheetPlan| plan.row.abs_diff(here.row) + plan.column.abs_diff(here.column) == 1;
        let more: Vec<_> = (0..sheets.len())
            .filter(|i| beside(&sheets[*i]) && !reached.contains(i))
            .collect();
        reached.extend(more);
        next += 1;
    }
    !sheets.is_empty() && reached.len() == sheets.len()
}

/// Cost of a layout of the ground: sheets (of a roll, mm²), tags that are cut, strips.
type Cost = (f64, usize, usize);

impl Ground {
    fn cost(&self, media: Media, others: &[(f64, f64)]) -> Result<Cost, TagPrintError> {
        let sheets = self.layout.sheets.len() as f64;
        let paper = match media.paper {
            Stock::Roll { .. } => sheets * self.layout.frame.page.width_mm * self.layout.frame.page.height_mm,
            Stock::Cut(_) => {
                let strips = self
                    .strips
                    .iter()
                    .map(|strip| (strip.length_mm, super::strip::WIDTH_MM));
                let sizes: Vec<_> = others.iter().copied().chain(strips).collect();
                sheets + piece::pages(&sizes, media)? as f64
            }
        };
        Ok((paper, self.cut_tags.len(), self.strips.len()))
    }
}
