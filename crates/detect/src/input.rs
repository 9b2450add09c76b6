//! Photos as input tensors of detectors, and from its coordinates back to the photo's.

use image::RgbImage;

use super::manifest::{Channels, Input, Kernel, Layout, Manifest, Resize};
use scaleproof_core::geometry::BoxPx;
use scaleproof_photo::{opencv_cubic, opencv_linear, shrunk};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputPlacement {
    /// Input pixels per photo pixel.
    pub scale: [f64; 2],
    /// Input pixel of the photo's top-left corner.
    pub offset: [f64; 2],
    /// Size of the resized photo in input pixels.
    pub size: [u32; 2],
    /// Width, height of the whole input, border included.
    pub canvas: [u32; 2],
    /// Size of the photo in pixels.
    pub photo: [f64; 2],
}

impl InputPlacement {
    /// Follows the arithmetic of the detectors' own pipelines, truncation included.
    pub fn new(input: &Input, photo_width: u32, photo_height: u32) -> InputPlacement {
        let (net, photo_px) = (input.size_px, [photo_width, photo_height]);
        let photo = photo_px.map(f64::from);
        let per_axis = |size: [u32; 2]| [0, 1].map(|i| f64::from(size[i]) / photo[i]);
        let ratio = per_axis(net)[0].min(per_axis(net)[1]);
        let truncated = |ratio: f64| photo.map(|side| ((side * ratio) as u32).max(1));
        let (scale, size, canvas) = match input.resize {
            Resize::Stretch => (per_axis(net), net, net),
            Resize::Original => ([1.0; 2], photo_px, photo_px),
            // YOLOX and the ONNX zoo's R-CNN divide by the ratio itself, not by the truncated size.
            Resize::LetterboxTopLeft => ([ratio; 2], truncated(ratio), net),
            Resize::ShortSide => {
                let ratio = f64::from(net[0]) / photo[0].min(photo[1]);
                let size = truncated(ratio);
                ([ratio; 2], size, size.map(|side| side.next_multiple_of(32)))
            }
            Resize::ShortestEdge => {
                let size = shortest_edge(photo_px, net);
                (per_axis(size), size, size)
            }
            Resize::LetterboxCentre => (per_axis(truncated(ratio)), truncated(ratio), net),
            Resize::LetterboxCentreRounded => {
                let size = photo.map(|side| ((side * ratio).round() as u32).max(1));
                (per_axis(size), size, net)
            }
        };
        let is_centred = matches!(input.resize, Resize::LetterboxCentre | Resize::LetterboxCentreRounded);
        let offset = [0, 1].map(|i| {
            if is_centred {
                f64::from((net[i] - size[i]) / 2)
            } else {
                0.0
            }
        });
        InputPlacement {
            scale,
            offset,
            size,
            canvas,
            photo,
        }
    }

    /// A box in input pixels as a box in photo pixels, cut at the photo's border.
    pub fn to_photo(self, b: BoxPx) -> BoxPx {
        let x = |v: f64| (v - self.offset[0]) / self.scale[0];
        let y = |v: f64| (v - self.offset[1]) / self.scale[1];
        BoxPx::new(x(b.x1), y(b.y1), x(b.x2), y(b.y2)).clipped(self.photo[0], self.photo[1])
    }
}

/// The size of a photo whose shorter side is brought to a length, unless the longer would exceed the most it may have. Source: `get_size_with_aspect_ratio`
/// of Transformers, whose truncations and one rounding (of halves to even) these are.
fn shortest_edge(photo: [u32; 2], [shorter, most]: [u32; 2]) -> [u32; 2] {
    let [low, high] = [photo[0].min(photo[1]), photo[0].max(photo[1])].map(f64::from);
    let (shorter, most) = (f64::from(shorter), f64::from(most));
    let is_limited = high / low * shorter > most;
    let raw = if is_limited { most * low / high } else { shorter };
    let side = raw.round_ties_even();
    if low == side {
        return photo;
    }
    let longer = (raw * high / low) as u32;
    let (side, longer) = ((side as u32).max(1), longer.max(1));
    if photo[0] < photo[1] {
        [side, longer]
    } else {
        [longer, side]
    }
}

impl Manifest {
    /// The least width and height in pixels to which a photo of this size may be reduced before it is resized for the network: twice what
    /// the network sees of it, so that a kernel that averages still has pixels to average. OpenCV's kernels take a few pixels of the whole photo
    /// and skip the rest: of a reduced one they would take others. That photo, and one that the network resizes by itself, must stay whole.
    pub fn least_px(&self, photo_width: u32, photo_height: u32) -> [u32; 2] {
        let Input { resize, kernel, .. } = self.input;
        if resize == Resize::Original || kernel != Kernel::Antialiased {
            return [photo_width, photo_height];
        }
        let placement = InputPlacement::new(&self.input, photo_width, photo_height);
        placement.size.map(|side| side.saturating_mul(2))
    }

    /// The size that a photo is brought to by OpenCV's linear kernel, which looks at a few of its rows: given at this size, it stays as it is. `None` for
    /// networks with another kernel, or none.
    pub fn opencv_linear_px(&self, photo_width: u32, photo_height: u32) -> Option<[u32; 2]> {
        let Input { resize, kernel, .. } = self.input;
        let is_resized = resize != Resize::Original && kernel == Kernel::OpencvLinear;
        is_resized.then(|| InputPlacement::new(&self.input, photo_width, photo_height).size)
    }
}

/// The input tensor's numbers, in the order of the manifest's layout. The photo may come reduced.
pub fn tensor(photo: &RgbImage, input: &Input, placement: &InputPlacement) -> Vec<f32> {
    let resized = match input.kernel {
        Kernel::OpencvLinear => opencv_linear(photo, placement.size),
        Kernel::OpencvCubic => opencv_cubic(photo, placement.size),
        Kernel::Antialiased => shrunk(photo, placement.size),
    };
    let [net_w, net_h] = placement.canvas.map(|v| v as usize);
    let [left, top] = placement.offset.map(|v| v as usize);
    let (width, plane) = (placement.size[0] as usize, net_w * net_h);
    let mut tensor = vec![0.0; 3 * plane];
    for channel in 0..3 {
        let (mean, std) = (input.mean[channel], input.std[channel]);
        let source = match input.channels {
            Channels::Rgb => channel,
            Channels::Bgr => 2 - channel,
        };
        // Where the channel begins, and how far apart its values are.
        let (first, step) = match input.layout {
            Layout::Nchw | Layout::Chw => (channel * plane, 1),
            Layout::Nhwc => (channel, 3),
        };
        let to = &mut tensor[first..];
        if input.resize != Resize::ShortSide {
            let border = (f32::from(input.pad.level(channel)) - mean) / std;
            to.iter_mut().step_by(step).take(plane).for_each(|to| *to = border);
        }
        for (y, row) in resized.chunks_exact(3 * width).enumerate() {
            let to = to[((top + y) * net_w + left) * step..].iter_mut().step_by(step);
            to.zip(row.chunks_exact(3))
                .for_each(|(to, rgb)| *to = (f32::from(rgb[source]) - mean) / std);
        }
    }
    tensor
}
