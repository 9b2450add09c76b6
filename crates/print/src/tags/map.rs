//! First page: the steps in order, the map of all sheets, and the scale check that is filled in by hand.

use super::ground::Ground;
use super::mat::{GREY, GroundWindow};
use super::piece::PiecePage;
use super::{Arrangement, TagPrintError, captions};
use crate::media::Media;
use crate::shapes::{OutlineMm, stroked};
use crate::sheet::{BLACK, Mark, RectMm, Sheet, Srgb8, TextAnchor};
use crate::template::cover::instructions;
use crate::template::layout::ROLL_COVER_MM;
use scaleproof_core::spelling::count;
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm, printable};
use scaleproof_pose::scene::Scene;

const GAP_MM: f64 = 4.0;
/// Maximum size of the map, enough to read it.
const MAP_MOST_MM: f64 = 150.0;
const SHEET_ID_MM: f64 = 5.0;
const NAME_MM: f64 = 2.6;
const LINE_MM: f64 = 0.25;
const THIN_MM: f64 = 0.12;
const PAPER: Srgb8 = [238, 238, 238];
/// Height of the thumbnails of pages with cards.
const THUMBNAIL_MM: std::ops::RangeInclusive<f64> = 8.0..=34.0;
/// Maximum share of the page height for the thumbnails.
const THUMBNAIL_SHARE: f64 = 0.45;

pub struct TagMap<'a> {
    pub scene: &'a Scene,
    pub media: Media,
    pub arrangement: &'a Arrangement<'a>,
    pub ground: Option<&'a Ground>,
    pub cards: &'a [PiecePage],
    /// Names of all other sheets, in their order: floor plan, cards, mat.
    pub plan_names: &'a [String],
    pub card_names: &'a [String],
}

impl TagMap<'_> {
    pub fn sheet(&self) -> Result<Sheet, TagPrintError> {
        let mut page = self.media.both_ways()?.swap_remove(0);
        if !page.setup.turned {
            page = page.cut_off(self.media.paper, ROLL_COVER_MM)?;
        }
        let title = format!("Tags of {}: how to set them up", printable(&self.scene.model.name));
        let marks = instructions(&page, title, (&self.steps(), &[]), |room| self.pictures(room));
        let how_to = [
            "Keep this page beside you while you cut: it names every sheet.",
            "Seen from above, the model's front to the right.",
        ];
        let captions = captions(self.scene, self.media, how_to);
        Ok(page.labelled(page.printable, marks, &captions, "map"))
    }

    fn pictures(&self, room: RectMm) -> Vec<Mark> {
        let (mut marks, top) = self.thumbnails(room);
        let bottom_mm = top + GAP_MM;
        let map = |ground| self.ground_map(ground, RectMm { bottom_mm, ..room });
        marks.extend(self.ground.into_iter().flat_map(map));
        marks
    }

    /// Returns the steps, in plain words.
    fn steps(&self) -> Vec<String> {
        let mat = self.mat_names();
        let all = 1 + self.plan_names.len() + self.card_names.len() + mat.len();
        let kinds = [self.plan_names, self.card_names, &mat];
        let named: Vec<String> = kinds.iter().filter_map(|names| span(names)).collect();
        let (all, named) = (count(all, "sheet"), named.join(", "));
        let mut steps = vec![format!(
            "Print all {all} at 100 %, without fit to page: this map, {named}."
        )];
        let mut add = |step: &str| steps.push(step.to_owned());
        add("Measure both rulers below with a steel ruler before you cut anything.");
        if mat.len() > 1 {
            add(
                "Ground mat: lay its sheets out as on the map. Cut each at the crop marks, but leave the strip beyond a dashed line: it \
                 goes under the next sheet, whose edge is glued on the dashed line. Seams that meet have the same letter. Go row by \
                 row from the top left.",
            );
        } else if mat.len() == 1 {
            add("Ground mat: cut it out at the crop marks.");
        }
        if self.ground.is_some_and(|ground| !ground.strips.is_empty()) {
            add(
                "Place strips: cut them out, and glue the marked end of each onto its outline on the mat, so that the lines of both run on.",
            );
        }
        if !self.arrangement.tents.is_empty() {
            add(
                "Tent cards: cut along the solid lines, crease the dashed ones, fold away from the print, glue the tab inside the base. Stand \
                 each on its outline, its foot on the line and the marks in the middle together, each tag on the side with its number.",
            );
        }
        if !self.arrangement.cards.is_empty() {
            add("Plain cards: cut them out and fix each where the floor plan says.");
        }
        if self.ground.is_some() {
            add(
                "Stand the model on its outline, its front at the arrow. Fix the mat, so that nothing moves between photos.",
            );
        } else {
            add(
                "Nothing may move between photos. A card that is not quite in its place spoils poses: `scaleproof survey` finds from \
                 photos where cards really stand.",
            );
        }
        steps
    }

    fn mat_names(&self) -> Vec<String> {
        self.ground.map(Ground::names).unwrap_or_default()
    }

    /// Draws the ground with the sheets of the mat behind it.
    fn ground_map(&self, ground: &Ground, room: RectMm) -> Vec<Mark> {
        let strips: Vec<OutlineMm> = ground.strips.iter().map(super::strip::PlaceStrip::outline).collect();
        let all = ground.paper.union(ground.mat.whole());
        let shown = strips.iter().map(RectMm::around).fold(all, RectMm::union);
        let (wide, high) = (room.width_mm().min(MAP_MOST_MM), room.height_mm().min(MAP_MOST_MM));
        let scale = (wide / shown.width_mm()).min(high / shown.height_mm());
        if scale <= 0.0 {
            return Vec::new();
        }
        let left = room.left_mm + (room.width_mm() - scale * shown.width_mm()) / 2.0;
        let window = GroundWindow::level([shown.left_mm, shown.top_mm], [left, room.top_mm], scale);
        let mut marks = Vec::new();
        for plan in &ground.layout.sheets {
            let cell = RectMm::around(&window.outline(&ground.ground(plan.own).outline()));
            marks.extend(paper(cell));
            let size_mm = SHEET_ID_MM.min(0.3 * cell.height_mm()).min(0.3 * cell.width_mm());
            let at = [cell.left_mm + 1.0, cell.top_mm - 1.0 - CAP_HEIGHT * size_mm];
            marks.push(Mark::text(at, size_mm, TextAnchor::Left, plan.id()));
        }
        marks.extend(self.things(ground, &window, &strips));
        marks
    }

    /// Draws model, tags, tent cards and strips.
    fn things(&self, ground: &Ground, window: &GroundWindow, strips: &[OutlineMm]) -> Vec<Mark> {
        let model = ground.mat.model.iter().map(|outline| window.outline(outline));
        let mut marks = vec![area(model.collect(), GREY)];
        let mut named = |outline: &OutlineMm, colour: Srgb8, name: String| {
            let outline = window.outline(outline);
            let around = RectMm::around(&outline);
            marks.push(area(stroked(&outline, LINE_MM), colour));
            let most_mm = 0.9 * around.width_mm().max(around.height_mm());
            marks.push(Mark::centred(around.middle(), (NAME_MM, most_mm), name));
        };
        for strip in strips {
            named(strip, GREY, String::new());
        }
        for (id, tag) in &ground.mat.tags {
            named(tag, BLACK, format!("id {id}"));
        }
        for (i, tent) in self.arrangement.tents.iter().enumerate() {
            let foot = tent.foot_mm().each_ref().map(super::mat::on_mat).to_vec();
            named(&foot, BLACK, format!("T{}", i + 1));
        }
        marks
    }

    /// Draws thumbnails of every page of the floor plan and of cards; returns the marks and their upper end.
    fn thumbnails(&self, room: RectMm) -> (Vec<Mark>, f64) {
        let names: Vec<&String> = self.plan_names.iter().chain(self.card_names).collect();
        let Some(shape) = self.cards.first().map(|page| page.page.page) else {
            return (Vec::new(), room.bottom_mm);
        };
        let share = if self.ground.is_some() { THUMBNAIL_SHARE } else { 1.0 };
        let ratio = shape.width_mm / shape.height_mm;
        let fit = |high: f64| {
            let (wide, high) = (high * ratio + GAP_MM, high + NAME_MM + GAP_MM);
            let a_row = ((room.width_mm() + GAP_MM) / wide).floor().max(1.0) as usize;
            (a_row, names.len().div_ceil(a_row) as f64 * high)
        };
        let mut high = *THUMBNAIL_MM.end();
        while high > *THUMBNAIL_MM.start() && (fit(high).1 > share * room.height_mm() || high * ratio > room.width_mm())
        {
            high -= 1.0;
        }
        let (a_row, all_high) = fit(high);
        let top = (room.bottom_mm + all_high).min(room.top_mm);
        let mut marks = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let x = room.left_mm + (i % a_row) as f64 * (high * ratio + GAP_MM);
            let y = top - (i / a_row) as f64 * (high + NAME_MM + GAP_MM);
            let size = (NAME_MM, high * ratio + GAP_MM - 1.0);
            marks.push(Mark::fitted([x, y - NAME_MM], size, TextAnchor::Left, name.as_str()));
            let cell = RectMm::new(x, y - NAME_MM - 1.0 - high, x + high * ratio, y - NAME_MM - 1.0);
            marks.extend(paper(cell));
            if let Some(page) = i.checked_sub(self.plan_names.len()).and_then(|i| self.cards.get(i)) {
                marks.extend(small(page, cell));
            }
        }
        (marks, top)
    }
}

fn small(page: &PiecePage, cell: RectMm) -> Vec<Mark> {
    let paper = page.page.page;
    let scale = (cell.width_mm() / paper.width_mm).min(cell.height_mm() / paper.height_mm);
    let x = |mm: f64| cell.left_mm + scale * mm;
    let y = |mm: f64| cell.top_mm - scale * (paper.height_mm - mm);
    let mut marks = Vec::new();
    for (name, piece) in &page.names {
        let card = RectMm::new(x(piece.left_mm), y(piece.bottom_mm), x(piece.right_mm), y(piece.top_mm));
        marks.push(area(stroked(&card.outline(), THIN_MM), BLACK));
        let size_mm = fitting_size_mm(name, NAME_MM, 0.9 * card.width_mm()).min(0.8 * card.height_mm());
        marks.push(Mark::centred(card.middle(), (size_mm, f64::INFINITY), name.as_str()));
    }
    marks
}

fn area(outlines: Vec<OutlineMm>, colour: Srgb8) -> Mark {
    Mark::Area { outlines, colour }
}

fn paper(cell: RectMm) -> [Mark; 2] {
    let outline = area(stroked(&cell.outline(), THIN_MM), BLACK);
    [Mark::fill(cell, PAPER), outline]
}

/// Returns a range of names as `mat A1 to C2`, or the only name.
fn span(names: &[String]) -> Option<String> {
    match names {
        [] => None,
        [one] => Some(one.clone()),
        [first, .., last] => Some(format!("{first} to {last}")),
    }
}
