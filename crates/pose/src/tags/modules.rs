//! Black and white modules of a tag or marker.

/// Square modules, row by row from the top left of the upright tag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Modules {
    side: usize,
    black: Vec<bool>,
}

impl Modules {
    /// Creates `side` × `side` modules; `is_black` is called for each (row, column).
    pub fn new(side: usize, mut is_black: impl FnMut(usize, usize) -> bool) -> Self {
        let places = (0..side).flat_map(|row| (0..side).map(move |column| (row, column)));
        let black = places.map(|(row, column)| is_black(row, column)).collect();
        Self { side, black }
    }

    pub fn side(&self) -> usize {
        self.side
    }

    /// Returns true if a module is black; outside the square everything is white.
    pub fn is_black(&self, row: usize, column: usize) -> bool {
        row < self.side && column < self.side && self.black[row * self.side + column]
    }

    /// Returns the square with a frame of `width` more modules around it, all black or all white.
    pub fn framed(&self, width: usize, black: bool) -> Self {
        let inside = width..width + self.side;
        Self::new(self.side + 2 * width, |row, column| {
            if inside.contains(&row) && inside.contains(&column) {
                self.is_black(row - width, column - width)
            } else {
                black
            }
        })
    }

    /// Returns the square without its outer `width` modules.
    pub fn cropped(&self, width: usize) -> Self {
        let side = self.side.saturating_sub(2 * width);
        Self::new(side, |row, column| self.is_black(row + width, column + width))
    }
}
