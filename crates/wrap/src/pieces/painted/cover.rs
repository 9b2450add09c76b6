//! First page: instructions for painting the model, the paints in the order of spraying, and views of the painted model.

use super::{PaintedPieces, PaintedRequest};
use crate::pieces::exploded;
use scaleproof_plot::lettering::{CAP_HEIGHT, number, printable, shortened};
use scaleproof_print::frame::PageFrame;
use scaleproof_print::paint::swatch;
use scaleproof_print::raster::FlatTriangle;
use scaleproof_print::sheet::{Mark, RectMm, Sheet, TextAnchor};
use scaleproof_print::template::{Captions, cover};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::texture::{SurfacePoint, Tile};

const TEXT_MM: f64 = 2.8;
const ROW_MM: f64 = 5.6;
const COLUMN_MM: f64 = 78.0;
const SWATCH_MM: (f64, f64) = (8.0, 3.8);

pub fn cover(
    made: &PaintedPieces,
    (mesh, tile): (&Mesh, &Tile),
    (frame, captions): (&PageFrame, &Captions),
    request: &PaintedRequest,
) -> Sheet {
    let texts = (&*steps(request), &*made.facts());
    let paint = |piece: usize, triangle: usize, shares: [f64; 3]| {
        let FlatTriangle { triangle, weights, .. } = made.pieces[piece].triangles[triangle];
        let at = SurfacePoint::in_part(triangle, &weights, shares);
        let [column, row] = tile.cell_of(mesh, &at);
        let paint = made.painted.paint_at(column as usize, row as usize);
        made.painted.paints[paint].paint.rgb
    };
    cover::first_page(frame, captions, "Paint on a model", texts, |room| {
        let (mut marks, top_mm) = order(made, room);
        let below = RectMm { top_mm, ..room };
        marks.extend(exploded::views(&made.pieces, Some(&paint), below));
        marks
    })
}

fn steps(request: &PaintedRequest) -> Vec<String> {
    let mut steps = vec![
        "Print at 100 %, without fit to page. Measure both rulers below before you cut anything.".to_owned(),
        "Spray the whole model with paint 1, the base coat: it has no stencil. Let it dry.".to_owned(),
        "Cut the pieces of the sheets 'numbers' out along their lines, lay them on the model as the views (grey: the back of a piece) and the \
         letters of their seams say, and go around each with a soft pencil."
            .to_owned(),
        "Paint by paint, in the order below: cut out what is tinted, the round holes too, and each stencil at its outer line. P and a number \
         beside the ring name the paint."
            .to_owned(),
        "Lay the first stencil of a piece with its dashes on the pencil line, mark its holes on the model, and lay every \
         other stencil of that piece with its holes on these marks. Close the holes with tape."
            .to_owned(),
        "The rim covers the neighbours; crease it where the model bends, and trim it where it does not lie flat. Mask what is beyond it, spray, and \
         lift the stencil when the paint is dry."
            .to_owned(),
        format!(
            "Each stencil is one part: bridges of {} mm hold its islands and let the base coat stand. Touch them up by the \
             sheets 'numbers'; the legend has their area.",
            number(request.min_feature_mm)
        ),
    ];
    if request.mirror {
        steps.push(
            "The stencils are mirrored: cut the film from its back and lay it with the printed side down.".to_owned(),
        );
    }
    steps
}

/// Draws the paints in columns; returns the marks and their lower end.
fn order(made: &PaintedPieces, room: RectMm) -> (Vec<Mark>, f64) {
    let columns = ((room.width_mm() / COLUMN_MM) as usize).max(1);
    let rows = made.painted.paints.len().div_ceil(columns).max(1);
    let baseline = |row: usize| room.top_mm - TEXT_MM - row as f64 * ROW_MM;
    let heading = "Order of spraying (area on paper):";
    let mut marks = vec![Mark::text(
        [room.left_mm, baseline(0)],
        TEXT_MM,
        TextAnchor::Left,
        heading,
    )];
    for (i, (used, area)) in made.painted.paints.iter().zip(&made.areas).enumerate() {
        let (x, y) = (room.left_mm + (i / rows) as f64 * COLUMN_MM, baseline(1 + i % rows));
        let text = |mm: f64, anchor: TextAnchor, text: String| Mark::text([x + mm, y], TEXT_MM, anchor, text);
        marks.push(text(5.0, TextAnchor::Right, (i + 1).to_string()));
        let middle = y + 0.5 * CAP_HEIGHT * TEXT_MM;
        let (wide, high) = SWATCH_MM;
        let at = RectMm::new(x + 7.0, middle - 0.5 * high, x + 7.0 + wide, middle + 0.5 * high);
        marks.extend(swatch(at, used.paint.rgb));
        let name = shortened(&printable(&used.paint.name), TEXT_MM, 20.0);
        let name = if i == 0 { format!("{name}, base coat") } else { name };
        marks.push(text(17.0, TextAnchor::Left, name));
        let cm2 = format!("{:.1} cm²", area.cells_mm2 / 100.0);
        marks.push(text(COLUMN_MM - 8.0, TextAnchor::Right, cm2));
    }
    (marks, baseline(rows) - ROW_MM)
}
