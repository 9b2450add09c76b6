//! Levenberg–Marquardt.

use nalgebra::{Matrix2, Vector2};
use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};

/// Rosenbrock's valley as residuals 10 (y − x²) and 1 − x.
struct Valley(Vector2<f64>);

impl Valley {
    fn residuals(&self) -> Vector2<f64> {
        Vector2::new(10.0 * (self.0.y - self.0.x * self.0.x), 1.0 - self.0.x)
    }
}

impl LeastSquares for Valley {
    fn cost(&self) -> f64 {
        self.residuals().norm_squared()
    }

    fn stepped(&self, damping: f64) -> Option<Valley> {
        let jacobian = Matrix2::new(-20.0 * self.0.x, 10.0, -1.0, 0.0);
        let mut normal = jacobian.transpose() * jacobian;
        normal.set_diagonal(&(normal.diagonal() * (1.0 + damping)));
        let step = normal.cholesky()?.solve(&(jacobian.transpose() * self.residuals()));
        Some(Valley(self.0 - step))
    }
}

#[test]
fn a_curved_valley_is_followed_to_its_end() {
    let limits = Limits {
        first_damping: 1e-3,
        most_trials: 100,
        relative_gain: 0.0,
        absolute_gain: 1e-24,
    };
    let end = minimise(Valley(Vector2::new(-1.2, 1.0)), &limits);
    assert!((end.0 - Vector2::new(1.0, 1.0)).norm() < 1e-9, "{}", end.0);
    let few = minimise(
        Valley(Vector2::new(-1.2, 1.0)),
        &Limits {
            most_trials: 3,
            ..limits
        },
    );
    assert!(few.cost() > end.cost());
}
