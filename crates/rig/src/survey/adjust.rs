//! Bundle adjustment: tag poses and photo poses that together put every corner nearest to where it was seen.
//!
//! Levenberg–Marquardt with the photos eliminated (Triggs et al. 2000, "Bundle Adjustment – A Modern Synthesis", section 6.1), so that
//! the system to solve has six unknowns a free tag, however many photos there are.

use nalgebra::{Cholesky, DMatrix, Matrix6, Point3, SMatrix, SVector, Vector6};

use super::lens_numbers::{LENS, LensNumbers, derivatives};
use super::network::{Node, Poses, Sighting, TagNetwork};
use super::residual::{LinearisedCorner, NO_PIXEL, linear};
use scaleproof_core::geometry::rigid;
use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};
use scaleproof_pose::scene::corners_in_tag_mm;

/// Cost of a corner's weighted squared distance.
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

/// Poses that may change; only those that are known are adjusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Free {
    /// Every photo and every tag that is not fixed.
    All,
    Only(Node),
}

/// Returns the total cost of the sightings whose two poses are known.
pub(super) fn cost(net: &TagNetwork, poses: &Poses, loss: Loss) -> f64 {
    let cost = |s| Some(net.squared_px(s, poses)?.iter().map(|e| loss.cost(*e)).sum::<f64>());
    net.sightings.iter().filter_map(cost).sum()
}

/// Minimises the cost over the free poses, and returns it.
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

/// Returns the cost after one step of the adjustment of all poses: nearly the least, where they are nearly the best.
pub(super) fn cost_after_step(net: &TagNetwork, poses: &Poses, loss: Loss) -> f64 {
    let stepped = NetworkEquations::at(net, Free::All, loss, poses.clone()).stepped(1e-6);
    stepped.map_or(f64::INFINITY, |stepped| stepped.cost)
}

/// Computes the covariance of each free tag for corners of σ = 1 px per coordinate: translation (mm) and rotation (rad) in the tag's own
/// frame, relative to the fixed tags. `None` when the photos leave something undetermined.
pub(super) fn covariances(net: &TagNetwork, poses: &Poses) -> Option<Vec<Option<Matrix6<f64>>>> {
    let normal = NetworkEquations::at(net, Free::All, Loss::Squared, poses.clone());
    let inverse = Cholesky::new(normal.reduced(0.0)?.0)?.inverse();
    let block = |slot: &Option<usize>| slot.map(|s| inverse.fixed_view::<6, 6>(6 * s, 6 * s).into_owned());
    Some(normal.slots.tags.iter().map(block).collect())
}

/// Normal equations of the lens, the poses eliminated: the cost is least where `curvature · step = −gradient`.
pub(super) struct LensEquations {
    pub curvature: SMatrix<f64, LENS, LENS>,
    pub gradient: LensNumbers,
    /// Derivative of each free tag by the lens: translation (mm) and rotation (rad) in its own frame by each number.
    pub by_tag: Vec<Option<SMatrix<f64, 6, LENS>>>,
}

/// Computes the lens's equations at adjusted poses; `None` when the photos leave something undetermined.
pub(super) fn lens_equations(net: &TagNetwork, poses: &Poses, loss: Loss) -> Option<LensEquations> {
    let normal = NetworkEquations::at(net, Free::All, loss, poses.clone());
    let mut cross = Blocks {
        tags: vec![SMatrix::zeros(); normal.tags.len()],
        photos: vec![SMatrix::zeros(); normal.photos.len()],
    };
    let (mut curvature, mut gradient) = (SMatrix::zeros(), SVector::zeros());
    for (s, point, w, l) in normal.corners() {
        let by_lens = derivatives(&net.camera, &point);
        curvature += w * by_lens.transpose() * by_lens;
        gradient += w * by_lens.transpose() * l.residual;
        if let Some(t) = normal.slots.tags[s.tag] {
            cross.tags[t] += w * l.by_tag.transpose() * by_lens;
        }
        if let Some(p) = normal.slots.photos[s.photo] {
            cross.photos[p] += w * l.by_photo.transpose() * by_lens;
        }
    }
    let solved = normal.solved(0.0, &cross)?;
    let pairs = cross
        .tags
        .iter()
        .zip(&solved.tags)
        .chain(cross.photos.iter().zip(&solved.photos));
    curvature -= pairs
        .map(|(cross, solved)| cross.transpose() * solved)
        .sum::<SMatrix<f64, LENS, LENS>>();
    let by_tag = |slot: &Option<usize>| slot.map(|s| -solved.tags[s]);
    Some(LensEquations {
        curvature,
        gradient,
        by_tag: normal.slots.tags.iter().map(by_tag).collect(),
    })
}

/// Returns the number of parameters that are adjusted when all is free.
pub(super) fn unknowns(net: &TagNetwork, poses: &Poses) -> usize {
    let slots = Slots::new(net, poses, Free::All);
    6 * (slots.tags.iter().chain(&slots.photos).flatten().count())
}

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

/// `K` columns over the free poses: six rows a tag, six a photo.
struct Blocks<const K: usize> {
    tags: Vec<SMatrix<f64, 6, K>>,
    photos: Vec<SMatrix<f64, 6, K>>,
}

/// The normal equations `H δ = −g`, in blocks.
struct NetworkEquations<'a> {
    net: &'a TagNetwork,
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

/// The tags' own system, and the inverses of the photos' blocks that led to it.
type Reduced = (DMatrix<f64>, Vec<Matrix6<f64>>);

impl<'a> NetworkEquations<'a> {
    fn at(net: &'a TagNetwork, free: Free, loss: Loss, poses: Poses) -> NetworkEquations<'a> {
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

    /// Returns each corner that has a pixel: its sighting, its place in the camera frame (mm), its weight and its derivatives by the poses.
    fn corners(&self) -> impl Iterator<Item = (&Sighting, Point3<f64>, f64, LinearisedCorner)> {
        let seen = |s: &'a Sighting| Some((s, self.poses.camera_tag(s)?));
        let corners = self.net.sightings.iter().filter_map(seen).flat_map(|(s, camera_tag)| {
            let corners = corners_in_tag_mm(self.net.tags[s.tag].size_mm)
                .into_iter()
                .zip(s.corners_px);
            corners.map(move |(corner, px)| (s, camera_tag, corner, px))
        });
        corners.filter_map(|(s, camera_tag, corner, px)| {
            let l = linear(&camera_tag, &corner, &px, &self.net.camera)?;
            let w = s.weight * self.loss.weight(s.weight * l.residual.norm_squared());
            Some((s, camera_tag * corner, w, l))
        })
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
            let Some(l) = linear(&camera_tag, corner, seen, &net.camera) else {
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

    /// Returns the tags' own system once the photos are eliminated; `None` when a photo's pose is open.
    fn reduced(&self, damping: f64) -> Option<Reduced> {
        let damped = |m: &Matrix6<f64>| m + Matrix6::from_diagonal(&(m.diagonal() * damping));
        let n = 6 * self.tags.len();
        let mut matrix = DMatrix::zeros(n, n);
        for (t, block) in self.tags.iter().enumerate() {
            matrix.fixed_view_mut::<6, 6>(6 * t, 6 * t).copy_from(&damped(block));
        }
        let mut inverses = Vec::with_capacity(self.photos.len());
        for (p, block) in self.photos.iter().enumerate() {
            let inverse = Cholesky::new(damped(block))?.inverse();
            for (a, tie_a) in &self.ties[p] {
                let through = tie_a * inverse;
                for (b, tie_b) in &self.ties[p] {
                    let mut view = matrix.fixed_view_mut::<6, 6>(6 * a, 6 * b);
                    view -= through * tie_b.transpose();
                }
            }
            inverses.push(inverse);
        }
        Some((matrix, inverses))
    }

    /// Solves `H x = right`, in the same blocks.
    fn solved<const K: usize>(&self, damping: f64, right: &Blocks<K>) -> Option<Blocks<K>> {
        let (matrix, inverses) = self.reduced(damping)?;
        let mut tags = DMatrix::zeros(6 * self.tags.len(), K);
        for (t, block) in right.tags.iter().enumerate() {
            tags.fixed_view_mut::<6, K>(6 * t, 0).copy_from(block);
        }
        for (p, inverse) in inverses.iter().enumerate() {
            let alone = inverse * right.photos[p];
            for (t, tie) in &self.ties[p] {
                let mut rows = tags.fixed_view_mut::<6, K>(6 * t, 0);
                rows -= tie * alone;
            }
        }
        if !tags.is_empty() {
            tags = Cholesky::new(matrix)?.solve(&tags);
        }
        let tags: Vec<SMatrix<f64, 6, K>> = (0..self.tags.len())
            .map(|t| tags.fixed_view::<6, K>(6 * t, 0).into_owned())
            .collect();
        let photo = |(p, inverse): (usize, &Matrix6<f64>)| {
            let tied: SMatrix<f64, 6, K> = self.ties[p].iter().map(|(t, tie)| tie.transpose() * tags[*t]).sum();
            inverse * (right.photos[p] - tied)
        };
        let photos = inverses.iter().enumerate().map(photo).collect();
        Some(Blocks { tags, photos })
    }

    fn moved(&self, damping: f64) -> Option<Poses> {
        let step = self.solved(
            damping,
            &Blocks {
                tags: self.tag_gradient.iter().map(|g| -g).collect(),
                photos: self.photo_gradient.iter().map(|g| -g).collect(),
            },
        )?;
        let exp = |d: &Vector6<f64>| rigid::from_rotation_vector([d[3], d[4], d[5]], [d[0], d[1], d[2]]);
        let mut moved = self.poses.clone();
        for (pose, slot) in moved.tags.iter_mut().zip(&self.slots.tags) {
            if let (Some(pose), Some(s)) = (pose, slot) {
                *pose *= exp(&step.tags[*s]);
            }
        }
        for (pose, slot) in moved.photos.iter_mut().zip(&self.slots.photos) {
            if let (Some(pose), Some(s)) = (pose, slot) {
                *pose = exp(&step.photos[*s]) * *pose;
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
