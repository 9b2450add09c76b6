//! From a photo to a detector's input tensor, and from its coordinates back to the photo's.

use fast_image_resize as fir;
use fir::images::{TypedImage, TypedImageRef};
use fir::pixels::U8x3;
use image::RgbImage;

use super::linear;
use super::manifest::{Channels, Input, Kernel, Layout, Manifest, Resize};
use scaleproof_core::geometry::BoxPx;

/// Where the photo lies in the network's input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputPlacement {
    /// Input pixels per photo pixel.
    scale: [f64; 2],
    /// Input pixel of the photo's top-left corner.
    pub offset: [f64; 2],
    /// Size of the resized photo in input pixels.
    pub size: [u32; 2],
    /// Width, height of the whole input, border included.
    pub canvas: [u32; 2],
    /// Size of the photo in pixels.
    pub(super) photo: [f64; 2],
}

impl InputPlacement {
    /// Follows the arithmetic of the detectors' own pipelines, truncation included.
    pub fn new(input: &Input, photo_width: u32, photo_height: u32) -> InputPlacement {
        let [net_w, net_h] = input.size_px;
        let photo = [f64::from(photo_width), f64::from(photo_height)];
        let ratio = (f64::from(net_w) / photo[0]).min(f64::from(net_h) / photo[1]);
        let truncated = |ratio: f64| photo.map(|side| ((side * ratio) as u32).max(1));
        let centred = |size: [u32; 2]| InputPlacement {
            scale: per_axis(size, photo),
            offset: [f64::from((net_w - size[0]) / 2), f64::from((net_h - size[1]) / 2)],
            size,
            canvas: input.size_px,
            photo,
        };
        let in_the_corner = |scale: [f64; 2], size: [u32; 2], canvas: [u32; 2]| InputPlacement {
            scale,
            offset: [0.0, 0.0],
            size,
            canvas,
            photo,
        };
        match input.resize {
            Resize::Stretch => in_the_corner(per_axis(input.size_px, photo), input.size_px, input.size_px),
            Resize::Original => in_the_corner([1.0, 1.0], [photo_width, photo_height], [photo_width, photo_height]),
            // YOLOX and the ONNX zoo's R-CNN divide by the ratio itself, not by the truncated size.
            Resize::LetterboxTopLeft => in_the_corner([ratio, ratio], truncated(ratio), input.size_px),
            Resize::ShortSide => {
                let ratio = f64::from(net_w) / photo[0].min(photo[1]);
                let size = truncated(ratio);
                in_the_corner([ratio, ratio], size, size.map(|side| side.next_multiple_of(32)))
            }
            Resize::LetterboxCentre => centred(truncated(ratio)),
            Resize::LetterboxCentreRounded => centred(photo.map(|side| ((side * ratio).round() as u32).max(1))),
        }
    }

    /// Width, height a reduced image must have to stand in for the photo: twice what the network sees of it, or all where the
    /// network resizes by itself. A kernel then never has to enlarge, and still averages over the reduced pixels.
    pub(super) fn least_px(&self, input: &Input) -> [u32; 2] {
        match input.resize {
            Resize::Original => self.size,
            _ => self.size.map(|side| side.saturating_mul(2)),
        }
    }

    /// A box in input pixels as a box in photo pixels, cut at the photo's border.
    pub fn to_photo(self, b: BoxPx) -> BoxPx {
        let x = |v: f64| (v - self.offset[0]) / self.scale[0];
        let y = |v: f64| (v - self.offset[1]) / self.scale[1];
        BoxPx::new(x(b.x1), y(b.y1), x(b.x2), y(b.y2)).clipped(self.photo[0], self.photo[1])
    }
}

fn per_axis(size: [u32; 2], photo: [f64; 2]) -> [f64; 2] {
    [f64::from(size[0]) / photo[0], f64::from(size[1]) / photo[1]]
}

impl Manifest {
    /// The least width and height in pixels to which a photo of this size may be reduced before it is resized for the network.
    pub fn least_px(&self, photo_width: u32, photo_height: u32) -> [u32; 2] {
        InputPlacement::new(&self.input, photo_width, photo_height).least_px(&self.input)
    }
}

/// Why a photo cannot be resized.
#[derive(Debug, thiserror::Error)]
pub enum ResizeError {
    #[error(transparent)]
    Photo(#[from] fir::ImageBufferError),
    #[error(transparent)]
    Resize(#[from] fir::ResizeError),
}

/// The input tensor's numbers, in the order of the manifest's layout. The photo may come reduced.
pub fn tensor(photo: &RgbImage, input: &Input, placement: &InputPlacement) -> Result<Vec<f32>, ResizeError> {
    let resized = resize(photo, placement.size, input.kernel)?;
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
            let border = (f32::from(input.pad) - mean) / std;
            to.iter_mut().step_by(step).take(plane).for_each(|to| *to = border);
        }
        for (y, row) in resized.chunks_exact(3 * width).enumerate() {
            let to = to[((top + y) * net_w + left) * step..].iter_mut().step_by(step);
            to.zip(row.chunks_exact(3))
                .for_each(|(to, rgb)| *to = (f32::from(rgb[source]) - mean) / std);
        }
    }
    Ok(tensor)
}

/// Interleaved RGB bytes of the photo at another size.
fn resize(photo: &RgbImage, size: [u32; 2], kernel: Kernel) -> Result<Vec<u8>, ResizeError> {
    match kernel {
        Kernel::OpencvLinear => Ok(linear::resized(photo, size)),
        Kernel::Antialiased => antialiased(photo, size),
    }
}

fn antialiased(photo: &RgbImage, [width, height]: [u32; 2]) -> Result<Vec<u8>, ResizeError> {
    let source = TypedImageRef::<U8x3>::from_buffer(photo.width(), photo.height(), photo.as_raw())?;
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    let mut resized = TypedImage::<U8x3>::from_buffer(width, height, &mut pixels)?;
    let options = fir::ResizeOptions::new().resize_alg(fir::ResizeAlg::Convolution(fir::FilterType::Bilinear));
    // By the type of its pixels: `resize` would compile the loops for every type there is.
    fir::Resizer::new().resize_typed(&source, &mut resized, &options)?;
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::super::manifest::Values;
    use super::*;
    use proptest::prelude::*;

    fn input(resize: Resize) -> Input {
        Input {
            size_px: [416, 320],
            layout: Layout::Nchw,
            values: Values::F32,
            resize,
            kernel: Kernel::OpencvLinear,
            pad: 114,
            channels: Channels::Bgr,
            mean: [0.0; 3],
            std: [1.0; 3],
        }
    }

    #[test]
    fn a_letterboxed_photo_is_padded_and_bgr() {
        let photo = RgbImage::from_pixel(208, 80, image::Rgb([10, 20, 30]));
        let input = input(Resize::LetterboxCentre);
        let placement = InputPlacement::new(&input, 208, 80);
        let tensor = tensor(&photo, &input, &placement).unwrap();
        let at = |channel: usize, x: usize, y: usize| tensor[channel * 416 * 320 + y * 416 + x];
        assert_eq!((at(0, 0, 0), at(0, 415, 319)), (114.0, 114.0));
        assert_eq!((at(0, 0, 80), at(1, 415, 239), at(2, 200, 160)), (30.0, 20.0, 10.0));
    }

    #[test]
    fn channels_last_is_the_same_image() {
        let photo = RgbImage::from_fn(97, 61, |x, y| image::Rgb([x as u8, y as u8, 7]));
        let planar = input(Resize::LetterboxCentreRounded);
        let last = Input {
            layout: Layout::Nhwc,
            ..planar.clone()
        };
        let placement = InputPlacement::new(&planar, 97, 61);
        let [planar, last] = [planar, last].map(|input| tensor(&photo, &input, &placement).unwrap());
        let plane = 416 * 320;
        assert!((0..3 * plane).all(|i| planar[i] == last[i % plane * 3 + i / plane]));
    }

    #[test]
    fn a_given_short_side_ends_in_zeros_at_a_multiple_of_32() {
        let photo = RgbImage::from_pixel(301, 203, image::Rgb([10, 20, 30]));
        let input = Input {
            size_px: [96, 96],
            mean: [1.0; 3],
            ..input(Resize::ShortSide)
        };
        let placement = InputPlacement::new(&input, 301, 203);
        // 301 · 96 / 203 = 142.3
        assert_eq!((placement.size, placement.canvas), ([142, 96], [160, 96]));
        let tensor = tensor(&photo, &input, &placement).unwrap();
        assert_eq!((tensor[141], tensor[142]), (29.0, 0.0));
    }

    #[test]
    fn the_antialiased_kernel_averages_what_linear_skips() {
        // Every fourth column white: reduced by four, the mean is a quarter of white.
        let photo = RgbImage::from_fn(256, 64, |x, _| image::Rgb([if x % 4 == 0 { 255 } else { 0 }; 3]));
        let mean = |bytes: Vec<u8>| bytes.iter().map(|b| f64::from(*b)).sum::<f64>() / bytes.len() as f64;
        assert!((mean(resize(&photo, [64, 16], Kernel::Antialiased).unwrap()) - 63.75).abs() < 2.0);
        assert!(mean(resize(&photo, [64, 16], Kernel::OpencvLinear).unwrap()) < 40.0);
    }

    proptest! {
        /// Boxes placed into the input and read back land where they were, on odd photo sizes too.
        #[test]
        fn boxes_come_back(
            width in 33u32..3000, height in 33u32..3000, resize in prop::sample::select(vec![
                Resize::Stretch, Resize::LetterboxTopLeft, Resize::LetterboxCentre, Resize::LetterboxCentreRounded]),
            x in 0.0..0.5_f64, y in 0.0..0.5_f64,
        ) {
            let p = InputPlacement::new(&input(resize), width, height);
            let (w, h) = (f64::from(width), f64::from(height));
            let wanted = BoxPx::new(x * w, y * h, (x + 0.4) * w, (y + 0.4) * h);
            let placed = BoxPx::new(
                wanted.x1 * p.scale[0] + p.offset[0], wanted.y1 * p.scale[1] + p.offset[1],
                wanted.x2 * p.scale[0] + p.offset[0], wanted.y2 * p.scale[1] + p.offset[1]);
            let back = p.to_photo(placed);
            prop_assert!((back.x1 - wanted.x1).abs() < 1e-6 && (back.y2 - wanted.y2).abs() < 1e-6);
            prop_assert!(placed.x2 <= 416.0 + 1e-6 && placed.y2 <= 320.0 + 1e-6);
        }
    }
}
