//! A tag's outline as a map from the unit square.

/// The projective map of the unit square onto four pixels (Heckbert 1989, "Fundamentals of Texture Mapping", 2.2.3).
pub(super) struct TagHomography {
    a: f64,
    b: f64,
    d: f64,
    e: f64,
    g: f64,
    h: f64,
    origin: [f64; 2],
}

impl TagHomography {
    /// (0, 0), (1, 0), (1, 1), (0, 1) land on the corners in their order.
    pub(super) fn to([p0, p1, p2, p3]: &[[f64; 2]; 4]) -> TagHomography {
        let sum = |i: usize| p0[i] - p1[i] + p2[i] - p3[i];
        let [dx1, dy1] = [p1[0] - p2[0], p1[1] - p2[1]];
        let [dx2, dy2] = [p3[0] - p2[0], p3[1] - p2[1]];
        let determinant = dx1 * dy2 - dx2 * dy1;
        let g = (sum(0) * dy2 - dx2 * sum(1)) / determinant;
        let h = (dx1 * sum(1) - sum(0) * dy1) / determinant;
        TagHomography {
            a: p1[0] - p0[0] + g * p1[0],
            b: p3[0] - p0[0] + h * p3[0],
            d: p1[1] - p0[1] + g * p1[1],
            e: p3[1] - p0[1] + h * p3[1],
            g,
            h,
            origin: *p0,
        }
    }

    /// The pixel of a point of the unit square.
    pub(super) fn pixel(&self, u: f64, v: f64) -> [f64; 2] {
        let w = self.g * u + self.h * v + 1.0;
        [
            (self.a * u + self.b * v + self.origin[0]) / w,
            (self.d * u + self.e * v + self.origin[1]) / w,
        ]
    }

    /// The pixel at a share of a side, from its first corner on, and a share of the way across to the opposite side.
    pub(super) fn pixel_at(&self, side: usize, along: f64, depth: f64) -> [f64; 2] {
        match side {
            0 => self.pixel(along, depth),
            1 => self.pixel(1.0 - depth, along),
            2 => self.pixel(1.0 - along, 1.0 - depth),
            _ => self.pixel(depth, 1.0 - along),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_hits_its_corners() {
        let corners = [[10.0, 12.0], [50.0, 9.0], [61.0, 44.0], [4.0, 70.0]];
        let homography = TagHomography::to(&corners);
        for (corner, (u, v)) in corners.iter().zip([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]) {
            let [x, y] = homography.pixel(u, v);
            assert!((x - corner[0]).abs() < 1e-9 && (y - corner[1]).abs() < 1e-9);
        }
    }
}
