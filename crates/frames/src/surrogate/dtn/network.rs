//! The Transformation Feature Extractor: a convolutional auto-encoder of k halvings, from the masked reference image to the maps TF.
//!
//! The paper draws its parts and gives no widths. Here: each stage of the encoder halves the image by a convolution of stride 2 and adds two
//! 3×3 convolutions, plain (`ConvNet`), around which the input is added (`ResNet`), or each of which sees all before it (`DenseNet`). The decoder
//! is the same for all three: it doubles the image and sees the encoder's features of that size beside it, as seams and panel
//! gaps of a pixel's width would otherwise have to pass through an image 2^k times smaller. There is no normalisation: batches are a few views, and a
//! view must not depend on the others of its batch.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use serde::{Deserialize, Serialize};

use super::Transformer;
use scaleproof_gradients::layers::learning::{By, Kernel, Network, Output};

/// Connection of the encoder's convolutions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[allow(clippy::enum_variant_names)] // so they are called
pub enum Encoder {
    #[default]
    ResNet,
    DenseNet,
    ConvNet,
}

impl Encoder {
    pub const ALL: [Self; 3] = [Self::ResNet, Self::DenseNet, Self::ConvNet];

    pub fn name(self) -> &'static str {
        ["resnet", "densenet", "convnet"][self as usize]
    }
}

/// Architecture of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Architecture {
    pub encoder: Encoder,
    /// k, 1 to [`Architecture::MAX_DEPTH`]: the number of times that the image is halved.
    pub depth: usize,
    pub transformer: Transformer,
}

impl Architecture {
    pub const MAX_DEPTH: usize = WIDTHS.len();
    /// Factor of windows' sides, px, for every depth.
    pub const ALIGN_PX: usize = 1 << Self::MAX_DEPTH;

    pub fn name(&self) -> String {
        let formula = match self.transformer {
            Transformer::Texture => "",
            Transformer::MultiplyAdd => " ntr",
        };
        format!("{} k={}{formula}", self.encoder.name(), self.depth)
    }

    fn halvings(&self) -> usize {
        self.depth.clamp(1, Self::MAX_DEPTH)
    }

    pub(super) fn is_possible(&self) -> bool {
        (1..=Self::MAX_DEPTH).contains(&self.depth)
    }
}

/// Channels at 1/2, 1/4, 1/8 and 1/16 of the size.
const WIDTHS: [usize; 4] = [16, 32, 64, 96];
const FULL_SIZE_WIDTH: usize = 24;

/// Darkest reference that a first guess is made from, sRGB; darker ones count as this.
const DARKEST_REFERENCE: f32 = 0.25;

#[derive(Debug, Clone, Copy)]
struct Conv {
    ins: usize,
    outs: usize,
    kernel: usize,
    stride: usize,
    /// Factor of its initial weights, against those that keep the variance through a ReLU (He et al. 2015).
    gain: f32,
}

impl Conv {
    fn count(&self) -> usize {
        self.ins * self.kernel * self.kernel
    }
}

/// The convolutions of an architecture, in the order in which an image passes them. Its weights are kept apart, in one list: kernel and bias of
/// each convolution in turn.
#[derive(Debug, Clone)]
pub(super) struct LayerShapes {
    architecture: Architecture,
    convs: Vec<Conv>,
}

impl LayerShapes {
    pub(super) fn new(architecture: Architecture) -> Self {
        let mut convs = Vec::new();
        let mut conv = |ins, outs, kernel, stride, gain| {
            convs.push(Conv {
                ins,
                outs,
                kernel,
                stride,
                gain,
            });
        };
        let below = |i: usize| if i == 0 { 3 } else { WIDTHS[i - 1] };
        for (i, width) in WIDTHS.into_iter().enumerate().take(architecture.halvings()) {
            conv(below(i), width, 3, 2, 1.0);
            if architecture.encoder == Encoder::DenseNet {
                let growth = width / 2;
                conv(width, growth, 3, 1, 1.0);
                conv(width + growth, growth, 3, 1, 1.0);
                // Brings the features together again.
                conv(width + 2 * growth, width, 1, 1, 1.0);
            } else {
                conv(width, width, 3, 1, 1.0);
                // A small second convolution of ResNet: the stage starts as the identity.
                let is_small = architecture.encoder == Encoder::ResNet;
                conv(width, width, 3, 1, if is_small { 0.1 } else { 1.0 });
            }
        }
        let wide = |i: usize| if i == 0 { FULL_SIZE_WIDTH } else { WIDTHS[i - 1] };
        for i in (0..architecture.halvings()).rev() {
            conv(WIDTHS[i] + below(i), wide(i), 3, 1, 1.0);
        }
        conv(FULL_SIZE_WIDTH, architecture.transformer.channels(), 1, 1, 0.1);
        Self { architecture, convs }
    }

    /// Returns true when lists have the lengths of the weights, in their order: kernels (outputs × inputs × rows × columns) and biases.
    pub(super) fn fits<'a>(&self, lists: impl IntoIterator<Item = &'a Vec<f32>>) -> bool {
        let lengths = self.convs.iter().flat_map(|c| [c.outs * c.count(), c.outs]);
        lists.into_iter().map(Vec::len).eq(lengths)
    }

    /// Returns the first weights: such that f starts about as `x = η · x_ref / η_ref`, which is the reference image where η is the reference, both ReLUs open for
    /// every η ([`Transformer::open`]). A ReLU that is shut everywhere learns nothing any more, and this is the best guess
    /// that needs no training. Three features of the full size carry x_ref to the multiplying map; the others start at random.
    pub(super) fn first_weights(&self, seed: u64, references: &[[u8; 3]]) -> Vec<Vec<f32>> {
        let mut rng = Pcg32::seed_from_u64(seed);
        let mut weights: Vec<Vec<f32>> = Vec::new();
        for conv in &self.convs {
            // Uniform with He's variance, 2 / count.
            let most = conv.gain * (6.0 / conv.count() as f32).sqrt();
            let mut random = |_| rng.random_range(-most..most);
            weights.push((0..conv.outs * conv.count()).map(&mut random).collect());
            weights.push(vec![0.0; conv.outs]);
        }
        let (transformer, out_at) = (self.architecture.transformer, self.convs.len() - 1);
        let (last, out) = (self.convs[out_at - 1], self.convs[out_at]);
        for channel in 0..3 {
            let feature = &mut weights[2 * (out_at - 1)][channel * last.count()..][..last.count()];
            feature.fill(0.0);
            // The middle of the 3×3 window of x_ref's channel, which follows the features from below.
            feature[9 * (last.ins - 3 + channel) + 4] = 1.0;
            let levels = references.iter().map(|rgb| f32::from(rgb[channel]) / 255.0);
            let eta = (levels.sum::<f32>() / references.len().max(1) as f32).max(DARKEST_REFERENCE);
            transformer.scatter(channel, transformer.open(), |map, bias| {
                weights[2 * out_at + 1][map] = bias as f32;
                if map == transformer.multiplying(channel) {
                    weights[2 * out_at][map * out.ins + channel] = 1.0 / eta;
                }
            });
        }
        weights
    }

    /// Builds the network for a window of `size` rows and columns, multiples of [`Architecture::ALIGN_PX`]: from the reference image, sRGB 0 to 1, 0 outside the
    /// paint, channel by channel, to TF. `weights` fit ([`LayerShapes::fits`]).
    pub(super) fn network(&self, weights: &[Vec<f32>], size: [usize; 2]) -> Network {
        let (network, reference) = Network::new(3, size, By::Weights);
        let layers = self.convs.iter().zip(weights.chunks_exact(2));
        let mut next = Layers { network, layers };
        let mut sizes = vec![reference];
        let mut x = reference;
        for _ in 0..self.architecture.halvings() {
            x = next.convolve_relu(x);
            let grown = next.convolve_relu(x);
            x = match self.architecture.encoder {
                Encoder::ConvNet => next.convolve_relu(grown),
                Encoder::ResNet => {
                    let added = next.convolve(grown);
                    let sum = next.network.sum(x, added);
                    next.network.relu(sum)
                }
                Encoder::DenseNet => {
                    let x = next.network.joined(x, grown);
                    let grown = next.convolve_relu(x);
                    let x = next.network.joined(x, grown);
                    next.convolve_relu(x)
                }
            };
            sizes.push(x);
        }
        sizes.pop();
        while let Some(beside) = sizes.pop() {
            let doubled = next.network.doubled(x);
            let both = next.network.joined(doubled, beside);
            x = next.convolve_relu(both);
        }
        next.convolve(x);
        next.network
    }
}

/// A network, and the convolutions that are not in it yet.
struct Layers<I> {
    network: Network,
    layers: I,
}

impl<'a, I: Iterator<Item = (&'a Conv, &'a [Vec<f32>])>> Layers<I> {
    /// Appends the next convolution.
    fn convolve(&mut self, x: Output) -> Output {
        let Some((conv, weights)) = self.layers.next() else {
            return x;
        };
        let kernel = Kernel {
            size: conv.kernel,
            stride: conv.stride,
            padding: conv.kernel / 2,
        };
        self.network.convolution(x, kernel, [&weights[0], &weights[1]])
    }

    /// Appends the next convolution and a ReLU.
    fn convolve_relu(&mut self, x: Output) -> Output {
        let x = self.convolve(x);
        self.network.relu(x)
    }
}
