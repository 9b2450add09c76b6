//! Place strips for tent cards beyond the mat's paper. One end is glued onto its outline on the mat, the card stands on the other. A strip is a
//! window onto the same drawing as the mat. Geometry only, in the ground frame of [`super::mat`].

use super::mat::{GroundWindow, Mat, on_mat};
use super::tent::Tent;
use crate::shapes::{OutlineMm, TagPlacement, overlap};
use crate::sheet::RectMm;
use scaleproof_core::geometry::Point2;

pub const WIDTH_MM: f64 = 36.0;
/// Length of the part of a strip beneath its card.
const UNDER_MM: f64 = 18.0;
/// Length of the part on the mat (root); a shorter one would let the strip turn.
const ROOT_MM: std::ops::RangeInclusive<f64> = 30.0..=60.0;
/// Gap between a strip and a flat tag.
const CLEAR_MM: f64 = 1.0;
const STEP_MM: f64 = 0.5;
/// Width of paper around the foot of a card that stands on the mat.
const FOOT_MM: f64 = 2.0;

#[derive(Debug, Clone, PartialEq)]
pub struct PlaceStrip {
    /// Index of the tent card, from 0.
    pub tent: usize,
    pub length_mm: f64,
    /// Length of the part glued onto the mat.
    pub root_mm: f64,
    /// Length of the part beneath the card.
    pub under_mm: f64,
    /// Its middle, and the direction from its root to the card.
    pub place: TagPlacement,
}

/// Means by which a tent card's place is marked.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// One foot of the card is drawn completely on the mat.
    OnMat,
    OnStrip(PlaceStrip),
    /// No strip reaches it.
    OutOfReach,
}

impl Standing {
    /// Chooses how the place of a tent card is marked around a mat on some paper; a strip is no longer than `most_mm`.
    pub fn new(number: usize, tent: &Tent, mat: &Mat, paper: RectMm, most_mm: f64) -> Standing {
        let [a_left, a_right, b_right, b_left] = tent.foot_mm().each_ref().map(on_mat);
        let feet = [[a_left, a_right], [b_right, b_left]];
        if feet
            .iter()
            .any(|foot| RectMm::around(foot).grown(FOOT_MM).is_within(&paper))
        {
            return Standing::OnMat;
        }
        let [a, b] = feet.map(|[a, b]| [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]);
        let strip = |foot, other| PlaceStrip::from_foot(number, tent, (foot, other), mat, paper, most_mm);
        let strips = [strip(a, b), strip(b, a)].into_iter().flatten();
        let shortest = strips.min_by(|a, b| a.length_mm.total_cmp(&b.length_mm));
        shortest.map_or(Standing::OutOfReach, Standing::OnStrip)
    }
}

impl PlaceStrip {
    /// Returns a strip from the middle of a foot, away from the other one, until its root lies on the paper and on no tag.
    fn from_foot(
        number: usize,
        tent: &Tent,
        (foot, other): (Point2, Point2),
        mat: &Mat,
        paper: RectMm,
        most_mm: f64,
    ) -> Option<PlaceStrip> {
        let (x, y) = (other[0] - foot[0], other[1] - foot[1]);
        let right = [x / tent.base_mm, y / tent.base_mm];
        let under = UNDER_MM.min(tent.base_mm / 2.0);
        let strip = |reach_mm: f64, root_mm: f64| {
            let middle = (under - reach_mm) / 2.0;
            PlaceStrip {
                tent: number,
                length_mm: reach_mm + under,
                root_mm,
                under_mm: under,
                place: TagPlacement {
                    centre: [foot[0] + middle * right[0], foot[1] + middle * right[1]],
                    right,
                    module_mm: 1.0,
                },
            }
        };
        let steps = |from: f64, to: f64| {
            let all = (0..).map(move |k| from + f64::from(k) * STEP_MM);
            all.take_while(move |step| *step <= to)
        };
        let most = most_mm - under;
        let first =
            |root: f64| steps(root, most).find(|reach| RectMm::around(&strip(*reach, root).root()).is_within(&paper));
        let least = first(*ROOT_MM.start())?;
        let fits = |reach: &f64| strip(*reach, 0.0).is_clear(mat);
        let longest = steps(least, most.min(least + ROOT_MM.end() - ROOT_MM.start()))
            .take_while(fits)
            .last()?;
        Some(strip(longest, ROOT_MM.start() + longest - least))
    }

    pub fn outline(&self) -> OutlineMm {
        let (x, y) = (self.length_mm / 2.0, WIDTH_MM / 2.0);
        self.place.rectangle(-x, -y, x, y)
    }

    pub fn root(&self) -> OutlineMm {
        let (x, y) = (self.length_mm / 2.0, WIDTH_MM / 2.0);
        self.place.rectangle(-x, -y, -x + self.root_mm, y)
    }

    /// Returns the position of the strip's name on the mat: in its root, beside its middle line, on which the model's arrow may lie.
    pub fn name_at(&self) -> Point2 {
        self.place.at((self.root_mm - self.length_mm) / 2.0, WIDTH_MM / 3.0)
    }

    fn is_clear(&self, mat: &Mat) -> bool {
        let (x, y) = (self.length_mm / 2.0 + CLEAR_MM, WIDTH_MM / 2.0 + CLEAR_MM);
        let room = self.place.rectangle(-x, -y, x, y);
        mat.tags.iter().all(|(_, tag)| !overlap(&room, tag))
    }

    /// Returns the ground window of a strip that lies level on a page, with its lower left corner at `at`.
    pub fn window(&self, at: Point2) -> GroundWindow {
        GroundWindow {
            centre: self.place.centre,
            at: [at[0] + self.length_mm / 2.0, at[1] + WIDTH_MM / 2.0],
            right: self.place.right,
            scale: 1.0,
        }
    }

    pub fn area(&self, at: Point2) -> RectMm {
        RectMm::sized(at, (self.length_mm, WIDTH_MM))
    }
}
