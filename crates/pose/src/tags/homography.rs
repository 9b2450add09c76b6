//! Homography from the unit square to a tag's outline.

/// Homography of the unit square onto four pixels (Heckbert 1989, "Fundamentals of Texture Mapping", 2.2.3).
pub struct TagHomography {
    /// Rows of the matrix: those of x, y and the denominator.
    rows: [[f64; 3]; 3],
}

impl TagHomography {
    /// Returns the homography that maps (0, 0), (1, 0), (1, 1), (0, 1) to the corners in their order.
    pub fn to([p0, p1, p2, p3]: &[[f64; 2]; 4]) -> TagHomography {
        let sum = |i: usize| p0[i] - p1[i] + p2[i] - p3[i];
        let [dx1, dy1] = [p1[0] - p2[0], p1[1] - p2[1]];
        let [dx2, dy2] = [p3[0] - p2[0], p3[1] - p2[1]];
        let determinant = dx1 * dy2 - dx2 * dy1;
        let g = (sum(0) * dy2 - dx2 * sum(1)) / determinant;
        let h = (dx1 * sum(1) - sum(0) * dy1) / determinant;
        let row = |i: usize| [p1[i] - p0[i] + g * p1[i], p3[i] - p0[i] + h * p3[i], p0[i]];
        TagHomography {
            rows: [row(0), row(1), [g, h, 1.0]],
        }
    }

    /// Returns the pixel of a point of the unit square.
    pub fn pixel(&self, u: f64, v: f64) -> [f64; 2] {
        let [x, y, w] = self.rows.map(|[a, b, c]| a * u + b * v + c);
        [x / w, y / w]
    }

    /// Returns the pixel at a share of a side's length, from its first corner on, and at a share of the distance to the opposite side.
    pub fn pixel_at(&self, side: usize, along: f64, depth: f64) -> [f64; 2] {
        match side {
            0 => self.pixel(along, depth),
            1 => self.pixel(1.0 - depth, along),
            2 => self.pixel(1.0 - along, 1.0 - depth),
            _ => self.pixel(depth, 1.0 - along),
        }
    }
}
