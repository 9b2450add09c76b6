//! Resizing and padding inside the network.

use std::sync::Arc;

use burn::tensor::Device;
use burn::tensor::ops::PadMode as Mode;
use onnx_ir::Node;
use onnx_ir::pad::{AxesInput, ConstantValueInput, PadInput, PadMode};
use onnx_ir::resize::{CoordinateTransformMode, NearestMode, ResizeConfig, ResizeMode, ResizeScales, ResizeSizes};

use super::operator::{Argument, Inputs, IntegerSetting, Operator, axes_of, setting};
use super::value::{Floats, RANK, Result, Value, bounded};
use crate::NetworkFault;
use crate::layers::{Layer, Separate};

/// Rows and columns to another number, each by a matrix whose rows are the kernel's weights.
struct Resize {
    is_linear: bool,
    coordinates: CoordinateTransformMode,
    nearest: NearestMode,
    size: Size,
}

enum Size {
    Scales([f32; 2]),
    /// The input that holds them, batch and channels included.
    ScalesInput(usize),
    Sides(IntegerSetting),
}

impl Resize {
    fn read(config: &ResizeConfig) -> Option<Resize> {
        let is_plain = config.antialias == 0 && config.exclude_outside == 0;
        let is_known = config.mode != ResizeMode::Cubic
            && config.coordinate_transformation_mode != CoordinateTransformMode::TfCropAndResize;
        let size = match (&config.scales, &config.sizes) {
            (Some(ResizeScales::Static(v)), _) => Size::Scales(v.as_slice().try_into().ok()?),
            (Some(ResizeScales::Runtime(r)), _) => Size::ScalesInput(r.input_index),
            (None, Some(sizes)) => Size::Sides(setting!(ResizeSizes, sizes)),
            (None, None) => return None,
        };
        (is_plain && is_known).then_some(Resize {
            is_linear: config.mode == ResizeMode::Linear,
            coordinates: config.coordinate_transformation_mode.clone(),
            nearest: config.nearest_mode.clone(),
            size,
        })
    }

    /// New rows and columns, and by how much each is scaled.
    fn target(&self, old: [usize; 2], inputs: &mut Inputs) -> Result<[(usize, f32); 2]> {
        let by_scale =
            |scales: [f32; 2]| std::array::from_fn(|i| ((old[i] as f32 * scales[i]).floor() as usize, scales[i]));
        match &self.size {
            Size::Scales(scales) => Ok(by_scale(*scales)),
            Size::ScalesInput(i) => match inputs.floats(*i)?.values()?[..] {
                [.., y, x] => Ok(by_scale([y, x])),
                _ => Err("its scales are too few".into()),
            },
            Size::Sides(sides) => match sides.values(inputs)?[..] {
                [.., y, x] => {
                    let sides = [y, x].map(|side| usize::try_from(side).unwrap_or(0));
                    Ok(std::array::from_fn(|i| (sides[i], sides[i] as f32 / old[i] as f32)))
                }
                _ => Err("its sizes are too few".into()),
            },
        }
    }

    /// Which old index a new one looks at (ONNX: Resize, coordinate_transformation_mode).
    fn source(&self, at: usize, scale: f32, old: usize, new: usize) -> f32 {
        let at = at as f32;
        match self.coordinates {
            CoordinateTransformMode::Asymmetric => at / scale,
            CoordinateTransformMode::AlignCorners if new > 1 => at * (old as f32 - 1.0) / (new as f32 - 1.0),
            CoordinateTransformMode::AlignCorners => 0.0,
            CoordinateTransformMode::PytorchHalfPixel if new <= 1 => 0.0,
            CoordinateTransformMode::TfHalfPixelForNn => (at + 0.5) / scale,
            _ => (at + 0.5) / scale - 0.5,
        }
    }

    /// `new × old` weights, row-major.
    fn weights(&self, old: usize, new: usize, scale: f32) -> Vec<f32> {
        let mut weights = vec![0.0; new * old];
        for (at, row) in weights.chunks_exact_mut(old).enumerate() {
            let source = self.source(at, scale, old, new);
            if self.is_linear {
                let source = source.clamp(0.0, old as f32 - 1.0);
                let low = source.floor();
                row[low as usize] += 1.0 - (source - low);
                row[(low as usize + 1).min(old - 1)] += source - low;
            } else {
                let index = match self.nearest {
                    NearestMode::RoundPreferFloor => (source - 0.5).ceil(),
                    NearestMode::RoundPreferCeil => (source + 0.5).floor(),
                    NearestMode::Floor => source.floor(),
                    NearestMode::Ceil => source.ceil(),
                };
                row[index.clamp(0.0, old as f32 - 1.0) as usize] = 1.0;
            }
        }
        weights
    }

    fn run(&self, mut inputs: Inputs) -> Result<Floats> {
        let image = inputs.values.first().and_then(Option::as_ref);
        let shape = image.map(Value::shape).unwrap_or_default();
        let [_, _, rows, columns] = shape[..] else {
            return Err(NetworkFault::Rank(shape, 4));
        };
        let [(new_rows, y), (new_columns, x)] = self.target([rows, columns], &mut inputs)?;
        if new_rows == 0 || new_columns == 0 || rows == 0 || columns == 0 {
            return Err("it resizes to or from nothing".into());
        }
        let image = inputs.floats(0)?;
        let sides = [shape[0], shape[1], new_rows.max(rows), new_columns.max(columns)];
        bounded(sides)?;
        bounded([new_rows, rows])?;
        bounded([new_columns, columns])?;
        let device = image.x.device();
        let left = Floats::new(self.weights(rows, new_rows, y), &[new_rows, rows], &device)?;
        let right = Floats::new(self.weights(columns, new_columns, x), &[new_columns, columns], &device)?;
        Ok(image.map(|x| left.x.matmul(x).matmul(right.x.swap_dims(RANK - 2, RANK - 1))))
    }

    fn layer(&self, arguments: &[Argument]) -> Option<Box<dyn Layer>> {
        let [1, channels, rows, columns] = arguments.first()?.image_shape()?[..] else {
            return None;
        };
        // Scales and sizes are read without a look at the device.
        let values = arguments.iter().map(Argument::constant).collect();
        let device = &Device::flex();
        let new = self.target([rows, columns], &mut Inputs { values, device }).ok()?;
        let weights = |old: usize, (new, scale): (usize, f32)| self.weights(old, new, scale);
        let weights = [weights(rows, new[0]), weights(columns, new[1])];
        Some(Box::new(Separate::new(channels, [rows, columns], weights)))
    }
}

/// A border around a tensor. `pads`: all befores, then all afters, as ONNX writes them; of the named axes.
fn pad(pads: IntegerSetting, axes: Option<IntegerSetting>, mode: PadMode, border: ConstantValueInput) -> Operator {
    Operator::new(move |mut inputs| {
        let pads = pads.values(&inputs)?;
        let axes = IntegerSetting::optional(&axes, &inputs)?;
        let border = match &border {
            ConstantValueInput::Static(v) => *v,
            ConstantValueInput::Runtime(r) => match inputs.optional_floats(r.input_index)? {
                Some(v) => v.values()?.first().copied().unwrap_or(0.0),
                None => 0.0,
            },
        };
        let v = inputs.floats(0)?;
        let axes = axes.unwrap_or_else(|| (0..v.rank as i64).collect());
        if pads.len() != 2 * axes.len() {
            return Err(NetworkFault::Count("paddings", 2 * axes.len(), pads.len()));
        }
        let mut pairs = [(0, 0); RANK];
        let side = |by: i64| usize::try_from(by).map_err(|_| NetworkFault::Malformed("it pads by less than nothing"));
        for (i, axis) in axes_of(&axes, v.rank)?.into_iter().enumerate() {
            pairs[v.axis(axis)?] = (side(pads[i])?, side(pads[i + axes.len()])?);
        }
        if pairs.iter().all(|pair| *pair == (0, 0)) {
            return Ok(v);
        }
        let sides = v.x.dims().into_iter().zip(pairs);
        bounded(sides.map(|(side, (before, after))| side.saturating_add(before).saturating_add(after)))?;
        let mode = match mode {
            PadMode::Constant => Mode::Constant(border),
            PadMode::Reflect => Mode::Reflect,
            PadMode::Edge => Mode::Edge,
        };
        Ok(v.map(|x| x.pad(pairs, mode)))
    })
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    match node {
        Node::Resize(n) | Node::Upsample(n) => {
            let resize = Arc::new(Resize::read(&n.config)?);
            let same = resize.clone();
            let operator = Operator::new(move |inputs| resize.run(inputs));
            Some(operator.with_layer(move |arguments, _| same.layer(arguments)))
        }
        Node::Pad(n) => {
            let (pads, axes) = match &n.config.pads {
                PadInput::Static(pairs) => {
                    let all: Vec<usize> = pairs.iter().map(|p| p.0).chain(pairs.iter().map(|p| p.1)).collect();
                    (IntegerSetting::known(&all), None)
                }
                PadInput::Runtime { input, axes } => {
                    let axes = axes.as_ref().map(|axes| setting!(AxesInput, axes));
                    (IntegerSetting::Input(input.input_index), axes)
                }
            };
            Some(pad(pads, axes, n.config.mode.clone(), n.config.constant_value.clone()))
        }
        _ => None,
    }
}
