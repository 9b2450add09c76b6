//! Proposal of a vehicle's front and top in its mesh file, by its shape alone.
//!
//! Four findings decide, each with a margin below which there is no answer: a vehicle is longest from front to rear; its left side mirrors
//! its right side; it stands on wheels, with air between the axles; its nose is lower than its tail, with the cabin behind the middle. On 19 cars
//! (docs/guide/reference/measured.md) every margin was passed.

use nalgebra::Point3;

use super::triangles::Mesh;
use scaleproof_core::geometry::SignedAxis;

/// Number of points on the surface that are sampled, besides the corners of the triangles.
const SAMPLES: f64 = 60_000.0;
/// Number of cells along the longest side; a mirrored point is compared with those near it.
const CELLS: usize = 48;
/// Least share of the surface that lies at its mirror image: of left and right 0.95 and more, of front and rear up to 0.92, of top and
/// bottom up to 0.83.
const MIRRORED: f64 = 0.9;
/// Least share of the surface by which the sides mirror each other more than top and bottom do.
const MORE_MIRRORED: f64 = 0.08;
/// Least ratio of the longest side to the second longest one.
const LONGER: f64 = 1.15;
/// Number of columns of an outline, from rear to front.
const COLUMNS: usize = 64;
/// Share of the height within which a point is at the ground, or at the roof.
const NEAR: f64 = 0.06;
/// Least difference between the gaps below and above, as a share of the length. Between the axles lie 0.42 to 0.56 of it, between roof and spoiler up
/// to 0.23.
const WIDER_GAP: f64 = 0.12;
/// Without wheels: least difference between the air above and below in the outline's box, as a share of it.
const MORE_AIR: f64 = 0.08;
/// Height by which the first quarter is lower than the last, as a share of the whole: 0.13 to 0.35. Much more is a lorry that carries nothing.
const NOSE_LOWER: std::ops::RangeInclusive<f64> = 0.08..=0.45;
/// Limit for the mean place, from the rear, of all that is higher than three quarters: up to 0.42.
const CABIN: f64 = 0.47;

/// A vehicle's front and top in its mesh file, and the evidence for each, as a clause.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AxesProposal {
    pub front: SignedAxis,
    pub up: SignedAxis,
    pub front_because: &'static str,
    pub up_because: &'static str,
}

/// Reason why the shape does not tell: two answers are equally good, or none is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AxesDoubt {
    #[error("no side is clearly the longest, so its front and its top cannot be told by its shape")]
    NoLength,
    #[error(
        "no side mirrors the other, so its front and its top cannot be told by its shape (a mesh that lies askew is turned in a modeller)"
    )]
    Askew,
    #[error("its sides mirror each other as well as top and bottom do, so its top cannot be told by its shape")]
    NoSides,
    #[error("it stands as well on one side as on the other: its top is {axis} or {}", axis.opposite())]
    Upside { axis: SignedAxis },
    #[error("its nose and its tail cannot be told apart: its front is {axis} or {} (its top is {up})", axis.opposite())]
    Ends { axis: SignedAxis, up: SignedAxis },
}

/// Finds the front and the top in the frame of the mesh's file; those that are `given` are taken.
pub fn propose_axes(mesh: &Mesh, given: [Option<SignedAxis>; 2]) -> Result<AxesProposal, AxesDoubt> {
    let cloud = Cloud::new(mesh);
    let [front, up] = given;
    let length = match front {
        Some(front) => front.index(),
        None => cloud.longest(up)?,
    };
    let height = match up {
        Some(up) => up.index(),
        None => cloud.upright(length)?,
    };
    let upright = SignedAxis::new(height, false);
    let outline = cloud.outline([length, height]);
    let (up, up_because) = match up {
        Some(up) => (up, "as given"),
        None => outline.up(upright).ok_or(AxesDoubt::Upside { axis: upright })?,
    };
    let along = SignedAxis::new(length, false);
    let outline = if up.sign() < 0.0 {
        outline.upside_down()
    } else {
        outline
    };
    let (front, front_because) = match front {
        Some(front) => (front, "as given"),
        None => outline.front(along).ok_or(AxesDoubt::Ends { axis: along, up })?,
    };
    Ok(AxesProposal {
        front,
        up,
        front_because,
        up_because,
    })
}

/// Points all over a mesh, in the frame of its file, in a cube of side 1 around the origin.
struct Cloud {
    points: Vec<Point3<f64>>,
    sides: [f64; 3],
}

impl Cloud {
    fn new(mesh: &Mesh) -> Self {
        let corners: Vec<_> = mesh.points().iter().map(|p| mesh.in_file(p)).collect();
        let area = |i: usize| mesh.normal_mm2(i).norm();
        let whole: f64 = (0..mesh.triangles().len()).map(area).sum();
        let mut points = corners.clone();
        let mut owed = 0.0;
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            owed += SAMPLES * area(i) / whole.max(f64::MIN_POSITIVE);
            let [a, b, c] = triangle.corners.map(|corner| corners[corner]);
            while owed >= 1.0 {
                owed -= 1.0;
                // The R2 sequence (Roberts 2018), folded into the triangle.
                let n = points.len() as f64;
                let [u, v] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3].map(|step| (n * step).fract());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                points.push(a + (b - a) * u + (c - a) * v);
            }
        }
        let start = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
        let (low, high) = corners.iter().fold(start, |(low, high), p| (low.inf(p), high.sup(p)));
        let (middle, longest) = (nalgebra::center(&low, &high), (high - low).max().max(f64::MIN_POSITIVE));
        let inside = |p: &Point3<f64>| Point3::from((p - middle) / longest);
        Self {
            points: points.iter().map(inside).collect(),
            sides: ((high - low) / longest).into(),
        }
    }

    /// Returns the axis from rear to front.
    fn longest(&self, up: Option<SignedAxis>) -> Result<usize, AxesDoubt> {
        let mut axes: Vec<usize> = (0..3).filter(|axis| up.is_none_or(|up| up.index() != *axis)).collect();
        axes.sort_by(|a, b| self.sides[*b].total_cmp(&self.sides[*a]));
        let is_clear = self.sides[axes[0]] >= LONGER * self.sides[axes[1]];
        is_clear.then_some(axes[0]).ok_or(AxesDoubt::NoLength)
    }

    /// Returns the axis from bottom to top: of the two across the length, the one along which the vehicle does not mirror itself.
    fn upright(&self, length: usize) -> Result<usize, AxesDoubt> {
        let [a, b] = [(length + 1) % 3, (length + 2) % 3];
        let [mirrored_a, mirrored_b] = [a, b].map(|axis| self.mirrored(axis));
        if mirrored_a.max(mirrored_b) < MIRRORED {
            return Err(AxesDoubt::Askew);
        }
        if (mirrored_a - mirrored_b).abs() < MORE_MIRRORED {
            return Err(AxesDoubt::NoSides);
        }
        Ok(if mirrored_a > mirrored_b { b } else { a })
    }

    /// Returns the share of the surface that is no more than a cell from its mirror image along an axis.
    fn mirrored(&self, axis: usize) -> f64 {
        // Room for the neighbours of the outermost cells.
        let side = CELLS + 4;
        let cell = |p: &Point3<f64>| [p.x, p.y, p.z].map(|v| ((v + 0.5) * CELLS as f64).floor() as i64 + 2);
        let index = |[x, y, z]: [i64; 3]| (x as usize * side + y as usize) * side + z as usize;
        let mut near = vec![false; side * side * side];
        let reach = || -1..=1;
        for [x, y, z] in self.cells(cell) {
            for (dx, dy, dz) in reach().flat_map(|dx| reach().flat_map(move |dy| reach().map(move |dz| (dx, dy, dz)))) {
                near[index([x + dx, y + dy, z + dz])] = true;
            }
        }
        let mirror = |p: &Point3<f64>| {
            let mut p = *p;
            p[axis] = -p[axis];
            cell(&p)
        };
        let mirrored = self.cells(mirror);
        let met = mirrored.iter().filter(|cell| near[index(**cell)]).count();
        met as f64 / mirrored.len().max(1) as f64
    }

    fn cells(&self, cell: impl Fn(&Point3<f64>) -> [i64; 3]) -> Vec<[i64; 3]> {
        let mut cells: Vec<_> = self.points.iter().map(cell).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    fn outline(&self, [length, height]: [usize; 2]) -> Outline {
        let mut columns = vec![(f64::INFINITY, f64::NEG_INFINITY); COLUMNS];
        let [long, high] = [length, height].map(|axis| self.sides[axis].max(f64::MIN_POSITIVE));
        for p in &self.points {
            let at = ((p[length] / long + 0.5) * COLUMNS as f64) as usize;
            let (lowest, highest) = &mut columns[at.min(COLUMNS - 1)];
            let value = p[height] / high + 0.5;
            (*lowest, *highest) = (lowest.min(value), highest.max(value));
        }
        Outline { columns }
    }
}

/// The lowest and the highest point of each column, from one end of the vehicle to the other, as shares of its height.
struct Outline {
    columns: Vec<(f64, f64)>,
}

impl Outline {
    fn upside_down(self) -> Self {
        let turned = self.columns.into_iter().map(|(low, high)| (1.0 - high, 1.0 - low));
        Self {
            columns: turned.collect(),
        }
    }

    fn filled(&self) -> impl Iterator<Item = (f64, f64)> {
        self.columns.iter().copied().filter(|(low, high)| low <= high)
    }

    /// Returns the direction of up, along the axis or against it, and the evidence.
    fn up(&self, along: SignedAxis) -> Option<(SignedAxis, &'static str)> {
        let [below, above] = [
            gap(&self.columns, |(low, _)| low < NEAR),
            gap(&self.columns, |(_, high)| high > 1.0 - NEAR),
        ];
        let count = self.filled().count() as f64;
        let [under, over] = [
            self.filled().map(|(low, _)| low).sum::<f64>(),
            self.filled().map(|(_, high)| 1.0 - high).sum(),
        ];
        let chosen = |is_along: bool| if is_along { along } else { along.opposite() };
        if (below - above).abs() >= WIDER_GAP {
            Some((chosen(below > above), "it stands on its wheels"))
        } else if ((over - under) / count).abs() >= MORE_AIR {
            Some((chosen(over > under), "it tapers towards its roof"))
        } else {
            None
        }
    }

    /// Returns the direction of the front, along the axis or against it, and the evidence.
    fn front(&self, along: SignedAxis) -> Option<(SignedAxis, &'static str)> {
        let mean = |columns: &[(f64, f64)]| {
            let highs: Vec<f64> = columns
                .iter()
                .filter(|(low, high)| low <= high)
                .map(|(_, high)| *high)
                .collect();
            highs.iter().sum::<f64>() / highs.len().max(1) as f64
        };
        let quarter = COLUMNS / 4;
        let lower = mean(&self.columns[..quarter]) - mean(&self.columns[COLUMNS - quarter..]);
        let high = (0..COLUMNS).filter(|i| self.columns[*i].1 > 0.75);
        let places: Vec<f64> = high.map(|i| (i as f64 + 0.5) / COLUMNS as f64).collect();
        let cabin = places.iter().sum::<f64>() / places.len().max(1) as f64;
        // Place of the cabin from the end that would be the rear.
        let from_rear = if lower > 0.0 { cabin } else { 1.0 - cabin };
        let is_vehicle = NOSE_LOWER.contains(&lower.abs()) && from_rear < CABIN;
        let front = if lower > 0.0 { along } else { along.opposite() };
        is_vehicle.then_some((front, "its nose is lower than its tail"))
    }
}

/// Returns the longest run of columns between two for which something holds, as a share of all.
fn gap(columns: &[(f64, f64)], holds: impl Fn((f64, f64)) -> bool) -> f64 {
    let places: Vec<usize> = (0..columns.len()).filter(|i| holds(columns[*i])).collect();
    let runs = places.windows(2).map(|pair| pair[1] - pair[0] - 1);
    runs.max().unwrap_or(0) as f64 / columns.len() as f64
}
