//! Floor plan of cards that are set up with a ruler: the scene from above to scale, and a table of the cards' places.
//!
//! Lengths are millimetres of the model frame (x front, y left, origin under the model's centre); directions count from the model's front,
//! counter-clockwise from above.

use nalgebra::Vector3;

use super::mat::{ARROW_MM, GREY, GroundWindow};
use super::{TagPrintError, captions};
use crate::media::Media;
use crate::shapes::{OutlineMm, stroke, stroked};
use crate::sheet::{Mark, RectMm, Sheet, TextAnchor};
use crate::template::cover::titled;
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::{CAP_HEIGHT, number, printable};
use scaleproof_pose::scene::{Scene, Tag};

const TEXT_MM: f64 = 2.6;
const LEADING_MM: f64 = 4.0;
const LINE_MM: f64 = 0.25;
const GAP_MM: f64 = 4.0;
/// Maximum share of the first page for the drawing.
const DRAWING_SHARE: f64 = 0.55;
/// Length on the page of a card's line towards the side it faces, and the distance of its id beyond that.
const POINTER_MM: f64 = 4.0;
const ID_MM: f64 = 2.4;
/// Maximum tilt from horizontal at which a card shows its top instead of the side it faces.
const FLAT_DEG: f64 = 0.5;
/// Usable length of a roll's page.
const ROLL_MM: f64 = 400.0;
/// Denominators of the drawing's scale.
const SCALES: [f64; 22] = [
    1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.5, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 75.0, 100.0,
    200.0, 500.0,
];
/// Columns: heading, and right edge from the left of the table. The first is the card's name.
const COLUMNS: [(&str, f64); 10] = [
    ("id", 22.0),
    ("x", 38.0),
    ("y", 54.0),
    ("height", 70.0),
    ("back", 87.0),
    ("right", 104.0),
    ("distance", 121.0),
    ("heading", 148.0),
    ("tilt", 162.0),
    ("turned", 178.0),
];
const LEGEND: [&str; 3] = [
    "Places are those of the middles of tags, in mm: x to the model's front and y to its left, from the middle of the model; height above the ground.",
    "back, right: from the model's front left corner. distance: from the model's middle, on the ground. heading: where a card faces, or where the top of a",
    "flat one points; 0° is the front, 90° the left. tilt: 0° lies flat, 90° is upright. turned: counter-clockwise in its plane from upright.",
];

/// Place of a card, as measured with a ruler and a protractor.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorPlace {
    /// Azimuth that the card faces, or of its top if it lies flat.
    pub heading_deg: f64,
    pub lies_flat: bool,
    /// Angle between the card and the ground.
    pub tilt_deg: f64,
    /// Rotation in the card's plane, counter-clockwise from upright.
    pub turned_deg: f64,
}

impl FloorPlace {
    pub fn from_tag(tag: &Tag) -> Self {
        let normal = tag.right.cross(&tag.up);
        let azimuth = |v: &Vector3<f64>| v.y.atan2(v.x).to_degrees().rem_euclid(360.0);
        let tilt_deg = normal.z.clamp(-1.0, 1.0).acos().to_degrees();
        let lies_flat = tilt_deg < FLAT_DEG;
        // Direction straight up within the card's plane.
        let upright = (Vector3::z() - normal * normal.z).try_normalize(1e-9);
        let turned = upright.filter(|_| !lies_flat).map_or(0.0, |upright| {
            let left = normal.cross(&upright);
            tag.up.dot(&left).atan2(tag.up.dot(&upright)).to_degrees()
        });
        Self {
            heading_deg: azimuth(if lies_flat { &tag.up } else { &normal }),
            lies_flat,
            tilt_deg,
            turned_deg: turned,
        }
    }
}

/// Draws the pages: the drawing and the table, which continues over as many as it needs.
pub fn sheets(tags: &[&Tag], scene: &Scene, media: Media) -> Result<Vec<Sheet>, TagPrintError> {
    if tags.is_empty() {
        return Ok(Vec::new());
    }
    let page = media.both_ways()?.swap_remove(0).cut_off(media.paper, ROLL_MM)?;
    let area = page.usable;
    let title = format!("Floor plan of {}", printable(&scene.model.name));
    let (head, body) = titled(area, title);
    let room = RectMm {
        bottom_mm: body.top_mm - DRAWING_SHARE * body.height_mm(),
        ..body
    };
    let (mut marks, drawing_end) = drawing(tags, scene, room);
    marks.push(head);
    let mut pages = Vec::new();
    let mut left = tags;
    let mut top = drawing_end - GAP_MM;
    loop {
        let (table, rest) = table(left, scene, RectMm { top_mm: top, ..body });
        marks.extend(table);
        pages.push(std::mem::take(&mut marks));
        // Stops if a page has room for not even one row, which would repeat forever.
        if rest.is_empty() || (rest.len() == left.len() && pages.len() > 1) {
            break;
        }
        (left, top) = (rest, area.top_mm);
    }
    let how_to = [
        "Measure from the edges of the model, or from a line along its middle and one across; check with the distance.",
        "Seen from above, the model's front to the right.",
    ];
    let captions = captions(scene, media, how_to);
    let sheet = |(i, marks)| page.labelled(page.printable, marks, &captions, &name(i));
    Ok(pages.into_iter().enumerate().map(sheet).collect())
}

/// Returns the name of page `i` (from 0).
pub fn name(i: usize) -> String {
    format!("floor plan {}", i + 1)
}

/// Draws the scene from above in the upper part of an area; returns the marks and the drawing's lower end.
fn drawing(tags: &[&Tag], scene: &Scene, room: RectMm) -> (Vec<Mark>, f64) {
    let [length, width, _] = scene.model.size_mm;
    let model = RectMm::new(-length / 2.0, -width / 2.0, length / 2.0, width / 2.0);
    let feet = tags.iter().map(|tag| RectMm::around(&foot(tag)));
    let shown = feet.fold(model.grown(ARROW_MM), RectMm::union);
    // Room for the ids beyond the cards, on the page.
    let edge = POINTER_MM + 3.0 * ID_MM;
    let (wide, high) = (
        room.width_mm() - 2.0 * edge,
        room.height_mm() - 2.0 * edge - 2.0 * LEADING_MM,
    );
    let fits = |n: &&f64| shown.width_mm() / **n <= wide && shown.height_mm() / **n <= high;
    let one_to = SCALES.iter().find(fits).copied().unwrap_or(1000.0);
    let left = (room.left_mm + room.right_mm - shown.width_mm() / one_to) / 2.0;
    let at = [left, room.top_mm - edge];
    let window = GroundWindow::level([shown.left_mm, shown.top_mm], at, 1.0 / one_to);
    let mut marks = model_marks(model, &window);
    for tag in tags {
        marks.extend(card(tag, &window));
    }
    let below = window.at[1] - shown.height_mm() / one_to - edge;
    marks.extend(scale_bar(one_to, [room.left_mm, below]));
    (marks, below - LEADING_MM)
}

/// Draws the model's outline with an arrow at its front and a cross in its middle, and the two axes.
fn model_marks(model: RectMm, window: &GroundWindow) -> Vec<Mark> {
    let on_page = |x: f64, y: f64| window.on_page([x, y]);
    let front = model.right_mm + 2.0;
    let arrow = [[0.0, -ARROW_MM / 3.0], [ARROW_MM, 0.0], [0.0, ARROW_MM / 3.0]];
    let mut outlines = stroked(&window.outline(&model.outline()), LINE_MM);
    outlines.push(arrow.map(|[x, y]| on_page(front + x, y)).to_vec());
    let (x, y) = (model.right_mm / 3.0, model.top_mm / 2.0);
    outlines.push(stroke(on_page(0.0, 0.0), on_page(x, 0.0), LINE_MM));
    outlines.push(stroke(on_page(0.0, 0.0), on_page(0.0, y), LINE_MM));
    let text = |at: Point2, text: &str| Mark::text([at[0] + 0.8, at[1] - 0.8], ID_MM, TextAnchor::Left, text);
    let corner = on_page(model.right_mm, model.top_mm);
    let beside = |x: f64, y: f64| [corner[0] + x, corner[1] + y];
    outlines.push(stroke(beside(-1.5, 1.5), beside(1.5, -1.5), LINE_MM));
    vec![
        Mark::Area { outlines, colour: GREY },
        text(on_page(x, 0.0), "x"),
        text(on_page(0.0, y), "y"),
        Mark::text(beside(-2.0, -3.0), 2.0, TextAnchor::Right, "front left corner"),
    ]
}

/// Draws a card from above, a line to the side it faces, and its id there.
fn card(tag: &Tag, window: &GroundWindow) -> Vec<Mark> {
    let heading = FloorPlace::from_tag(tag).heading_deg.to_radians();
    let (dx, dy) = (heading.cos(), heading.sin());
    let at = window.on_page([tag.centre_mm.x, tag.centre_mm.y]);
    let end = [at[0] + POINTER_MM * dx, at[1] + POINTER_MM * dy];
    let mut outlines = stroked(&window.outline(&foot(tag)), LINE_MM);
    outlines.push(stroke(at, end, LINE_MM));
    let label = [end[0] + ID_MM * dx, end[1] + ID_MM * dy];
    vec![
        Mark::black(outlines),
        Mark::centred(label, (ID_MM, f64::INFINITY), tag.id.to_string()),
    ]
}

/// Returns a tag's black square projected onto the ground.
fn foot(tag: &Tag) -> OutlineMm {
    tag.corners_mm().map(|p| [p.x, p.y]).to_vec()
}

/// Draws a bar of a round length, with the drawing's scale.
fn scale_bar(one_to: f64, [x, y]: Point2) -> Vec<Mark> {
    let mut lengths = [50.0, 100.0, 200.0, 500.0, 1000.0, 5000.0].into_iter();
    let length = lengths.find(|length| length / one_to >= 20.0).unwrap_or(20_000.0);
    let end = x + length / one_to;
    vec![
        Mark::line([x, y], [end, y], LINE_MM),
        Mark::line([x, y - 1.0], [x, y + 1.0], LINE_MM),
        Mark::line([end, y - 1.0], [end, y + 1.0], LINE_MM),
        Mark::text(
            [end + 2.0, y - 0.5 * CAP_HEIGHT * TEXT_MM],
            TEXT_MM,
            TextAnchor::Left,
            format!("{} mm · drawn 1:{} of the set-up", number(length), number(one_to)),
        ),
    ]
}

/// Draws as many rows as fit; returns the marks and the remaining tags.
fn table<'t, 's>(tags: &'t [&'s Tag], scene: &Scene, room: RectMm) -> (Vec<Mark>, &'t [&'s Tag]) {
    let mut marks = Vec::new();
    let mut y = room.top_mm - CAP_HEIGHT * TEXT_MM;
    for line in LEGEND {
        let size = (TEXT_MM, room.width_mm());
        marks.push(Mark::fitted([room.left_mm, y], size, TextAnchor::Left, line));
        y -= LEADING_MM;
    }
    y -= 0.5 * LEADING_MM;
    let factor = (room.width_mm() / COLUMNS[COLUMNS.len() - 1].1).min(1.0);
    let row = |y: f64, cells: [String; 10]| {
        let mut from = 0.0;
        let cell = |((_, to), text): (&(&str, f64), String)| {
            let size = (TEXT_MM, factor * (to - from) - 1.5);
            from = *to;
            Mark::fitted([room.left_mm + factor * to, y], size, TextAnchor::Right, text)
        };
        COLUMNS.iter().zip(cells).map(cell).collect::<Vec<_>>()
    };
    marks.extend(row(y, COLUMNS.map(|(name, _)| name.to_owned())));
    let end = room.left_mm + factor * 178.0;
    marks.push(Mark::line([room.left_mm, y - 1.2], [end, y - 1.2], 0.15));
    let has_room = ((y - room.bottom_mm) / LEADING_MM).floor().max(0.0) as usize;
    let (now, later) = tags.split_at(has_room.min(tags.len()));
    for tag in now {
        y -= LEADING_MM;
        marks.extend(row(y, cells(tag, scene)));
    }
    (marks, later)
}

fn cells(tag: &Tag, scene: &Scene) -> [String; 10] {
    let [length, width, _] = scene.model.size_mm;
    let (c, place) = (tag.centre_mm, FloorPlace::from_tag(tag));
    let family = if scene.families().len() > 1 {
        format!("{} ", tag.family.name())
    } else {
        String::new()
    };
    let faces = if place.lies_flat { "top to" } else { "faces" };
    [
        format!("{family}{}", tag.id),
        tenth(c.x),
        tenth(c.y),
        tenth(c.z),
        tenth(length / 2.0 - c.x),
        tenth(width / 2.0 - c.y),
        tenth(c.x.hypot(c.y)),
        format!("{faces} {}°", tenth(place.heading_deg)),
        format!("{}°", tenth(place.tilt_deg)),
        format!("{}°", tenth(place.turned_deg)),
    ]
}

/// Formats one decimal, without a minus before zero.
fn tenth(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    format!("{:.1}", if rounded == 0.0 { 0.0 } else { rounded })
}
