//! From the area a paint takes to a stencil that can be cut: one piece of material, nowhere weaker than a least width.
//!
//! *Width* is measured by an upright square of that side: the square can be moved from any place in the material to any other
//! without leaving it, and every point of the material, as of an opening, is inside some such square. It is the stricter of the
//! usual measures, for the square has the disc of the same diameter in it. The rules, in this order and until none
//! applies:
//!
//! 1. a part of an opening that the square does not fit into is not cut;
//! 2. a part of the material that the square does not fit into is widened by the square;
//! 3. two parts of the material that meet, but not by the full width (cells that touch in a corner), are joined by a diagonal bridge;
//! 4. material that hangs together with nothing else gets a straight bridge to the nearest other material.
//!
//! Each of them only adds material, within the paint's own area: no stencil lets a paint where another belongs, and
//! what is bridged is touched up with a brush.

use super::bridges;
use super::plane::{Area, Bounds, PlaneOutline, units};

/// Rounds until all rules hold; real patterns take two to six.
const MOST_ROUNDS: usize = 100;
/// Slanted openings that do not come to rest after so many rounds are not cut.
const PATIENCE: usize = 40;
/// Parts of slanted openings that are no larger are rounding, mm².
const ROUNDED_MM2: f64 = 0.005;
/// Bridges are this much wider, a micrometre on either side, so that they still measure up where slanted cuts are rounded.
const SPARE: i32 = 10;
/// Material narrower than this is rounding, not a part: a micrometre.
const ROUNDING: i32 = 5;

/// What a stencil must hold. Lengths in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// The least width of bridges, of all other material, and of openings.
    pub min_feature_mm: f64,
    /// Material around the region, at least as wide as `min_feature_mm`.
    pub rim_mm: f64,
}

/// A stencil, in the frame of the outlines it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Stencil {
    pub openings: Area,
    /// Material where the paint belongs: to be touched up. With `openings` it makes up the requested area, exactly.
    pub bridges: Area,
    /// The outer edge of the material: the region's bounds and the rim.
    pub outer: Bounds,
}

/// The rules cannot be held; on whole cells of three times the least width this does not happen.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("no stencil with features of {min_feature_mm} mm was found for this shape")]
pub struct NoStencil {
    min_feature_mm: f64,
}

/// How far a shape may be off the upright grid that the widths are measured on. All in units of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slant {
    /// Parts of the material that a square of twice this does not fit into are tips of slanted corners, if they are short.
    tip: i32,
    /// Places that are so near along an outline are joined by it, however it bends.
    around: i32,
    /// Openings that are cut reach so far into their own slanted corners.
    corner: i32,
}

impl Slant {
    /// The slant of cells that lie upright: none.
    pub const NONE: Self = Self {
        tip: ROUNDING,
        around: 0,
        corner: 0,
    };

    /// The slant of cells on a curved surface that was laid flat.
    pub fn of_curved(min_feature_mm: f64) -> Self {
        Self {
            tip: units(0.1 * min_feature_mm),
            around: units(3.0 * min_feature_mm),
            corner: units(0.5 * min_feature_mm),
        }
    }

    /// Slanted edges meet in points that are rounded: what is smaller than that is nothing.
    fn without_rounding(self, mut area: Area) -> Area {
        if self != Self::NONE {
            area.pieces.retain(|piece| Area::from_piece(piece).mm2() > ROUNDED_MM2);
        }
        area
    }
}

/// Cuts `openings` (counter-clockwise outlines, which may overlap), as far as they lie in `region`, from material that reaches a
/// rim beyond the region's bounds.
pub fn stencil(openings: &[PlaneOutline], region: &[PlaneOutline], rules: Rules) -> Result<Stencil, NoStencil> {
    let region = Area::of(region);
    let outer = region.bounds().unwrap_or_default().grown(units(rules.rim_mm));
    let asked = Area::of(openings).and(&region);
    let whole = Area::of(&[outer.outline()]);
    let (openings, bridges) = openings_and_bridges(&asked, &whole, rules.min_feature_mm, Slant::NONE)?;
    Ok(Stencil {
        openings,
        bridges,
        outer,
    })
}

/// What is cut of `asked` from a sheet of material, and what is not. What is thin or apart in the sheet itself stays so.
pub fn openings_and_bridges(
    asked: &Area,
    whole: &Area,
    min_feature_mm: f64,
    slant: Slant,
) -> Result<(Area, Area), NoStencil> {
    let half = units(0.5 * min_feature_mm);
    let mut openings = asked.clone();
    for round in 0..MOST_ROUNDS {
        openings = openings.opened(half).grown(slant.corner).and(&openings);
        let more = missing(whole, &openings, half, slant);
        if more.is_empty() {
            let bridges = asked.without(&openings);
            return Ok((openings, bridges));
        }
        openings = if slant == Slant::NONE || round < PATIENCE {
            openings.without(&more)
        } else {
            off(openings, &more)
        };
    }
    // A sheet that holds together is one, even if a corner of it is a little too narrow.
    let is_one = whole.without(&openings).pieces.len() == whole.pieces.len();
    if slant != Slant::NONE && is_one {
        Ok((openings.clone(), asked.without(&openings)))
    } else {
        Err(NoStencil { min_feature_mm })
    }
}

fn off(mut openings: Area, something: &Area) -> Area {
    openings
        .pieces
        .retain(|piece| Area::from_piece(piece).and(something).is_empty());
    openings
}

/// What the material must take of the openings, by the first of the rules that is broken.
fn missing(whole: &Area, openings: &Area, half: i32, slant: Slant) -> Area {
    let material = whole.without(openings);
    let core = material.shrunk(half);
    let thin = thin(&material.without(&core.grown(half)), half, slant);
    if !thin.is_empty() {
        let more = slant.without_rounding(thin.grown(half + ROUNDING + SPARE).and(openings));
        if !more.is_empty() {
            return more;
        }
    }
    let joined = |mut links: Vec<bridges::Link>| {
        // What is narrow where the sheet itself ends stays so.
        links.retain(|link| slant == Slant::NONE || whole.contains(bridges::middle(*link)));
        let sweeps = links.iter().map(|(a, b)| super::plane::swept(*a, *b, half + SPARE));
        slant.without_rounding(Area::of(&sweeps.collect::<Vec<_>>()).and(openings))
    };
    let more = joined(bridges::necks(&core, 2 * half, slant.around));
    if more.is_empty() {
        joined(bridges::nearest(&core))
    } else {
        more
    }
}

/// The parts that the square does not cover, without rounding and the tips of slanted corners.
fn thin(uncovered: &Area, half: i32, slant: Slant) -> Area {
    let is_long = |piece: &Vec<PlaneOutline>| {
        let bounds = Area::from_piece(piece).bounds();
        bounds.is_some_and(|b| (b.right - b.left).max(b.top - b.bottom) > 3 * half)
    };
    let wide = uncovered.shrunk(slant.tip);
    if slant == Slant::NONE {
        return wide;
    }
    let pieces = uncovered.shrunk(ROUNDING).pieces.into_iter();
    wide.with(&pieces.filter(is_long).flatten().collect::<Vec<_>>())
}
