//! Construction of a stencil that can be cut from the area of a paint: one piece of material, nowhere narrower than a minimum width.
//!
//! *Width* is measured by an upright square of that side: the square can be moved from any place in the material to any other without leaving it, and
//! every point of the material, as of an opening, is inside some such square. It is the stricter of the usual measures, since the square contains the
//! disc of the same diameter. Rules, applied in this order until none applies:
//!
//! 1. a part of an opening that the square does not fit into is not cut;
//! 2. a part of the material that the square does not fit into is widened by the square;
//! 3. two parts of the material that meet, but not by the full width (cells that touch in a corner), are joined by a diagonal bridge;
//! 4. material without connection to the rest gets a straight bridge to the nearest other material.
//!
//! Each of them only adds material, within the paint's own area: no stencil lets a paint onto another's area, and bridged parts are touched up with a
//! brush.

use super::bridges;
use super::plane::{Area, Bounds, PlaneOutline, units};

/// Maximum number of rounds until all rules hold; real patterns take two to six.
const MOST_ROUNDS: usize = 100;
/// Number of rounds after which slanted openings that still change are not cut.
const PATIENCE: usize = 40;
/// Area up to which parts of slanted openings are rounding, mm².
const ROUNDED_MM2: f64 = 0.005;
/// Extra width of bridges, a micrometre on either side, so that they keep their width if slanted cuts are rounded.
const SPARE: i32 = 10;
/// Width below which material is rounding, not a part: a micrometre.
const ROUNDING: i32 = 5;

/// Dimensions that a stencil must have. Lengths in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Minimum width of bridges, of all other material, and of openings.
    pub min_feature_mm: f64,
    /// Width of the material around the region, at least `min_feature_mm`.
    pub rim_mm: f64,
}

/// A stencil, in the frame of the outlines it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Stencil {
    pub openings: Area,
    /// Material on the paint's own area: to be touched up. With `openings` it adds up to the requested area, exactly.
    pub bridges: Area,
    /// The outer edge of the material: the region's bounds and the rim.
    pub outer: Bounds,
}

/// Error for rules that cannot be fulfilled; on whole cells of three times the minimum width this does not happen.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("no stencil with features of {min_feature_mm} mm was found for this shape")]
pub struct NoStencil {
    min_feature_mm: f64,
}

/// Tolerances for shapes that are not aligned with the upright grid by which widths are measured. All in units of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slant {
    /// Half side of a square; short parts of the material that it does not fit into are tips of slanted corners.
    tip: i32,
    /// Distance along an outline up to which points count as joined by it, however it bends.
    around: i32,
    /// Distance by which cut openings may reach into their own slanted corners.
    corner: i32,
}

impl Slant {
    /// No slant: upright cells.
    pub const NONE: Self = Self {
        tip: ROUNDING,
        around: 0,
        corner: 0,
    };

    /// Returns the slant of cells on a curved surface that was laid flat.
    pub fn of_curved(min_feature_mm: f64) -> Self {
        Self {
            tip: units(0.1 * min_feature_mm),
            around: units(3.0 * min_feature_mm),
            corner: units(0.5 * min_feature_mm),
        }
    }

    /// Removes tiny pieces, which stem from the rounding of intersections of slanted edges.
    fn without_rounding(self, mut area: Area) -> Area {
        if self != Self::NONE {
            area.pieces.retain(|piece| Area::from_piece(piece).mm2() > ROUNDED_MM2);
        }
        area
    }
}

/// Cuts `openings` (counter-clockwise outlines, which may overlap), as far as they lie in `region`, from material that extends by a rim beyond the
/// region's bounds.
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

/// Divides `asked` into the part cut from a sheet of material, and the rest. Thin or separate parts of the sheet itself stay so.
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
    // A connected sheet is accepted, even if a corner of it is a little too narrow.
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

/// Returns the part of the openings that must become material, by the first rule that is broken.
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
        // Material that is narrow at the sheet's own edge stays so.
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

/// Returns the parts that the square does not cover, without rounding and the tips of slanted corners.
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
