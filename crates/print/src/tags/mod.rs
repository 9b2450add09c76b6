//! Tags of a scene on paper: tent cards to cut and fold, a ground mat with the flat tags, and plain cards.
//!
//! The kind of print follows from a tag's pose ([`arrange`]).

mod arrange;
mod cards;
mod error;
mod floor_plan;
mod ground;
mod ground_sheets;
mod map;
mod marks;
mod mat;
mod piece;
mod request;
pub mod seams;
mod strip;
mod tent;

pub use error::{Instead, TagPrintError};
pub(crate) use marks::{LINE_MM, captions, image_of};
pub use request::TagRequest;

pub use arrange::{Arrangement, arrange};
pub use ground::Ground;

use std::fmt;

use super::sheet::{RectMm, Sheet};
use scaleproof_core::spelling::{count, list};
use scaleproof_plot::lettering::number;
use scaleproof_pose::scene::Scene;

#[derive(Debug, Clone, PartialEq)]
pub enum TagNote {
    /// The mat has tags at height 0 that the scene has at this height.
    Lowered {
        height_mm: f64,
    },
    /// Names of two objects that overlap on the mat.
    Overlap([String; 2]),
    /// Ids of tags cut by the mat's seams.
    CutTags(Vec<u32>),
    PlaceStrips,
}

impl fmt::Display for TagNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lowered { height_mm } => write!(
                f,
                "the scene has flat tags at a height of {} mm; the mat puts them at 0",
                number(*height_mm)
            ),
            Self::Overlap([a, b]) => write!(f, "{a} and {b} overlap on the mat: move one of them in the scene"),
            Self::CutTags(ids) if ids.len() == 1 => write!(
                f,
                "a seam of the mat runs through tag {} however the sheets are laid; glue it exactly, or lay a plain card over it",
                ids[0]
            ),
            Self::CutTags(ids) => write!(
                f,
                "seams of the mat run through tags {} however the sheets are laid; glue them exactly, or lay plain cards over them",
                list(ids)
            ),
            Self::PlaceStrips => write!(f, "place strips save sheets and put cards within about 1 mm"),
        }
    }
}

#[derive(Debug, Clone)]
pub struct TagSheets {
    /// The map, the floor plan of plain cards, cards and strips, then the mat.
    pub sheets: Vec<Sheet>,
    /// Name of each sheet on the map, and in the name of its file.
    pub names: Vec<String>,
    pub contents: Vec<String>,
    pub cut_out: Vec<CutOut>,
    pub ground: Option<Ground>,
    pub notes: Vec<TagNote>,
}

/// Card or strip on its sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct CutOut {
    pub name: String,
    pub sheet: usize,
    /// Its area in true millimetres (page frame).
    pub area: RectMm,
}

/// Draws the tags of a scene.
pub fn tag_sheets(scene: &Scene, request: &TagRequest) -> Result<TagSheets, TagPrintError> {
    if scene.tags.is_empty() {
        return Err(TagPrintError::NoTags);
    }
    let arrangement = if request.plain {
        Arrangement::plain(scene)
    } else {
        arrange(scene)
    };
    let media = request.media;
    piece::placed(&pieces(&arrangement, None)?, media)?;
    let ground = ground(scene, &arrangement, request)?;
    let cards = piece::spread(&pieces(&arrangement, ground.as_ref())?, media)?;
    let plans = floor_plan::sheets(&arrangement.cards, scene, media)?;
    let plan_names: Vec<String> = (0..plans.len()).map(floor_plan::name).collect();
    let card_names: Vec<String> = (1..=cards.len()).map(|n| format!("cards {n}")).collect();
    let map = map::TagMap {
        scene,
        media,
        arrangement: &arrangement,
        ground: ground.as_ref(),
        cards: &cards,
        plan_names: &plan_names,
        card_names: &card_names,
    };
    let mut sheets = vec![map.sheet()?];
    sheets.extend(plans);
    let first_card = sheets.len();
    let captions = captions(scene, media, cards_how_to(&arrangement));
    let named = cards.iter().zip(&card_names);
    sheets.extend(named.map(|(on, name)| on.page.labelled(on.page.printable, on.marks.clone(), &captions, name)));
    sheets.extend(
        ground
            .iter()
            .flat_map(|ground| ground_sheets::sheets(ground, scene, media)),
    );
    let cut_out = cards.iter().zip(first_card..).flat_map(|(page, sheet)| {
        let piece = move |(name, area): &(String, RectMm)| CutOut {
            name: name.clone(),
            sheet,
            area: *area,
        };
        page.names.iter().map(piece)
    });
    let mat_names = ground.as_ref().map(Ground::names).unwrap_or_default();
    let names = [
        vec!["map".to_owned()],
        plan_names.clone(),
        card_names.clone(),
        mat_names,
    ];
    Ok(TagSheets {
        names: names.concat(),
        contents: contents(&arrangement, ground.as_ref(), plan_names.len(), cards.len()),
        cut_out: cut_out.collect(),
        notes: notes(&arrangement, ground.as_ref()),
        ground,
        sheets,
    })
}

fn pieces<'a>(
    arrangement: &'a Arrangement,
    ground: Option<&'a Ground>,
) -> Result<Vec<piece::CutPiece<'a>>, TagPrintError> {
    let mut pieces = cards::tents(&arrangement.tents);
    pieces.extend(cards::plain(&arrangement.cards)?);
    pieces.extend(ground.into_iter().flat_map(ground_sheets::strips));
    Ok(pieces)
}

fn ground(scene: &Scene, arrangement: &Arrangement, request: &TagRequest) -> Result<Option<Ground>, TagPrintError> {
    if arrangement.flat.is_empty() && arrangement.tents.is_empty() {
        return Ok(None);
    }
    let sizes: Vec<_> = pieces(arrangement, None)?.iter().map(|piece| piece.size_mm).collect();
    let mat = mat::Mat::new(scene, arrangement)?;
    Ground::new(mat, arrangement, request, &sizes).map(Some)
}

fn contents(arrangement: &Arrangement, ground: Option<&Ground>, plans: usize, cards: usize) -> Vec<String> {
    let strips = ground.map_or(0, |ground| ground.strips.len());
    let kinds = [
        (arrangement.tents.len(), "tent card"),
        (arrangement.cards.len(), "plain card"),
        (strips, "place strip"),
    ];
    let kinds = kinds.into_iter().filter(|(n, _)| *n > 0);
    let kinds: Vec<_> = kinds.map(|(n, what)| count(n, what)).collect();
    let mut contents = vec!["a map".to_owned()];
    if plans > 0 {
        contents.push(format!("a floor plan on {}", count(plans, "sheet")));
    }
    if cards > 0 {
        contents.push(format!("{} on {}", kinds.join(" and "), count(cards, "sheet")));
    }
    if let Some(ground) = ground {
        let (wide, high) = (ground.paper.width_mm(), ground.paper.height_mm());
        let sheets = count(ground.layout.sheets.len(), "sheet");
        contents.push(format!("a ground mat of {wide:.0} × {high:.0} mm on {sheets}"));
    }
    contents
}

fn notes(arrangement: &Arrangement, ground: Option<&Ground>) -> Vec<TagNote> {
    let lowered = arrangement.lifted_mm().map(|height_mm| TagNote::Lowered { height_mm });
    let mut notes: Vec<TagNote> = lowered.into_iter().collect();
    let Some(ground) = ground else { return notes };
    notes.extend(ground.mat.overlaps().map(TagNote::Overlap));
    if !ground.cut_tags.is_empty() {
        notes.push(TagNote::CutTags(ground.cut_tags.clone()));
    }
    if !ground.strips.is_empty() {
        notes.push(TagNote::PlaceStrips);
    }
    notes
}

fn cards_how_to(arrangement: &Arrangement) -> [&'static str; 2] {
    let tents = [
        "Cut along the solid lines, crease along the dashed ones, fold away from the print, glue the tab inside the base.",
        "Stand each card on its outline on the ground mat or its place strip, each tag on the side that carries its number.",
    ];
    let cards = [
        "Cut along the solid lines; the white around a tag belongs to it.",
        "Fix each card where the floor plan says, with its triangle towards the tag's up direction.",
    ];
    match (arrangement.tents.is_empty(), arrangement.cards.is_empty()) {
        (true, _) => cards,
        (false, true) => tents,
        (false, false) => [tents[0], cards[1]],
    }
}
