//! Seams of the ground mat along one axis, placed so that they do not cut tags.

/// Clearance between a seam and a tag above which more is no improvement.
const CLEAR_MM: f64 = 10.0;
/// Minimum part of the mat on a sheet; less is a sliver.
const SLIVER_MM: f64 = 10.0;
/// Step between candidate positions of a seam, and their maximum number.
const STEP_MM: f64 = 0.5;
const PLACES: f64 = 400.0;
/// Cost weight of a cut tag relative to clearance, and of clearance relative to an even grid.
const TAG_WEIGHT: f64 = 1e7;
const CLEAR_WEIGHT: f64 = 1e3;

/// Axis of the mat: its content, and the size of a sheet. Millimetres; the overlap is on a sheet's far side.
#[derive(Debug, Clone)]
pub struct SeamAxis {
    pub low_mm: f64,
    pub high_mm: f64,
    /// Usable length of one sheet.
    pub usable_mm: f64,
    pub overlap_mm: f64,
    /// Intervals that no seam should cross.
    pub keep: Vec<(f64, f64)>,
}

impl SeamAxis {
    /// Returns the edges of the fewest sheets, the two outer ones included, ascending. Outer sheets reach as far as their paper does. The seams
    /// chosen cut the fewest intervals of `keep`; of those they have the most clearance, then the most even spacing.
    pub fn edges(&self) -> Vec<f64> {
        let sheets = self.sheets();
        if sheets == 1 {
            let spare = (self.usable_mm - (self.high_mm - self.low_mm)) / 2.0;
            return vec![self.low_mm - spare, self.high_mm + spare];
        }
        let seams = self.seams(sheets);
        let first = seams.first().map_or(self.low_mm, |seam| seam - self.step());
        let last = seams.last().map_or(self.high_mm, |seam| seam + self.usable_mm);
        [first].into_iter().chain(seams).chain([last]).collect()
    }

    pub fn sheets(&self) -> usize {
        let exact = (self.high_mm - self.low_mm - self.overlap_mm) / self.step();
        (exact - 1e-6 / self.usable_mm).ceil().max(1.0) as usize
    }

    /// Returns the maximum distance between neighbouring seams.
    fn step(&self) -> f64 {
        self.usable_mm - self.overlap_mm
    }

    /// Returns the cheapest seams, by dynamic programming: for every position of a seam, the cheapest predecessor among the positions of the seam
    /// before.
    fn seams(&self, sheets: usize) -> Vec<f64> {
        let places: Vec<Vec<f64>> = (1..sheets).map(|i| self.places(i, sheets)).collect();
        let mut ways: Vec<Vec<(f64, usize)>> = Vec::new();
        for (i, here) in places.iter().enumerate() {
            let cost = |at: f64| self.cost(at, self.even(i + 1, sheets));
            let way = |at: &f64| {
                let Some(before) = i.checked_sub(1) else {
                    return (cost(*at), 0);
                };
                let from = places[before].iter().zip(&ways[before]).enumerate();
                let reached = from.filter(|(_, (place, _))| (SLIVER_MM..=self.step() + 1e-6).contains(&(at - *place)));
                let best = reached.min_by(|a, b| a.1.1.0.total_cmp(&b.1.1.0));
                best.map_or((f64::INFINITY, 0), |(j, (_, (so_far, _)))| (so_far + cost(*at), j))
            };
            let here = here.iter().map(way).collect();
            ways.push(here);
        }
        let cheapest = |way: &Vec<(f64, usize)>| (0..way.len()).min_by(|a, b| way[*a].0.total_cmp(&way[*b].0));
        let mut at = ways.last().and_then(cheapest).unwrap_or(0);
        let mut seams = Vec::new();
        for (here, way) in places.iter().zip(&ways).rev() {
            seams.push(here[at]);
            at = way[at].1;
        }
        seams.reverse();
        seams
    }

    /// Returns the candidate positions of the seam after sheet `i` (from 1); the even grid's is always among them, so there is one.
    fn places(&self, i: usize, sheets: usize) -> Vec<f64> {
        let low = self.high_mm - self.usable_mm - (sheets - 1 - i) as f64 * self.step();
        let low = low.max(self.low_mm + SLIVER_MM);
        let high = (self.low_mm + i as f64 * self.step()).min(self.high_mm - SLIVER_MM);
        let step = STEP_MM.max((high - low) / PLACES);
        let count = ((high - low) / step).max(0.0) as usize;
        let steps = (0..=count).map(|k| low + k as f64 * step).filter(|at| *at <= high);
        [self.even(i, sheets)].into_iter().chain(steps).collect()
    }

    /// Returns the seam after sheet `i` if all sheets were used to their ends, with the mat in their middle.
    fn even(&self, i: usize, sheets: usize) -> f64 {
        let whole = sheets as f64 * self.step() + self.overlap_mm;
        (self.low_mm + self.high_mm - whole) / 2.0 + i as f64 * self.step()
    }

    fn cost(&self, seam: f64, even: f64) -> f64 {
        let is_cut = |(low, high): &&(f64, f64)| seam > *low && seam < *high;
        let cut = self.keep.iter().filter(is_cut).count();
        let clear = clearance(seam, &self.keep).min(CLEAR_MM);
        TAG_WEIGHT * cut as f64 + CLEAR_WEIGHT * (CLEAR_MM - clear) + (seam - even).abs()
    }
}

/// Returns the distance from a seam to the nearest interval; 0 within one.
fn clearance(seam: f64, keep: &[(f64, f64)]) -> f64 {
    let from = |(low, high): &(f64, f64)| (low - seam).max(seam - high).max(0.0);
    keep.iter().map(from).fold(f64::INFINITY, f64::min)
}
