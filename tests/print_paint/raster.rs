//! What a stencil is, measured on an image of it: pieces, holes, widths, areas. Nothing here knows how it was made.

/// An image of a stencil: where it is cut open. Everything else is material.
pub struct Stencil {
    pub width: usize,
    pub height: usize,
    pub open: Vec<bool>,
    pub mm_per_px: f64,
}

impl Stencil {
    pub fn open_mm2(&self) -> f64 {
        self.open.iter().filter(|o| **o).count() as f64 * self.mm_per_px.powi(2)
    }

    /// One piece of material, nowhere narrower than `least_mm`, with openings nowhere too small for it.
    pub fn assert_sound(&self, least_mm: f64, what: &str) {
        let material: Vec<bool> = self.open.iter().map(|o| !o).collect();
        assert_eq!(self.pieces(&material, false), 1, "{what}: floating islands");
        // Two pixels less than the width: what is drawn between pixels.
        let reach = 0.5 * least_mm / self.mm_per_px - 1.0;
        let deep = self.distances(&material);
        let core: Vec<bool> = deep.iter().map(|d| *d > reach).collect();
        // A narrow neck is cut through by this: the material falls apart, or two openings become one.
        assert_eq!(
            self.pieces(&core, false),
            1,
            "{what}: a bridge is narrower than {least_mm} mm"
        );
        let holes = |solid: &[bool]| self.pieces(&solid.iter().map(|s| !s).collect::<Vec<_>>(), true);
        // Beyond the image all is open, so the core has one opening more: its border.
        assert_eq!(
            holes(&core),
            holes(&material) + 1,
            "{what}: a neck is narrower than {least_mm} mm"
        );
        // A corner is farther from the core than a side.
        let bare: Vec<bool> = core.iter().map(|c| !c).collect();
        let from_core = self.distances(&bare);
        let thin = (0..material.len()).find(|i| material[*i] && from_core[*i] > 1.5 * reach + 3.0);
        assert_eq!(thin, None, "{what}: material thinner than {least_mm} mm");
        let mut deepest = vec![0.0f64; 1];
        let of = self.labelled(&self.open, true, &mut deepest);
        for (label, deep) in of.iter().zip(self.distances(&self.open)) {
            deepest[*label] = deepest[*label].max(deep);
        }
        let small = deepest[1..].iter().position(|deep| *deep < reach);
        assert_eq!(small, None, "{what}: an opening is narrower than {least_mm} mm");
    }

    pub fn pieces(&self, of: &[bool], corners_join: bool) -> usize {
        let mut sizes = vec![0.0];
        self.labelled(of, corners_join, &mut sizes);
        sizes.len() - 1
    }

    /// The piece of each pixel, from 1; 0 where there is none. `slots` grows by one for each.
    pub fn labelled(&self, of: &[bool], corners_join: bool, slots: &mut Vec<f64>) -> Vec<usize> {
        let mut label = vec![0; of.len()];
        for start in 0..of.len() {
            if !of[start] || label[start] != 0 {
                continue;
            }
            slots.push(0.0);
            let mine = slots.len() - 1;
            label[start] = mine;
            let mut waiting = vec![start];
            while let Some(i) = waiting.pop() {
                let (x, y) = ((i % self.width) as isize, (i / self.width) as isize);
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                    let (nx, ny) = (x + dx, y + dy);
                    let inside = nx >= 0 && ny >= 0 && nx < self.width as isize && ny < self.height as isize;
                    if !inside || (dx != 0 && dy != 0 && !corners_join) {
                        continue;
                    }
                    let n = ny as usize * self.width + nx as usize;
                    if of[n] && label[n] == 0 {
                        label[n] = mine;
                        waiting.push(n);
                    }
                }
            }
        }
        label
    }

    /// How far each pixel's centre is from the nearest centre that does not belong, in pixels; beyond the image nothing does.
    /// Felzenszwalb & Huttenlocher 2012.
    fn distances(&self, of: &[bool]) -> Vec<f64> {
        let (wide, high) = (self.width + 2, self.height + 2);
        let mut grid = vec![0.0f64; wide * high];
        for y in 0..self.height {
            for x in 0..self.width {
                if of[y * self.width + x] {
                    grid[(y + 1) * wide + x + 1] = 1e12;
                }
            }
        }
        for x in 0..wide {
            let column: Vec<f64> = (0..high).map(|y| grid[y * wide + x]).collect();
            for (y, d) in lower_envelope(&column).into_iter().enumerate() {
                grid[y * wide + x] = d;
            }
        }
        for row in grid.chunks_mut(wide) {
            let done = lower_envelope(row);
            row.copy_from_slice(&done);
        }
        let inner = (1..=self.height).flat_map(|y| (1..=self.width).map(move |x| (x, y)));
        inner.map(|(x, y)| grid[y * wide + x].sqrt()).collect()
    }
}

fn lower_envelope(f: &[f64]) -> Vec<f64> {
    let (mut at, mut from) = (vec![0usize], vec![f64::NEG_INFINITY]);
    let square = |i: usize| (i * i) as f64;
    for q in 1..f.len() {
        loop {
            let p = at[at.len() - 1];
            let s = ((f[q] + square(q)) - (f[p] + square(p))) / (2.0 * (q - p) as f64);
            if s > from[from.len() - 1] {
                at.push(q);
                from.push(s);
                break;
            }
            at.pop();
            from.pop();
        }
    }
    let mut k = 0;
    let mut done = Vec::with_capacity(f.len());
    for q in 0..f.len() {
        while k + 1 < at.len() && from[k + 1] < q as f64 {
            k += 1;
        }
        done.push((q as f64 - at[k] as f64).powi(2) + f[at[k]]);
    }
    done
}

/// Closed outlines filled by the even-odd rule, `x` and `y` in mm from the image's top-left corner: a pixel belongs if its centre does.
pub fn filled(outlines: &[Vec<(f64, f64)>], size_mm: (f64, f64), mm_per_px: f64) -> Stencil {
    let (width, height) = (
        (size_mm.0 / mm_per_px).round() as usize,
        (size_mm.1 / mm_per_px).round() as usize,
    );
    let mut open = vec![false; width * height];
    for row in 0..height {
        let y = (row as f64 + 0.5) * mm_per_px;
        let mut crossings = Vec::new();
        for outline in outlines {
            for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
                if (a.1 > y) != (b.1 > y) {
                    crossings.push(a.0 + (y - a.1) / (b.1 - a.1) * (b.0 - a.0));
                }
            }
        }
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let px = |mm: f64| ((mm / mm_per_px - 0.5).ceil().max(0.0) as usize).min(width);
            open[row * width + px(pair[0])..row * width + px(pair[1])].fill(true);
        }
    }
    Stencil {
        width,
        height,
        open,
        mm_per_px,
    }
}
