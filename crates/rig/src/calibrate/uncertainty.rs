//! Uncertainty of a projection, cell by cell of the image.

use nalgebra::{DMatrix, Matrix2, Matrix2x3, Matrix2xX, Point3};

use super::fit::CameraFit;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::camera::projection::{by_step, project_unchecked};

/// Cells of the map across the longer side of the image.
const CELLS: u32 = 16;

#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct MapCell {
    /// Its middle, px.
    pub px: [f64; 2],
    /// Standard deviation of the projection in its worst direction, px; `None` where the lens model folds back on itself.
    pub sigma_px: Option<f64>,
}

/// The map and its columns and rows.
#[derive(Debug, Clone)]
pub struct UncertaintyMap {
    pub columns: u32,
    pub rows: u32,
    /// Cells, row by row.
    pub cells: Vec<MapCell>,
}

/// Computes the standard deviation of the projection of a far point, given the covariance of the camera's parameters.
///
/// A camera that is a little wrong and turned a little projects almost as before, and whoever finds a pose finds that turn as well.
/// So the turn that best undoes a change over the whole image is taken out first, as in mrcal's "projection uncertainty"
/// (implied rotation): with J the derivatives by camera, R those by a turn, M = J − R (ΣRᵀR)⁻¹ ΣRᵀJ, and Var = M Σ Mᵀ.
pub(super) fn map(fit: &CameraFit, covariance: &DMatrix<f64>, (width, height): (u32, u32)) -> UncertaintyMap {
    let (w, h) = (f64::from(width), f64::from(height));
    let side = w.max(h) / f64::from(CELLS);
    let count = |length: f64| ((length / side).round() as u32).max(1);
    let (columns, rows) = (count(w), count(h));
    let at = |n: u32, of: u32, length: f64| (f64::from(n) + 0.5) * length / f64::from(of) - 0.5;
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let middle = |(column, row)| [at(column, columns, w), at(row, rows, h)];
    let middles: Vec<[f64; 2]> = places.map(middle).collect();
    let camera = Camera::from_parameters((width, height), &fit.camera);
    let derivatives: Vec<_> = middles.iter().map(|px| Derivatives::at(fit, &camera, *px)).collect();
    let turn = implied_turn(derivatives.iter().flatten(), covariance.nrows());
    let cells = middles.into_iter().zip(&derivatives).map(|(px, d)| MapCell {
        px,
        sigma_px: d
            .as_ref()
            .zip(turn.as_ref())
            .map(|(d, turn)| d.sigma_px(turn, covariance)),
    });
    UncertaintyMap {
        columns,
        rows,
        cells: cells.collect(),
    }
}

/// Derivatives of one pixel: by the parameters of the model (2 × p) and by a turn of the camera (2 × 3).
struct Derivatives {
    by_camera: Matrix2xX<f64>,
    by_turn: Matrix2x3<f64>,
}

impl Derivatives {
    fn at(fit: &CameraFit, camera: &Camera, px: [f64; 2]) -> Option<Derivatives> {
        let [x, y] = camera.point_at(px)?;
        let direction = Point3::new(x, y, 1.0);
        let at = project_unchecked(&fit.camera, &direction);
        Some(Derivatives {
            by_camera: at.by_camera * fit.model.parameters_to_numbers(),
            by_turn: by_step(&at.by_point, &direction).fixed_columns::<3>(0).into_owned(),
        })
    }

    fn sigma_px(&self, turn: &DMatrix<f64>, covariance: &DMatrix<f64>) -> f64 {
        let m = &self.by_camera - self.by_turn * turn;
        let v: Matrix2<f64> = &m * covariance * m.transpose();
        v.symmetric_eigenvalues().max().max(0.0).sqrt()
    }
}

/// Returns the turn (3 × p) that best undoes each parameter's change over the image.
fn implied_turn<'a>(all: impl Iterator<Item = &'a Derivatives>, parameters: usize) -> Option<DMatrix<f64>> {
    let (mut h, mut g) = (DMatrix::zeros(3, 3), DMatrix::zeros(3, parameters));
    for d in all {
        h += d.by_turn.transpose() * d.by_turn;
        g += d.by_turn.transpose() * &d.by_camera;
    }
    Some(h.cholesky()?.solve(&g))
}
