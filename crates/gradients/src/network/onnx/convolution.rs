//! Convolution and pooling of images (rank 4: 1 × channels × rows × columns).

use std::sync::Arc;

use burn::tensor::ops::{AvgPoolOptions, ConvOptions, ConvTransposeOptions, MaxPoolOptions};
use burn::tensor::{Tensor, module};
use onnx_ir::Node;
use onnx_ir::node::padding::{AutoPad, PaddingConfig2d};

use super::operator::{Argument, Inputs, Operator};
use super::value::{Floats, Result, bounded};
use crate::NetworkFault;
use crate::layers::{self, Layer, MaxPool, Separate, Weights, Windows};

/// How a window walks over an image; rows first.
struct Window {
    kernel: [usize; 2],
    stride: [usize; 2],
    dilation: [usize; 2],
    padding: PaddingConfig2d,
    auto_pad: AutoPad,
}

impl Window {
    fn new([kernel, stride, dilation]: [[usize; 2]; 3], padding: &PaddingConfig2d, auto_pad: &AutoPad) -> Self {
        Window {
            kernel,
            stride,
            dilation,
            padding: padding.clone(),
            auto_pad: auto_pad.clone(),
        }
    }

    /// Pixels added before and after, for rows and for columns, to an image of so many channels, rows and columns.
    fn padding(&self, [channels, rows, columns]: [usize; 3]) -> Result<[(usize, usize); 2]> {
        let size = [rows, columns];
        let same = |axis: usize| {
            let reach = (self.kernel[axis] - 1) * self.dilation[axis] + 1;
            let windows = size[axis].div_ceil(self.stride[axis]);
            let missing = ((windows - 1) * self.stride[axis] + reach).saturating_sub(size[axis]);
            (missing / 2, missing - missing / 2)
        };
        let padding = match self.auto_pad {
            AutoPad::Valid => [(0, 0); 2],
            AutoPad::SameUpper => [same(0), same(1)],
            AutoPad::SameLower => [same(0), same(1)].map(|(less, more)| (more, less)),
            AutoPad::NotSet => {
                let (top, left, bottom, right) = self.padding.as_tuple();
                [(top, bottom), (left, right)]
            }
        };
        let padded = |axis: usize| {
            let (before, after) = padding[axis];
            size[axis].saturating_add(before).saturating_add(after)
        };
        bounded([channels, padded(0), padded(1)])?;
        Ok(padding)
    }

    /// Its places on an image, whose shape is `from`, for an output of shape `to`.
    fn windows(&self, from: &[usize], to: &[usize]) -> Option<Windows> {
        let (&[1, channels, rows, columns], &[1, _, new_rows, new_columns]) = (from, to) else {
            return None;
        };
        let [(top, _), (left, _)] = self.padding([channels, rows, columns]).ok()?;
        let is_any = ![channels, rows, columns, new_rows, new_columns].contains(&0);
        is_any.then_some(Windows {
            channels,
            image: [rows, columns],
            kernel: self.kernel,
            stride: self.stride,
            dilation: self.dilation,
            before: [top, left],
            count: [new_rows, new_columns],
        })
    }

    fn convolution(&self, groups: usize, arguments: &[Argument], to: &[usize]) -> Option<Box<dyn Layer>> {
        let (image, weights, bias) = match arguments {
            [Argument::Image(image), weights] => (image, weights, &Argument::Absent),
            [Argument::Image(image), weights, bias] => (image, weights, bias),
            _ => return None,
        };
        let biases = match bias {
            Argument::Absent => None,
            bias => Some(bias.numbers()?),
        };
        let (windows, outputs, weights) = (self.windows(image, to)?, to[1], weights.numbers()?);
        let wanted = outputs * (windows.channels / groups) * self.kernel[0] * self.kernel[1];
        let fits = outputs % groups == 0 && windows.channels % groups == 0 && weights.len() == wanted;
        let weights = Weights {
            groups,
            weights,
            biases,
            outputs,
        };
        (fits && weights.biases.as_ref().is_none_or(|b| b.len() == outputs))
            .then(|| layers::convolution(windows, weights))
    }
}

/// Means of windows; of what lies on the image alone where the border does not count.
fn average(windows: &Windows, counts_border: bool) -> Separate {
    let weights = [0, 1].map(|axis| {
        let (old, new) = (windows.image[axis], windows.count[axis]);
        let mut weights = vec![0.0; new * old];
        for (at, row) in weights.chunks_exact_mut(old).enumerate() {
            let places = (0..windows.kernel[axis]).filter_map(|tap| windows.place(axis, at, tap));
            let places: Vec<usize> = places.collect();
            let count = if counts_border {
                windows.kernel[axis]
            } else {
                places.len()
            };
            places.iter().for_each(|place| row[*place] = 1.0 / count as f32);
        }
        weights
    });
    Separate::new(windows.channels, windows.image, weights)
}

/// Each channel's mean.
fn mean_layer(arguments: &[Argument]) -> Option<Box<dyn Layer>> {
    let &[1, channels, rows, columns] = arguments.first()?.image_shape()? else {
        return None;
    };
    let weights = [rows, columns].map(|side| vec![1.0 / side as f32; side]);
    Some(Box::new(Separate::new(channels, [rows, columns], weights)))
}

type Weighted = (Tensor<4>, Tensor<4>, Option<Tensor<1>>);

fn weighted(mut inputs: Inputs) -> Result<Weighted> {
    let x = inputs.floats(0)?.of_rank::<4>()?;
    let weight = inputs.floats(1)?.of_rank::<4>()?;
    let bias = inputs.optional_floats(2)?.map(|bias| bias.of_rank::<1>()).transpose()?;
    Ok((x, weight, bias))
}

fn convolution(window: Window, groups: usize) -> Operator {
    let window = Arc::new(window);
    let same = window.clone();
    let operator = Operator::new(move |inputs| {
        let (x, weight, bias) = weighted(inputs)?;
        let ([_, channels, rows, columns], [_, per_group, ..]) = (x.dims(), weight.dims());
        if channels != per_group * groups {
            return Err(NetworkFault::Count("channels", per_group * groups, channels));
        }
        let padding = window.padding([channels, rows, columns])?;
        let options = ConvOptions::new_with_padding(window.stride, padding, window.dilation, groups);
        Floats::from_rank(module::conv2d(x, weight, bias, options))
    });
    operator.with_layer(move |arguments, shape| same.convolution(groups, arguments, shape))
}

fn transposed_convolution(options: ConvTransposeOptions<2>) -> Operator {
    Operator::new(move |inputs| {
        let (x, weight, bias) = weighted(inputs)?;
        let ([_, _, rows, columns], [_, per_group, kernel_rows, kernel_columns]) = (x.dims(), weight.dims());
        let side = |axis: usize, side: usize, kernel: usize| {
            let reach = kernel.saturating_mul(options.dilation[axis]);
            side.saturating_mul(options.stride[axis])
                .saturating_add(reach)
                .saturating_add(options.padding_out[axis])
        };
        let channels = per_group.saturating_mul(options.groups);
        bounded([channels, side(0, rows, kernel_rows), side(1, columns, kernel_columns)])?;
        Floats::from_rank(module::conv_transpose2d(x, weight, bias, options.clone()))
    })
}

/// One number for each place of a window: the largest, or the mean, where `counts_border` says whether what lies beside the image counts.
fn pool(window: Window, ceil_mode: bool, counts_border: Option<bool>) -> Operator {
    let window = Arc::new(window);
    let same = window.clone();
    let operator = Operator::new(move |mut inputs| {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let [_, channels, rows, columns] = x.dims();
        let padding = window.padding([channels, rows, columns])?;
        Floats::from_rank(match counts_border {
            None => {
                let options = MaxPoolOptions::new(window.kernel)
                    .with_stride(window.stride)
                    .with_padding_pairs(padding)
                    .with_dilation(window.dilation)
                    .with_ceil_mode(ceil_mode);
                module::max_pool2d(x, options)
            }
            Some(counts_border) => {
                let options = AvgPoolOptions::new(window.kernel)
                    .with_stride(window.stride)
                    .with_padding_pairs(padding)
                    .with_count_include_pad(counts_border)
                    .with_ceil_mode(ceil_mode);
                module::avg_pool2d(x, options)
            }
        })
    });
    operator.with_layer(move |arguments, shape| {
        let windows = same.windows(arguments.first()?.image_shape()?, shape)?;
        match counts_border {
            None => Some(Box::new(MaxPool(windows))),
            // Whether a window that hangs over the border counts there is read in several ways.
            Some(_) if ceil_mode => None,
            Some(counts_border) => Some(Box::new(average(&windows, counts_border))),
        }
    })
}

fn global(of_all: fn(Tensor<4>) -> Tensor<4>) -> Operator {
    Operator::new(move |mut inputs| Floats::from_rank(of_all(inputs.floats(0)?.of_rank::<4>()?)))
}

/// (x − mean) / √(variance + ε) · scale + shift, per channel, with the statistics of training.
fn batch_norm(epsilon: f64) -> Operator {
    Operator::new(move |mut inputs| {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let mut per_channel = |i: usize| {
            let v = inputs.floats(i)?;
            let channels = v.x.shape().num_elements();
            v.reshaped(&[1, channels, 1, 1])?.of_rank::<4>()
        };
        let (scale, shift, mean, variance) = (per_channel(1)?, per_channel(2)?, per_channel(3)?, per_channel(4)?);
        let factor = scale / variance.add_scalar(epsilon).sqrt();
        Floats::from_rank(x * factor.clone() + (shift - mean * factor))
    })
}

pub(super) fn read(node: &Node) -> Option<Operator> {
    Some(match node {
        Node::Conv2d(n) => {
            let c = &n.config;
            let window = Window::new([c.kernel_size, c.stride, c.dilation], &c.padding, &c.auto_pad);
            convolution(window, c.groups)
        }
        // Other paddings than the plain one have not been seen in detectors.
        Node::ConvTranspose2d(n) if n.config.auto_pad == AutoPad::NotSet && n.config.output_shape.is_none() => {
            let c = &n.config;
            let options = ConvTransposeOptions::new(c.stride, c.padding, c.padding_out, c.dilation, c.groups);
            transposed_convolution(options)
        }
        Node::MaxPool2d(n) if n.outputs.len() == 1 => {
            let c = &n.config;
            let window = Window::new([c.kernel_size, c.strides, c.dilation], &c.padding, &c.auto_pad);
            pool(window, c.ceil_mode, None)
        }
        Node::AveragePool2d(n) if n.config.dilation == [1, 1] => {
            let c = &n.config;
            let window = Window::new([c.kernel_size, c.strides, c.dilation], &c.padding, &c.auto_pad);
            pool(window, c.ceil_mode, Some(c.count_include_pad))
        }
        Node::GlobalAveragePool(_) => {
            global(|x| x.mean_dim(2).mean_dim(3)).with_layer(|arguments, _| mean_layer(arguments))
        }
        Node::GlobalMaxPool(_) => global(|x| x.max_dim(2).max_dim(3)),
        Node::BatchNormalization(n) => {
            let epsilon = match &n.config {
                onnx_ir::node::batch_norm::BatchNormConfig::Static(c) => c.epsilon,
                onnx_ir::node::batch_norm::BatchNormConfig::Runtime(c) => c.epsilon,
            };
            // The parser says 0 where a file says nothing, and the standard then means 1e-5.
            batch_norm(if epsilon == 0.0 { 1e-5 } else { epsilon })
        }
        _ => return None,
    })
}
