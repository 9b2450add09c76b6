//! Axis-aligned boxes in pixels.

use serde::{Deserialize, Serialize};

/// A box in image pixels, corner to corner, counted from the top-left corner of the image: its first pixel is the box 0, 0, 1, 1.
/// Written as `[x1, y1, x2, y2]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(from = "[f64; 4]", into = "[f64; 4]")]
pub struct BoxPx {
    /// Left edge.
    pub x1: f64,
    /// Top edge.
    pub y1: f64,
    /// Right edge.
    pub x2: f64,
    /// Bottom edge.
    pub y2: f64,
}

impl BoxPx {
    /// Left, top, right, bottom.
    pub fn new(x1: f64, y1: f64, x2: f64, y2: f64) -> Self {
        Self { x1, y1, x2, y2 }
    }

    /// Right minus left.
    pub fn width(&self) -> f64 {
        (self.x2 - self.x1).max(0.0)
    }

    /// Bottom minus top.
    pub fn height(&self) -> f64 {
        (self.y2 - self.y1).max(0.0)
    }

    /// Width × height, px².
    pub fn area(&self) -> f64 {
        self.width() * self.height()
    }

    /// True when the corners are finite and the box has an area.
    pub fn is_solid(&self) -> bool {
        [self.x1, self.y1, self.x2, self.y2].iter().all(|v| v.is_finite()) && self.area() > 0.0
    }

    /// Area that two boxes have in common, px².
    pub fn overlap(&self, other: &BoxPx) -> f64 {
        let w = (self.x2.min(other.x2) - self.x1.max(other.x1)).max(0.0);
        let h = (self.y2.min(other.y2) - self.y1.max(other.y1)).max(0.0);
        w * h
    }

    /// Intersection over union as pycocotools computes it (`maskApi.c`, `bbIou`: no +1 pixel); 0 for empty boxes.
    pub fn iou(&self, other: &BoxPx) -> f64 {
        let both = self.overlap(other);
        let either = self.area() + other.area() - both;
        if either > 0.0 { both / either } else { 0.0 }
    }

    /// Returns the part inside an image of the given size in pixels.
    pub fn clipped(&self, width: f64, height: f64) -> BoxPx {
        BoxPx::new(
            self.x1.clamp(0.0, width),
            self.y1.clamp(0.0, height),
            self.x2.clamp(0.0, width),
            self.y2.clamp(0.0, height),
        )
    }

    /// Refuses boxes that count shares of a photo's width and height, as YOLO's do, where pixels belong: all that have an area lie in its first
    /// pixels.
    ///
    /// # Errors
    /// The reason, as a clause.
    pub fn check_counts_pixels(boxes: impl IntoIterator<Item = BoxPx>) -> Result<(), &'static str> {
        // Shares go up to 1, and are rounded.
        const LARGEST_SHARE: f64 = 1.5;
        let is_share = |b: BoxPx| <[f64; 4]>::from(b).iter().all(|v| v.abs() <= LARGEST_SHARE);
        let mut boxes = boxes.into_iter().filter(BoxPx::is_solid).peekable();
        if boxes.peek().is_some() && boxes.all(is_share) {
            return Err(
                "every box lies in the first pixels: boxes count pixels here, and these look like shares of the photo's width and height",
            );
        }
        Ok(())
    }

    /// Returns the smallest box around some points (x, y); `None` without points.
    pub fn around(points: impl IntoIterator<Item = [f64; 2]>) -> Option<BoxPx> {
        points.into_iter().fold(None, |found, [x, y]| match found {
            None => Some(BoxPx::new(x, y, x, y)),
            Some(b) => Some(BoxPx::new(b.x1.min(x), b.y1.min(y), b.x2.max(x), b.y2.max(y))),
        })
    }

    /// `[x, y, width, height]`, as COCO files write a box.
    pub fn to_xywh(&self) -> [f64; 4] {
        [self.x1, self.y1, self.x2 - self.x1, self.y2 - self.y1]
    }
}

impl From<[f64; 4]> for BoxPx {
    fn from([x1, y1, x2, y2]: [f64; 4]) -> Self {
        BoxPx::new(x1, y1, x2, y2)
    }
}

impl From<BoxPx> for [f64; 4] {
    fn from(b: BoxPx) -> Self {
        [b.x1, b.y1, b.x2, b.y2]
    }
}
