//! Enlarging differences of colour by two: a pixel takes three quarters of the sample that it lies in and one of the next one.
//!
//! The centre of a pixel lies a quarter of a sample off the sample's own. Halves are rounded up in each direction, as the reader rounded them that
//! the stored recordings were made with; libjpeg rounds by turns, which leaves 0.03 to 0.05 of 255 between the means.

/// Twice as wide.
pub(super) fn across(from: &[u8], to: &mut [u8]) {
    let last = from.len() - 1;
    to[0] = from[0];
    to[2 * last + 1] = from[last];
    for (to, pair) in to[1..].chunks_exact_mut(2).zip(from.windows(2)) {
        let [a, b] = [pair[0], pair[1]].map(u16::from);
        to[0] = ((3 * a + b + 2) >> 2) as u8;
        to[1] = ((3 * b + a + 2) >> 2) as u8;
    }
}

/// Twice as high: the row that lies in the near one, on the side of the far one.
pub(super) fn down([near, far]: [&[u8]; 2], to: &mut [u8]) {
    for ((to, near), far) in to.iter_mut().zip(near).zip(far) {
        *to = ((3 * u16::from(*near) + u16::from(*far) + 2) >> 2) as u8;
    }
}

/// Each sample so many times.
pub(super) fn repeated(from: &[u8], times: usize, to: &mut [u8]) {
    for (to, from) in to.chunks_exact_mut(times).zip(from) {
        to.fill(*from);
    }
}
