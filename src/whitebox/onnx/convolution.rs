//! Convolution and pooling of images (rank 4: 1 × channels × rows × columns).

use std::sync::Arc;

use burn::tensor::ops::{AvgPoolOptions, ConvOptions, ConvTransposeOptions, MaxPoolOptions};
use burn::tensor::{Tensor, module};
use onnx_ir::Node;
use onnx_ir::node::padding::{AutoPad, PaddingConfig2d};

use super::operator::{AnyOperator, Inputs, Operator};
use super::value::{Floats, Value, bounded};
use crate::whitebox::NetworkFault;

/// How a window walks over an image; rows first.
struct Window {
    kernel: [usize; 2],
    stride: [usize; 2],
    dilation: [usize; 2],
    padding: PaddingConfig2d,
    auto_pad: AutoPad,
}

impl Window {
    /// Pixels added before and after, for rows and for columns, to an image of so many channels, rows and columns.
    fn padding(&self, [channels, rows, columns]: [usize; 3]) -> Result<[(usize, usize); 2], NetworkFault> {
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
}

struct Convolution {
    window: Window,
    groups: usize,
}

impl Operator for Convolution {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let weight = inputs.floats(1)?.of_rank::<4>()?;
        let bias = inputs.optional_floats(2)?.map(|bias| bias.of_rank::<1>()).transpose()?;
        let ([_, channels, rows, columns], [_, per_group, ..]) = (x.dims(), weight.dims());
        if channels != per_group * self.groups {
            return Err(NetworkFault::Count("channels", per_group * self.groups, channels));
        }
        let Window { stride, dilation, .. } = self.window;
        let padding = self.window.padding([channels, rows, columns])?;
        let options = ConvOptions::new_with_padding(stride, padding, dilation, self.groups);
        rank_4(module::conv2d(x, weight, bias, options))
    }
}

struct TransposedConvolution {
    options: ConvTransposeOptions<2>,
}

impl Operator for TransposedConvolution {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let weight = inputs.floats(1)?.of_rank::<4>()?;
        let bias = inputs.optional_floats(2)?.map(|bias| bias.of_rank::<1>()).transpose()?;
        let ([_, _, rows, columns], [_, per_group, kernel_rows, kernel_columns]) = (x.dims(), weight.dims());
        let side = |axis: usize, side: usize, kernel: usize| {
            let reach = kernel.saturating_mul(self.options.dilation[axis]);
            side.saturating_mul(self.options.stride[axis])
                .saturating_add(reach)
                .saturating_add(self.options.padding_out[axis])
        };
        let channels = per_group.saturating_mul(self.options.groups);
        bounded([channels, side(0, rows, kernel_rows), side(1, columns, kernel_columns)])?;
        rank_4(module::conv_transpose2d(x, weight, bias, self.options.clone()))
    }
}

struct MaxPool {
    window: Window,
    ceil_mode: bool,
}

impl Operator for MaxPool {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let [_, channels, rows, columns] = x.dims();
        let options = MaxPoolOptions::new(self.window.kernel)
            .with_stride(self.window.stride)
            .with_padding_pairs(self.window.padding([channels, rows, columns])?)
            .with_dilation(self.window.dilation)
            .with_ceil_mode(self.ceil_mode);
        rank_4(module::max_pool2d(x, options))
    }
}

struct AveragePool {
    window: Window,
    ceil_mode: bool,
    counts_padding: bool,
}

impl Operator for AveragePool {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let [_, channels, rows, columns] = x.dims();
        let options = AvgPoolOptions::new(self.window.kernel)
            .with_stride(self.window.stride)
            .with_padding_pairs(self.window.padding([channels, rows, columns])?)
            .with_count_include_pad(self.counts_padding)
            .with_ceil_mode(self.ceil_mode);
        rank_4(module::avg_pool2d(x, options))
    }
}

/// One number a channel: the mean or the maximum of all its pixels.
enum Global {
    Mean,
    Max,
}

impl Operator for Global {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        rank_4(match self {
            Global::Mean => x.mean_dim(2).mean_dim(3),
            Global::Max => x.max_dim(2).max_dim(3),
        })
    }
}

/// (x − mean) / √(variance + ε) · scale + shift, per channel, with the statistics of training.
struct BatchNorm {
    epsilon: f64,
}

impl Operator for BatchNorm {
    fn run(&self, mut inputs: Inputs) -> Result<Vec<Value>, NetworkFault> {
        let x = inputs.floats(0)?.of_rank::<4>()?;
        let mut per_channel = |i: usize| {
            let v = inputs.floats(i)?;
            let channels = v.x.shape().num_elements();
            v.reshaped(&[1, channels, 1, 1])?.of_rank::<4>()
        };
        let (scale, shift, mean, variance) = (per_channel(1)?, per_channel(2)?, per_channel(3)?, per_channel(4)?);
        let factor = scale / variance.add_scalar(self.epsilon).sqrt();
        rank_4(x * factor.clone() + (shift - mean * factor))
    }
}

fn rank_4(x: Tensor<4>) -> Result<Vec<Value>, NetworkFault> {
    Ok(vec![Value::Floats(Floats::from_rank(x)?)])
}

pub(super) fn read(node: &Node) -> Option<AnyOperator> {
    Some(match node {
        Node::Conv2d(n) => {
            let c = &n.config;
            let window = Window {
                kernel: c.kernel_size,
                stride: c.stride,
                dilation: c.dilation,
                padding: c.padding.clone(),
                auto_pad: c.auto_pad.clone(),
            };
            Arc::new(Convolution {
                window,
                groups: c.groups,
            })
        }
        // Other paddings than the plain one have not been seen in detectors.
        Node::ConvTranspose2d(n) if n.config.auto_pad == AutoPad::NotSet && n.config.output_shape.is_none() => {
            let c = &n.config;
            let options = ConvTransposeOptions::new(c.stride, c.padding, c.padding_out, c.dilation, c.groups);
            Arc::new(TransposedConvolution { options })
        }
        Node::MaxPool2d(n) if n.outputs.len() == 1 => {
            let c = &n.config;
            let window = Window {
                kernel: c.kernel_size,
                stride: c.strides,
                dilation: c.dilation,
                padding: c.padding.clone(),
                auto_pad: c.auto_pad.clone(),
            };
            let ceil_mode = c.ceil_mode;
            Arc::new(MaxPool { window, ceil_mode })
        }
        Node::AveragePool2d(n) if n.config.dilation == [1, 1] => {
            let c = &n.config;
            let window = Window {
                kernel: c.kernel_size,
                stride: c.strides,
                dilation: c.dilation,
                padding: c.padding.clone(),
                auto_pad: c.auto_pad.clone(),
            };
            Arc::new(AveragePool {
                window,
                ceil_mode: c.ceil_mode,
                counts_padding: c.count_include_pad,
            })
        }
        Node::GlobalAveragePool(_) => Arc::new(Global::Mean),
        Node::GlobalMaxPool(_) => Arc::new(Global::Max),
        Node::BatchNormalization(n) => {
            let epsilon = match &n.config {
                onnx_ir::node::batch_norm::BatchNormConfig::Static(c) => c.epsilon,
                onnx_ir::node::batch_norm::BatchNormConfig::Runtime(c) => c.epsilon,
            };
            // The parser says 0 where a file says nothing, and the standard then means 1e-5.
            let epsilon = if epsilon == 0.0 { 1e-5 } else { epsilon };
            Arc::new(BatchNorm { epsilon })
        }
        _ => return None,
    })
}
