//! Chroma upsampling by two: a pixel is three quarters of the sample that contains it plus one quarter of the adjacent one.
//!
//! This is libjpeg's "fancy" upsampling: the centre of a pixel is a quarter of a sample off the sample's own. Halves are rounded up and down
//! alternately, so that the mean is unbiased.

/// Doubles the width.
pub(super) fn across(from: &[u8], to: &mut [u8]) {
    let last = from.len() - 1;
    to[0] = from[0];
    to[2 * last + 1] = from[last];
    for (to, pair) in to[1..].chunks_exact_mut(2).zip(from.windows(2)) {
        let [a, b] = [pair[0], pair[1]].map(u16::from);
        to[0] = ((3 * a + b + 2) >> 2) as u8;
        to[1] = ((3 * b + a + 1) >> 2) as u8;
    }
}

/// Doubles the height: returns the upper or the lower of the two rows inside the near one.
pub(super) fn down([near, far]: [&[u8]; 2], is_upper: bool, to: &mut [u8]) {
    let half = if is_upper { 1 } else { 2 };
    for ((to, near), far) in to.iter_mut().zip(near).zip(far) {
        *to = ((3 * u16::from(*near) + u16::from(*far) + half) >> 2) as u8;
    }
}

/// Doubles width and height.
pub(super) fn both([near, far]: [&[u8]; 2], sums: &mut Vec<u16>, to: &mut [u8]) {
    sums.clear();
    sums.extend(
        near.iter()
            .zip(far)
            .map(|(near, far)| 3 * u16::from(*near) + u16::from(*far)),
    );
    let last = sums.len() - 1;
    to[0] = ((4 * sums[0] + 8) >> 4) as u8;
    to[2 * last + 1] = ((4 * sums[last] + 7) >> 4) as u8;
    for (to, pair) in to[1..].chunks_exact_mut(2).zip(sums.windows(2)) {
        to[0] = ((3 * pair[0] + pair[1] + 7) >> 4) as u8;
        to[1] = ((3 * pair[1] + pair[0] + 8) >> 4) as u8;
    }
}

/// Repeats each sample `times` times.
pub(super) fn repeated(from: &[u8], times: usize, to: &mut [u8]) {
    for (to, from) in to.chunks_exact_mut(times).zip(from) {
        to.fill(*from);
    }
}
