//! The tags of a scene on paper: tent cards to cut and fold, a ground mat with the flat tags, and plain cards.
//!
//! What a tag is printed on follows from where it stands ([`arrange`]).

mod arrange;
mod card;
mod mat;
mod mat_sheet;
mod tent;
mod tent_sheet;

pub use arrange::{Arrangement, FLAT_MM, arrange};
pub use tent::{FlatTag, Fold, Net, Panel, TILT_DEG, Tent};

use super::PrintError;
use super::lettering::number;
use super::pack;
use super::page::{Media, Page};
use super::sheet::{Mark, RectMm, Sheet};
use crate::scene::{Scene, Tag, TagFamily};
use crate::tags::TagImage;

/// Smaller modules than this come out of an office printer as mush (about 5 dots at 600 dpi).
const MIN_MODULE_MM: f64 = 0.2;
/// The thickness of cut and fold lines.
const LINE_MM: f64 = 0.2;

/// Why no tags were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TagPrintError {
    #[error(transparent)]
    Print(#[from] PrintError),
    #[error("the scene has no tags; add [[tag]] tables to it, or make one with `scaleproof scene new`")]
    NoTags,
    #[error("tag {id} of {family} could not be drawn: the AprilTag library does not have it")]
    NoImage { family: &'static str, id: u32 },
    #[error(
        "tag {id} would have modules of {module_mm:.3} mm, smaller than the {MIN_MODULE_MM} mm a printer can show; use larger tags"
    )]
    ModuleTooSmall { id: u32, module_mm: f64 },
    #[error("{what} takes {needed_mm} mm and the paper has {free_mm} mm for it; use larger paper{instead}")]
    TooLarge {
        what: String,
        needed_mm: String,
        free_mm: String,
        instead: &'static str,
    },
}

/// What to print.
#[derive(Debug, Clone, PartialEq)]
pub struct TagRequest {
    pub media: Media,
    /// Every tag as a plain card, whatever the scene does with it.
    pub plain: bool,
}

/// The pages, and what is on them.
#[derive(Debug, Clone)]
pub struct TagSheets {
    /// Tent cards, then plain cards, then the mat.
    pub sheets: Vec<Sheet>,
    /// One line for each kind of thing printed.
    pub contents: Vec<String>,
    /// Flat tags that the scene puts above the ground by more than it can be wrong by: the highest, in mm.
    pub lifted_mm: Option<f64>,
    /// Things of the scene that stand on each other, or too close to be seen apart: a sentence each.
    pub crowded: Vec<String>,
}

/// Draws the tags of a scene.
///
/// # Errors
/// A scene without tags, tags too small to print, cards too large for the paper.
pub fn tag_sheets(scene: &Scene, request: &TagRequest) -> Result<TagSheets, TagPrintError> {
    if scene.tags.is_empty() {
        return Err(TagPrintError::NoTags);
    }
    let arrangement = if request.plain {
        Arrangement::plain(scene)
    } else {
        arrange(scene)
    };
    let mut made = TagSheets {
        sheets: Vec::new(),
        contents: Vec::new(),
        lifted_mm: arrangement.lifted_mm(),
        crowded: Vec::new(),
    };
    let tents = tent_sheet::sheets(&arrangement.tents, scene, request.media)?;
    made.add(tents, count(arrangement.tents.len(), "tent card"));
    let cards = card::sheets(&arrangement.cards, scene, request.media)?;
    made.add(cards, count(arrangement.cards.len(), "plain card"));
    if !(arrangement.flat.is_empty() && arrangement.tents.is_empty()) {
        let mat = mat::Mat::new(scene, &arrangement)?;
        let size = format!("ground mat of {:.0} × {:.0} mm", mat.size_mm.0, mat.size_mm.1);
        made.crowded = mat.crowded();
        made.add(mat_sheet::sheets(&mat, scene, request.media)?, size);
    }
    Ok(made)
}

impl TagSheets {
    fn add(&mut self, sheets: Vec<Sheet>, what: String) {
        if !sheets.is_empty() {
            self.contents
                .push(format!("{what} on {}", count(sheets.len(), "sheet")));
            self.sheets.extend(sheets);
        }
    }
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// The picture of a tag, checked to be printable.
fn image_of(tag: &Tag) -> Result<TagImage, TagPrintError> {
    let image = TagImage::new(tag.family, tag.id).ok_or(TagPrintError::NoImage {
        family: family_name(tag.family),
        id: tag.id,
    })?;
    let module_mm = tag.size_mm / image.border_modules() as f64;
    if module_mm < MIN_MODULE_MM {
        return Err(TagPrintError::ModuleTooSmall { id: tag.id, module_mm });
    }
    Ok(image)
}

fn family_name(family: TagFamily) -> &'static str {
    TagFamily::ALL
        .iter()
        .find(|(known, _)| *known == family)
        .map_or("an unknown family", |(_, name)| name)
}

/// Things of some sizes spread over the fewest pages, the paper used upright or across.
///
/// # Errors
/// Paper too small for the rulers, or for thing `i`, which `name` puts into words.
fn packed(
    sizes: &[(f64, f64)],
    media: Media,
    name: impl Fn(usize) -> String,
    instead: &'static str,
) -> Result<(Page, Vec<pack::Spot>), TagPrintError> {
    let mut best: Option<(Page, Vec<pack::Spot>)> = None;
    let mut refused = None;
    for page in Page::both_ways(media)? {
        match pack::pack(sizes, page.0.usable) {
            Ok(spots) => {
                let pages = |spots: &[pack::Spot]| spots.last().map_or(0, |spot| spot.page);
                if best.as_ref().is_none_or(|(_, held)| pages(&spots) < pages(held)) {
                    best = Some((page, spots));
                }
            }
            Err(thing) => refused = refused.or(Some((thing, page.0.usable))),
        }
    }
    match (best, refused) {
        (Some(best), _) => Ok(best),
        (None, refused) => {
            let (thing, area) = refused.unwrap_or((0, RectMm::new(0.0, 0.0, 0.0, 0.0)));
            let size = |(width, height): (f64, f64)| format!("{} × {}", number(width), number(height));
            Err(TagPrintError::TooLarge {
                what: name(thing),
                needed_mm: size(sizes.get(thing).copied().unwrap_or_default()),
                free_mm: size((area.width_mm(), area.height_mm())),
                instead,
            })
        }
    }
}

/// The lines at the foot of every page.
fn captions(scene: &Scene, media: Media, how_to: [&str; 2]) -> Vec<String> {
    vec![
        "Print at 100 % (no fit to page): both rulers must measure 100 mm.".to_owned(),
        how_to[0].to_owned(),
        how_to[1].to_owned(),
        format!(
            "scene {} · scale 1:{} · {} · scaleproof {}",
            scene.model.name,
            number(scene.model.scale),
            media.printer.caption(),
            env!("CARGO_PKG_VERSION")
        ),
    ]
}

/// The marks of each page: those of each thing, on its spot.
fn on_pages(spots: &[pack::Spot], things: Vec<Vec<Mark>>) -> Vec<Vec<Mark>> {
    let mut pages: Vec<Vec<Mark>> = Vec::new();
    for (spot, marks) in spots.iter().zip(things) {
        pages.resize_with(pages.len().max(spot.page + 1), Vec::new);
        pages[spot.page].extend(marks);
    }
    pages
}
