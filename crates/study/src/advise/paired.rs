//! Two ways on the same photos: their held-out errors, and the distance between their viewpoints.

use super::held_out::MethodResult;
use scaleproof_core::statistics::{FEWEST_CLUSTERS, Interval, intervals_95, upper_median};
use scaleproof_pose::locate::Located;

/// Share of the smallest held-out error by which another may be larger.
pub(super) const MARGIN: f64 = 0.05;

/// Least number of photos in which two ways must predict a tag before any is judged.
pub(super) const FEWEST_PHOTOS: usize = FEWEST_CLUSTERS;

/// Held-out errors of two ways, where both have one, degrees.
pub(super) struct PairedErrors(Vec<[f64; 2]>);

impl PairedErrors {
    pub(super) fn new<'a>(pairs: impl Iterator<Item = (&'a MethodResult, &'a MethodResult)>) -> PairedErrors {
        let both = pairs.filter_map(|(a, b)| Some([a.held_out_deg?, b.held_out_deg?]));
        PairedErrors(both.collect())
    }

    pub(super) fn photos(&self) -> usize {
        self.0.len()
    }

    /// Returns both means, degrees; NaN without a photo.
    pub(super) fn means(&self) -> [f64; 2] {
        self.weighted(&vec![1; self.photos()])
    }

    /// Returns the 95 % interval of the first mean minus the second, over resamples of the photos.
    pub(super) fn difference_95(&self) -> Option<Interval> {
        let [interval] = intervals_95(self.photos(), |times| {
            let [a, b] = self.weighted(times);
            [a - b]
        });
        interval
    }

    fn weighted(&self, times: &[u32]) -> [f64; 2] {
        let total: f64 = times.iter().map(|t| f64::from(*t)).sum();
        let sum = |i: usize| -> f64 { self.0.iter().zip(times).map(|(pair, t)| f64::from(*t) * pair[i]).sum() };
        [sum(0) / total, sum(1) / total]
    }
}

/// Difference between the viewpoints of two ways, in the middle photo of those that both locate.
pub(super) struct PoseShift {
    pub deg: Option<f64>,
    pub mm: Option<f64>,
    /// Photos whose direction differs by more than [`MOST_SIGMAS`] standard deviations of the second pose.
    pub beyond_doubt: usize,
    /// Share by which the directions are less certain, where the first pose rests on part of what the second rests on: the change of an efficient
    /// estimate when data are left out is uncorrelated with its own error (J. A. Hausman, Specification Tests in Econometrics, Econometrica 46,
    /// 1978), so the squares add up.
    pub less_certain_by: Option<f64>,
}

/// Number of standard deviations beyond which a moved direction is another pose, or a far less certain one.
const MOST_SIGMAS: f64 = 5.0;

impl PoseShift {
    pub(super) fn between<'a>(pairs: impl Iterator<Item = (&'a MethodResult, &'a MethodResult)>) -> PoseShift {
        let (mut deg, mut mm, mut beyond_doubt, mut variance) = (Vec::new(), Vec::new(), 0, 0.0);
        for (a, b) in pairs.filter_map(|(a, b)| a.located.as_ref().zip(b.located.as_ref())) {
            let moved = direction_deg(a, b);
            let sigma = sigma_deg(b);
            beyond_doubt += usize::from(moved > MOST_SIGMAS * sigma);
            variance += sigma * sigma;
            deg.push(moved);
            mm.push((a.viewpoint.distance_mm - b.viewpoint.distance_mm).abs());
        }
        PoseShift {
            deg: upper_median(&deg),
            mm: upper_median(&mm),
            beyond_doubt,
            less_certain_by: (variance > 0.0).then(|| {
                let added: f64 = deg.iter().map(|moved| moved * moved).sum();
                (1.0 + added / variance).sqrt() - 1.0
            }),
        }
    }
}

/// Returns the angle between the directions of two viewpoints, degrees.
fn direction_deg(a: &Located, b: &Located) -> f64 {
    let direction = |located: &Located| {
        let seen = located.viewpoint;
        let (azimuth, pitch) = (seen.azimuth_deg.to_radians(), seen.pitch_deg.to_radians());
        nalgebra::Vector3::new(azimuth.cos() * pitch.cos(), azimuth.sin() * pitch.cos(), pitch.sin())
    };
    direction(a).angle(&direction(b)).to_degrees()
}

fn sigma_deg(located: &Located) -> f64 {
    let sigma = located.sigma;
    (sigma.azimuth_deg * located.viewpoint.pitch_deg.to_radians().cos()).hypot(sigma.pitch_deg)
}
