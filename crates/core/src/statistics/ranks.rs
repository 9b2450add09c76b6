//! Agreement of two orders.

/// Kendall's τ-b of two lists of figures (Kendall 1945): 1 where they order everything alike, −1 where the one is the other upside down. Figures that differ by less than `alike` are ties;
/// none where one list has nothing but ties, since it orders nothing.
pub fn kendall_tau_b(a: &[f64], b: &[f64], alike: f64) -> Option<f64> {
    let sign = |difference: f64| match difference {
        d if d > alike => 1.0,
        d if d < -alike => -1.0,
        _ => 0.0,
    };
    let (mut agreeing, mut ordered_a, mut ordered_b) = (0.0, 0.0, 0.0);
    for i in 0..a.len() {
        for j in 0..i {
            let (of_a, of_b): (f64, f64) = (sign(a[i] - a[j]), sign(b[i] - b[j]));
            agreeing += of_a * of_b;
            ordered_a += of_a.abs();
            ordered_b += of_b.abs();
        }
    }
    let both = ordered_a * ordered_b;
    (both > 0.0).then(|| agreeing / f64::sqrt(both))
}
