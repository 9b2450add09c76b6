//! Where the ground mat is cut along one axis, so that no seam runs through a tag.

/// More than this between a seam and a tag is no better.
const CLEAR_MM: f64 = 10.0;
/// A sheet that shows less than this of the mat is a sliver.
const SLIVER_MM: f64 = 10.0;
/// How finely seams are moved, and at how many places at most.
const STEP_MM: f64 = 0.5;
const PLACES: f64 = 400.0;
/// What a tag cut in two weighs against clearance, and clearance against an even grid.
const TAG_WEIGHT: f64 = 1e7;
const CLEAR_WEIGHT: f64 = 1e3;

/// One axis of the mat: what must be on it, and what a sheet has room for. Millimetres; the overlap is on a sheet's far side.
#[derive(Debug, Clone)]
pub struct SeamAxis {
    pub low_mm: f64,
    pub high_mm: f64,
    /// Of one sheet.
    pub usable_mm: f64,
    pub overlap_mm: f64,
    /// From where to where no seam should run.
    pub keep: Vec<(f64, f64)>,
}

impl SeamAxis {
    /// The edges of the fewest sheets, the two outer ones among them, in rising order. Outer sheets reach as far as their paper does.
    /// Of all places for the seams the ones that cut the fewest spans are taken, then those with most clearance, then the most
    /// even ones.
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

    /// From a seam to the next, at most.
    fn step(&self) -> f64 {
        self.usable_mm - self.overlap_mm
    }

    /// The cheapest seams: for every place of a seam, the cheapest way there from a place of the seam before.
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

    /// Where the seam after sheet `i` (from 1) may be; the even grid is always among the places, so there is one.
    fn places(&self, i: usize, sheets: usize) -> Vec<f64> {
        let low = self.high_mm - self.usable_mm - (sheets - 1 - i) as f64 * self.step();
        let low = low.max(self.low_mm + SLIVER_MM);
        let high = (self.low_mm + i as f64 * self.step()).min(self.high_mm - SLIVER_MM);
        let step = STEP_MM.max((high - low) / PLACES);
        let count = ((high - low) / step).max(0.0) as usize;
        let steps = (0..=count).map(|k| low + k as f64 * step).filter(|at| *at <= high);
        [self.even(i, sheets)].into_iter().chain(steps).collect()
    }

    /// The seam after sheet `i` if all sheets were used to their ends, the mat in their middle.
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

/// From a seam to the nearest span; 0 within one.
fn clearance(seam: f64, keep: &[(f64, f64)]) -> f64 {
    let from = |(low, high): &(f64, f64)| (low - seam).max(seam - high).max(0.0);
    keep.iter().map(from).fold(f64::INFINITY, f64::min)
}
