//! Adam (Kingma & Ba, ICLR 2015, algorithm 1).

use crate::layers::Number;

const BETA: [f64; 2] = [0.9, 0.999];

/// The settings of the optimiser, which moves numbers against their gradient.
#[derive(Debug, Clone, Copy)]
pub struct Adam {
    pub learning_rate: f64,
    /// Added to the root of the second moment, without its bias.
    pub epsilon: f64,
}

impl Adam {
    /// Step number `step`, the first being 1; the moments are 0 before it.
    pub fn step<N: Number>(self, step: i32, numbers: &mut [N], gradient: &[N], [first, second]: [&mut [N]; 2]) {
        let unbias = BETA.map(|beta| 1.0 - beta.powi(step));
        let moments = first.iter_mut().zip(second);
        for ((x, g), (first, second)) in numbers.iter_mut().zip(gradient).zip(moments) {
            let g = g.wide();
            let m = BETA[0] * first.wide() + (1.0 - BETA[0]) * g;
            let v = BETA[1] * second.wide() + (1.0 - BETA[1]) * g * g;
            let by = self.learning_rate * (m / unbias[0]) / ((v / unbias[1]).sqrt() + self.epsilon);
            (*first, *second, *x) = (N::of(m), N::of(v), N::of(x.wide() - by));
        }
    }
}
