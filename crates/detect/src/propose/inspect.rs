//! Inspection of an ONNX file: its inputs, and its outputs for a grey image and for noise.

use std::path::Path;
use std::time::Duration;

use image::{Rgb, RgbImage};
use ort::value::{Outlet, TensorElementType};

use super::error::ProposeError;
use super::metadata::Metadata;
use crate::heads::Tensor;
use crate::input::InputPlacement;
use crate::manifest::{Input, Layout, Resize, SIDES_PX, Values};
use crate::onnx::{Affine, OnnxFile};
use crate::runtime::{self, NoAnswer, first_line};
use crate::{DetectError, Runtime};
use scaleproof_core::message::{Message, bail, message};

pub(super) struct Inspected {
    pub takes: Required,
    /// Width, height of the two images.
    pub size_px: [u32; 2],
    pub metadata: Metadata,
    /// The outputs for a grey image and for noise.
    pub answers: [Vec<Tensor>; 2],
    pub inputs: String,
    /// Contents of the file.
    pub file: OnnxFile,
}

/// The side of the images where neither the file nor the user says one.
const OPEN_SIDE_PX: u32 = 640;

/// Loads a network and runs it twice, each time within the limit. `size_px`, for files that leave it open: the user's, and its preprocessor's.
pub(super) fn inspect(
    runtime: &Runtime,
    path: &Path,
    bytes: &[u8],
    [size_px, usual_px]: [Option<[u32; 2]>; 2],
    time_limit: Duration,
) -> Result<Inspected, ProposeError> {
    let mut session = runtime::session(runtime, path)?;
    let metadata = Metadata::from_session(&session);
    let (takes, inputs) = (Required::from_inputs(session.inputs())?, listed(session.inputs()));
    let fixed = takes.size_px;
    if let (Some(fixed), Some(named)) = (fixed, size_px.filter(|named| Some(*named) != fixed)) {
        bail!(
            "the input is fixed at {}×{} pixels, not {}×{}", fixed[0], fixed[1], named[0], named[1];
            hint: "leave ‹size› out"
        );
    }
    let size_px = fixed
        .or(size_px)
        .or(metadata.size_px)
        .or(usual_px)
        .unwrap_or([OPEN_SIDE_PX; 2]);
    if !size_px.iter().all(|side| SIDES_PX.contains(side)) {
        let ([width, height], [least, most]) = (size_px, [SIDES_PX.start(), SIDES_PX.end()]);
        bail!("the input is {width}×{height} pixels, and sides from {least} to {most} can be used");
    }
    let file = OnnxFile::read(bytes, &takes.image);
    let (layout, values) = (takes.layout, takes.values);
    let input = Input {
        size_px,
        std: match values {
            Values::F32 => [file.prepares.map_or(255.0, Affine::std); 3],
            Values::U8 => [1.0; 3],
        },
        resize: Resize::Stretch,
        ..Input::unchanged(layout, values)
    };
    let placement = InputPlacement::new(&input, size_px[0], size_px[1]);
    let mut answer = |image: RgbImage| -> Result<Vec<Tensor>, ProposeError> {
        let takes_size = takes.takes_photo_size;
        let outputs = runtime::run(&mut session, &input, takes_size, &image, &placement, time_limit);
        outputs.map_err(|e| match e {
            NoAnswer::Failed(e) => {
                let ([width, height], reason) = (size_px, first_line(&e));
                let fault = message!("an image of {width}×{height} pixels could not be run ({reason})");
                fault.hint("name the input's size by ‹size›").into()
            }
            NoAnswer::TooLong => DetectError::too_long(&path.display(), time_limit).into(),
        })
    };
    let grey = RgbImage::from_pixel(size_px[0], size_px[1], Rgb([114; 3]));
    Ok(Inspected {
        answers: [answer(grey)?, answer(noise(size_px))?],
        takes,
        size_px,
        metadata,
        inputs,
        file,
    })
}

/// Noise that is identical every time: a linear congruential generator (Knuth's multiplier), its upper byte a value.
fn noise([width, height]: [u32; 2]) -> RgbImage {
    let mut state = 1_u64;
    let mut value = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 56) as u8
    };
    RgbImage::from_fn(width, height, |_, _| Rgb([value(), value(), value()]))
}

/// An input's sides; −1 where the file leaves one open, and none of what is no tensor.
fn shape(input: &Outlet) -> Vec<i64> {
    input.dtype().tensor_shape().map(|s| s.to_vec()).unwrap_or_default()
}

/// The order of the axes, the number of images, and their width and height, if an input could be images of three channels.
fn image(input: &Outlet) -> Option<(Layout, i64, [i64; 2])> {
    match shape(input)[..] {
        [n, 3, h, w] => Some((Layout::Nchw, n, [w, h])),
        [n, h, w, 3] => Some((Layout::Nhwc, n, [w, h])),
        [3, h, w] => Some((Layout::Chw, 1, [w, h])),
        _ => None,
    }
}

/// An image where the file leaves the number of its channels open, as exports whose every axis is open do; three then run, or nothing does.
fn open_image(input: &Outlet) -> Option<(Layout, i64, [i64; 2])> {
    match shape(input)[..] {
        [n, -1, h @ -1, w @ -1] => Some((Layout::Nchw, n, [w, h])),
        _ => None,
    }
}

fn listed(inputs: &[Outlet]) -> String {
    let side = |d: i64| if d < 0 { "?".to_owned() } else { d.to_string() };
    let one = |input: &Outlet| {
        let element = input.dtype().tensor_type();
        let element = element.map_or("no tensor".to_owned(), |e| e.to_string());
        let shape = shape(input).into_iter().map(side).collect::<Vec<_>>().join("×");
        format!("{} {shape} {element}", input.name())
    };
    inputs.iter().map(one).collect::<Vec<_>>().join(", ")
}

pub(super) struct Required {
    /// The input that photos go into.
    pub image: String,
    pub layout: Layout,
    pub values: Values,
    /// True with a second input of two whole numbers: the photo's width and height.
    pub takes_photo_size: bool,
    /// Width, height; `None` where the file leaves them open.
    pub size_px: Option<[u32; 2]>,
}

impl Required {
    /// Reads it from the inputs of a network: one image, or an image and the photo's size.
    fn from_inputs(inputs: &[Outlet]) -> Result<Required, Message> {
        let all = listed(inputs);
        let all_images = |of: fn(&Outlet) -> Option<_>| -> Vec<_> {
            inputs.iter().filter_map(|input| Some((input, of(input)?))).collect()
        };
        let images = Some(all_images(image)).filter(|images| !images.is_empty());
        let images = images.unwrap_or_else(|| all_images(open_image));
        let (image_input, (layout, batch, sides)) = match images[..] {
            [] => bail!(
                "no input is an image of three channels (inputs: {all}): this is no detector for photos, or it must be exported with three channels fixed"
            ),
            [only] => only,
            _ => bail!("several inputs could be the image ({all}): only networks that look at one image can be used"),
        };
        let values = match image_input.dtype().tensor_type() {
            Some(TensorElementType::Float32) => Values::F32,
            Some(TensorElementType::Uint8) => Values::U8,
            _ => {
                bail!("the image is neither float32 nor uint8 (inputs: {all}): export the network with float32 inputs")
            }
        };
        let is_photo_size = |input: &Outlet| {
            input.dtype().tensor_type() == Some(TensorElementType::Int64) && matches!(shape(input)[..], [1 | -1, 2])
        };
        let takes_photo_size = match inputs {
            [_] => false,
            [first, size] if first.name() == image_input.name() && is_photo_size(size) => true,
            _ => bail!(
                "besides the image only the photo's size can be given, as a second input of two whole numbers (inputs: {all}): export the network without the others"
            ),
        };
        if !matches!(batch, -1 | 1) {
            bail!("the network takes several images at once (inputs: {all}): export it for a single one");
        }
        let fixed = sides.map(|side| u32::try_from(side).ok().filter(|side| *side > 0));
        Ok(Required {
            image: image_input.name().to_owned(),
            layout,
            values,
            takes_photo_size,
            size_px: fixed[0].zip(fixed[1]).map(|(w, h)| [w, h]),
        })
    }
}
