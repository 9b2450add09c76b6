//! Conversion of rows of components to rows of RGB.

/// Interleaves three rows.
pub(super) fn together([r, g, b]: [&[u8]; 3], to: &mut [[u8; 3]]) {
    for (((to, r), g), b) in to.iter_mut().zip(r).zip(g).zip(b) {
        *to = [*r, *g, *b];
    }
}

scaleproof_core::by_avx2! {
    /// Converts YCbCr to RGB by ITU-T T.871, 7: with 16 fractional bits, each coefficient rounded.
    pub(super) fn from_ycbcr(rows: [&[u8]; 3], to: &mut [[u8; 3]]) {
        let [y, cb, cr] = rows;
        for (((to, y), cb), cr) in to.iter_mut().zip(y).zip(cb).zip(cr) {
            *to = rgb(*y, *cb, *cr);
        }
    }
}

#[inline(always)]
fn rgb(y: u8, cb: u8, cr: u8) -> [u8; 3] {
    const HALF: i32 = 1 << 15;
    let (y, cb, cr) = (i32::from(y), i32::from(cb) - 128, i32::from(cr) - 128);
    [
        y + ((91_881 * cr + HALF) >> 16),
        y + ((-22_554 * cb - 46_802 * cr + HALF) >> 16),
        y + ((116_130 * cb + HALF) >> 16),
    ]
    .map(|v| v.clamp(0, 255) as u8)
}

/// Converts inverted CMYK, as Adobe's programs store it: each ink is scaled by black.
pub(super) fn from_cmyk(inks: [&[u8]; 3], black: &[u8], to: &mut [[u8; 3]]) {
    together(inks, to);
    darken(black, to);
}

/// Converts inverted CMYK as [`from_cmyk`], with the three inks stored as the YCbCr of 255 − their values.
pub(super) fn from_ycck(inks: [&[u8]; 3], black: &[u8], to: &mut [[u8; 3]]) {
    from_ycbcr(inks, to);
    to.iter_mut().for_each(|inks| *inks = inks.map(|v| 255 - v));
    darken(black, to);
}

fn darken(black: &[u8], to: &mut [[u8; 3]]) {
    for (to, black) in to.iter_mut().zip(black) {
        *to = to.map(|v| ((u16::from(v) * u16::from(*black) + 127) / 255) as u8);
    }
}
