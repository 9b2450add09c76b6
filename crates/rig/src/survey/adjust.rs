//! Bundle adjustment: tag poses and photo poses that together put every corner nearest to where it was seen.
//!
//! Levenberg–Marquardt with the photos eliminated (Triggs et al. 2000, "Bundle Adjustment – A Modern Synthesis", section 6.1), so that
//! the system to solve has six unknowns a free tag, however many photos there are.

use nalgebra::{Cholesky, DMatrix, DVector, Matrix6, Vector6};

use super::network::{Node, Poses, Sighting, TagNetwork};
use super::residual::{NO_PIXEL, linear};
use scaleproof_core::geometry::rigid;
use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};
use scaleproof_pose::scene::corners_in_tag_mm;

/// What a corner's weighted squared distance costs.
#[derive(Debug, Clone, Copy)]
pub(super) enum Loss {
    Squared,
    /// `s² ln(1 + e²/s²)`: a corner far beyond the scale hardly pulls.
    Cauchy {
        scale_px: f64,
    },
}

impl Loss {
    pub(super) fn cost(self, squared_px: f64) -> f64 {
        match self {
            Loss::Squared => squared_px,
            Loss::Cauchy { scale_px: s } => s * s * (squared_px / (s * s)).ln_1p(),
        }
    }

    fn weight(self, squared_px: f64) -> f64 {
        match self {
            Loss::Squared => 1.0,
            Loss::Cauchy { scale_px: s } => 1.0 / (1.0 + squared_px / (s * s)),
        }
    }
}

/// Which poses may change; only those that are known are adjusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Free {
    /// Every photo and every tag that is not fixed.
    All,
    Only(Node),
}

/// The total cost of the sightings whose two poses are known.
pub(super) fn cost(net: &TagNetwork, poses: &Poses, loss: Loss) -> f64 {
    let cost = |s| Some(net.squared_px(s, poses)?.iter().map(|e| loss.cost(*e)).sum::<f64>());
    net.sightings.iter().filter_map(cost).sum()
}

/// Moves the free poses downhill until nothing is gained any more, and returns the cost.
pub(super) fn adjust(net: &TagNetwork, poses: &mut Poses, free: Free, loss: Loss, most_steps: usize) -> f64 {
    let limits = Limits {
        first_damping: 1e-3,
        most_trials: 10 * most_steps, // those that are refused count, too
        relative_gain: 1e-9,
        absolute_gain: 1e-12,
    };
    let start = NetworkEquations::at(net, free, loss, poses.clone());
    let found = minimise(start, &limits);
    *poses = found.poses;
    found.cost
}

/// The cost after one step of the adjustment of all poses: nearly the least, where they are nearly the best.
pub(super) fn cost_after_step(net: &TagNetwork, poses: &Poses, loss: Loss) -> f64 {
    let stepped = NetworkEquations::at(net, Free::All, loss, poses.clone()).stepped(1e-6);
    stepped.map_or(f64::INFINITY, |stepped| stepped.cost)
}

/// The covariance of each free tag for corners of σ = 1 px per coordinate: translation (mm) and rotation (rad) in the tag's own
/// frame, relative to the fixed tags. `None` when the photos leave something undetermined.
pub(super) fn covariances(net: &TagNetwork, poses: &Poses) -> Option<Vec<Option<Matrix6<f64>>>> {
    let normal = NetworkEquations::at(net, Free::All, Loss::Squared, poses.clone());
    let inverse = Cholesky::new(normal.reduced(0.0)?.0)?.inverse();
    let block = |slot: &Option<usize>| slot.map(|s| inverse.fixed_view::<6, 6>(6 * s, 6 * s).into_owned());
    Some(normal.slots.tags.iter().map(block).collect())
}

/// How many numbers are adjusted when all is free.
pub(super) fn unknowns(net: &TagNetwork, poses: &Poses) -> usize {
    let slots = Slots::new(net, poses, Free::All);
    6 * (slots.tags.iter().chain(&slots.photos).flatten().count())
}

/// Places of the free poses in the system.
struct Slots {
    tags: Vec<Option<usize>>,
    photos: Vec<Option<usize>>,
}

impl Slots {
    fn new(net: &TagNetwork, poses: &Poses, free: Free) -> Slots {
        let used = |known: &dyn Fn(usize) -> bool, count: usize| {
            let mut next = 0..;
            (0..count).map(|i| known(i).then(|| next.next())?).collect()
        };
        let sees = |s: &Sighting| poses.camera_tag(s).is_some();
        let tag = |t: usize| {
            let may_move = free == Free::Only(Node::Tag(t)) || free == Free::All && !net.is_fixed(t);
            may_move && net.sightings_of(Node::Tag(t)).any(sees)
        };
        let photo = |p: usize| {
            let may_move = free == Free::Only(Node::Photo(p)) || free == Free::All;
            may_move && net.sightings_of(Node::Photo(p)).any(sees)
        };
        Slots {
            tags: used(&tag, net.tags.len()),
            photos: used(&photo, net.photos),
        }
    }
}

/// The normal equations `H δ = −g`, in blocks.
struct NetworkEquations<'a> {
    net: &'a TagNetwork<'a>,
    free: Free,
    loss: Loss,
    poses: Poses,
    cost: f64,
    slots: Slots,
    tags: Vec<Matrix6<f64>>,
    photos: Vec<Matrix6<f64>>,
    /// For each photo, the tags it ties to: (tag slot, the block of that tag's rows and this photo's columns).
    ties: Vec<Vec<(usize, Matrix6<f64>)>>,
    tag_gradient: Vec<Vector6<f64>>,
    photo_gradient: Vec<Vector6<f64>>,
}

/// The tags' own system (matrix and right side), and the inverses of the photos' blocks that led to it.
type Reduced = (DMatrix<f64>, DVector<f64>, Vec<Matrix6<f64>>);

impl<'a> NetworkEquations<'a> {
    fn at(net: &'a TagNetwork<'a>, free: Free, loss: Loss, poses: Poses) -> NetworkEquations<'a> {
        let slots = Slots::new(net, &poses, free);
        let [tags, photos] = [&slots.tags, &slots.photos].map(|slots| slots.iter().flatten().count());
        let mut normal = NetworkEquations {
            net,
            free,
            loss,
            poses,
            cost: 0.0,
            slots,
            tags: vec![Matrix6::zeros(); tags],
            photos: vec![Matrix6::zeros(); photos],
            ties: vec![Vec::new(); photos],
            tag_gradient: vec![Vector6::zeros(); tags],
            photo_gradient: vec![Vector6::zeros(); photos],
        };
        net.sightings.iter().for_each(|s| normal.add(s));
        normal
    }

    /// Adds a sighting whose two poses are known.
    fn add(&mut self, s: &Sighting) {
        let Some(camera_tag) = self.poses.camera_tag(s) else {
            return;
        };
        let (net, loss) = (self.net, self.loss);
        let (tag, photo) = (self.slots.tags[s.tag], self.slots.photos[s.photo]);
        let mut tie = Matrix6::zeros();
        for (corner, seen) in corners_in_tag_mm(net.tags[s.tag].size_mm).iter().zip(&s.corners_px) {
            let Some(l) = linear(&camera_tag, corner, seen, net.camera) else {
                self.cost += loss.cost(s.weight * NO_PIXEL);
                continue;
            };
            let squared_px = s.weight * l.residual.norm_squared();
            self.cost += loss.cost(squared_px);
            let w = s.weight * loss.weight(squared_px);
            if let Some(t) = tag {
                self.tags[t] += w * l.by_tag.transpose() * l.by_tag;
                self.tag_gradient[t] += w * l.by_tag.transpose() * l.residual;
            }
            if let Some(p) = photo {
                self.photos[p] += w * l.by_photo.transpose() * l.by_photo;
                self.photo_gradient[p] += w * l.by_photo.transpose() * l.residual;
            }
            tie += w * l.by_tag.transpose() * l.by_photo;
        }
        if let (Some(t), Some(p)) = (tag, photo) {
            self.ties[p].push((t, tie));
        }
    }

    /// The tags' own system once the photos are eliminated; `None` when a photo's pose is open.
    fn reduced(&self, damping: f64) -> Option<Reduced> {
        let damped = |m: &Matrix6<f64>| m + Matrix6::from_diagonal(&(m.diagonal() * damping));
        let n = 6 * self.tags.len();
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (t, block) in self.tags.iter().enumerate() {
            matrix.fixed_view_mut::<6, 6>(6 * t, 6 * t).copy_from(&damped(block));
            right.fixed_rows_mut::<6>(6 * t).copy_from(&-self.tag_gradient[t]);
        }
        let mut inverses = Vec::with_capacity(self.photos.len());
        for (p, block) in self.photos.iter().enumerate() {
            let inverse = Cholesky::new(damped(block))?.inverse();
            for (a, tie_a) in &self.ties[p] {
                let through = tie_a * inverse;
                let mut rows = right.fixed_rows_mut::<6>(6 * a);
                rows += through * self.photo_gradient[p];
                for (b, tie_b) in &self.ties[p] {
                    let mut view = matrix.fixed_view_mut::<6, 6>(6 * a, 6 * b);
                    view -= through * tie_b.transpose();
                }
            }
            inverses.push(inverse);
        }
        Some((matrix, right, inverses))
    }

    /// The poses after the step that solves the equations.
    fn moved(&self, damping: f64) -> Option<Poses> {
        let (matrix, right, inverses) = self.reduced(damping)?;
        let tags = if right.is_empty() {
            right
        } else {
            Cholesky::new(matrix)?.solve(&right)
        };
        let photo = |p: usize| {
            let tied = self.ties[p].iter();
            let tied: Vector6<f64> = tied.map(|(t, tie)| tie.transpose() * tags.fixed_rows::<6>(6 * t)).sum();
            inverses[p] * -(self.photo_gradient[p] + tied)
        };
        let exp = |d: &[f64]| rigid::from_rotation_vector([d[3], d[4], d[5]], [d[0], d[1], d[2]]);
        let mut moved = self.poses.clone();
        for (pose, slot) in moved.tags.iter_mut().zip(&self.slots.tags) {
            if let (Some(pose), Some(s)) = (pose, slot) {
                *pose *= exp(&tags.as_slice()[6 * s..6 * s + 6]);
            }
        }
        for (pose, slot) in moved.photos.iter_mut().zip(&self.slots.photos) {
            if let (Some(pose), Some(s)) = (pose, slot) {
                *pose = exp(photo(*s).as_slice()) * *pose;
            }
        }
        Some(moved)
    }
}

impl LeastSquares for NetworkEquations<'_> {
    fn cost(&self) -> f64 {
        self.cost
    }

    fn stepped(&self, damping: f64) -> Option<Self> {
        Some(NetworkEquations::at(
            self.net,
            self.free,
            self.loss,
            self.moved(damping)?,
        ))
    }
}
