//! Convolution and pooling of images (rank 4: images × channels × rows × columns).

use super::arithmetic::of_two;
use super::combine::{deviation, reduced};
use super::graph::Graph;
use super::operator::{Inputs, Operator, one};
use super::run::Work;
use super::term::{Result, Term, bounded, no_axis};
use crate::layers::{self, MaxPool, Number, Operation, Separate, Summary, Transposed, Weights, Windows};
use scaleproof_core::message::{Message, message};
use scaleproof_detect::onnx_model::Node;

/// No kernel, step or border of a detector is larger.
const LARGEST: i64 = 1 << 16;

/// The settings of a sliding window; rows first.
struct Window {
    kernel: [usize; 2],
    stride: [usize; 2],
    dilation: [usize; 2],
    /// Added before and after, along rows and along columns.
    padding: [[usize; 2]; 2],
    ceil: bool,
}

/// Two numbers that a node states, or twice the usual one.
fn pair(node: &Node, name: &str, usual: usize, least: i64) -> Result<[usize; 2]> {
    match node.ints(name) {
        None => Ok([usual; 2]),
        Some(&[a, b]) if [a, b].iter().all(|v| (least..=LARGEST).contains(v)) => Ok([a as usize, b as usize]),
        Some(_) => Err("its window makes no sense".into()),
    }
}

impl Window {
    /// Over images of so many rows and columns.
    fn read(node: &Node, kernel: Option<[usize; 2]>, image: [usize; 2]) -> Result<Window> {
        let stated = pair(node, "kernel_shape", 0, 1)?;
        let kernel = kernel.unwrap_or(stated);
        if kernel.contains(&0) || kernel.iter().any(|side| *side > LARGEST as usize) || image.contains(&0) {
            return Err("its window makes no sense".into());
        }
        let mut window = Window {
            kernel,
            stride: pair(node, "strides", 1, 1)?,
            dilation: pair(node, "dilations", 1, 1)?,
            padding: [[0; 2]; 2],
            ceil: node.int("ceil_mode").unwrap_or(0) != 0,
        };
        window.padding = window.padding(node, image)?;
        Ok(window)
    }

    fn reach(&self, axis: usize) -> usize {
        (self.kernel[axis] - 1) * self.dilation[axis] + 1
    }

    fn padding(&self, node: &Node, image: [usize; 2]) -> Result<[[usize; 2]; 2]> {
        let same = |axis: usize| {
            let windows = image[axis].div_ceil(self.stride[axis]);
            let missing = ((windows - 1) * self.stride[axis] + self.reach(axis)).saturating_sub(image[axis]);
            [missing / 2, missing - missing / 2]
        };
        match (node.text("auto_pad").unwrap_or("NOTSET"), node.ints("pads")) {
            ("SAME_UPPER", _) => Ok([same(0), same(1)]),
            ("SAME_LOWER", _) => Ok([same(0), same(1)].map(|[less, more]| [more, less])),
            ("NOTSET", Some(pads @ &[top, left, bottom, right])) if pads.iter().all(|v| (0..=LARGEST).contains(v)) => {
                Ok([[top, bottom], [left, right]].map(|pair| pair.map(|v| v as usize)))
            }
            ("NOTSET", Some(_)) => Err("its border makes no sense".into()),
            _ => Ok([[0; 2]; 2]),
        }
    }

    /// Returns how many windows there are along an axis of so many numbers.
    fn count(&self, axis: usize, side: usize) -> Result<usize> {
        let [before, after] = self.padding[axis];
        let rest = (side + before + after).checked_sub(self.reach(axis));
        let rest = rest.ok_or("its window is larger than the image")?;
        if !self.ceil {
            return Ok(rest / self.stride[axis] + 1);
        }
        // The last window begins on the image or on the border before it.
        let count = rest.div_ceil(self.stride[axis]) + 1;
        let is_beyond = (count - 1) * self.stride[axis] >= side + before;
        Ok(if is_beyond { count - 1 } else { count })
    }

    fn windows(&self, channels: usize, image: [usize; 2]) -> Result<Windows> {
        let count = [self.count(0, image[0])?, self.count(1, image[1])?];
        bounded([channels, count[0], count[1]])?;
        let padded = |axis: usize| image[axis] + self.padding[axis][0] + self.padding[axis][1];
        bounded([channels, padded(0), padded(1)])?;
        Ok(self.on(channels, image, count))
    }

    /// Lays so many windows on an image.
    fn on(&self, channels: usize, image: [usize; 2], count: [usize; 2]) -> Windows {
        Windows {
            channels,
            image,
            kernel: self.kernel,
            stride: self.stride,
            dilation: self.dilation,
            before: self.padding.map(|[before, _]| before),
            count,
        }
    }

    /// Means of windows; of what lies on the image alone where the border does not count.
    fn average<T: Number>(&self, windows: &Windows, counts_border: bool) -> Separate<T> {
        let weights = [0, 1].map(|axis| {
            let (old, new) = (windows.image[axis], windows.count[axis]);
            let mut weights = vec![T::ZERO; new * old];
            for (at, row) in weights.chunks_exact_mut(old).enumerate() {
                let taps = 0..windows.kernel[axis];
                let places: Vec<usize> = taps.filter_map(|tap| windows.place(axis, at, tap)).collect();
                let end = old + self.padding[axis].iter().sum::<usize>();
                let in_border = (end - at * windows.stride[axis]).div_ceil(windows.dilation[axis]);
                let count = if counts_border {
                    windows.kernel[axis].min(in_border)
                } else {
                    places.len()
                };
                places.iter().for_each(|place| row[*place] = T::of(1.0 / count as f64));
            }
            weights
        });
        Separate::new(windows.channels, windows.image, weights)
    }
}

/// Weights of a convolution of several images: of each the same, as groups of their own.
fn weights<T: Number>(inputs: &Inputs<T>, images: usize, groups: usize, outputs: usize) -> Result<Weights<T>> {
    let repeated = |numbers: &[T]| numbers.repeat(images);
    let biases = match inputs.optional_floats(2)? {
        Some(_) => Some(inputs.known_floats(2)?),
        None => None,
    };
    bounded([images, inputs.term(1)?.count()])?;
    Ok(Weights {
        groups: groups * images,
        weights: repeated(inputs.known_floats(1)?),
        biases: biases.map(repeated),
        outputs: outputs * images,
    })
}

fn other_channels(wanted: usize, found: usize) -> Message {
    message!("it takes {wanted} channels and gets {found}")
}

fn groups(node: &Node) -> Result<usize> {
    let groups = usize::try_from(node.int("group").unwrap_or(1))
        .ok()
        .filter(|groups| *groups > 0);
    groups.ok_or("its groups make no sense".into())
}

fn convolution<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, [images, channels, rows, columns]) = inputs.planes(0)?;
    let (_, [outputs, per_group, kernel_rows, kernel_columns]) = inputs.planes(1)?;
    let groups = groups(node)?;
    if per_group.checked_mul(groups) != Some(channels) {
        return Err(other_channels(per_group.saturating_mul(groups), channels));
    }
    let biases = inputs.optional(2).map_or(outputs, Term::count);
    if !outputs.is_multiple_of(groups) || biases != outputs {
        return Err("its weights and biases do not go together".into());
    }
    let window = Window::read(node, Some([kernel_rows, kernel_columns]), [rows, columns])?;
    let windows = window.windows(images * channels, [rows, columns])?;
    let shape = vec![images, outputs, windows.count[0], windows.count[1]];
    bounded([per_group, kernel_rows, kernel_columns, windows.count[1]])?;
    let layer = layers::convolution(windows, weights(inputs, images, groups, outputs)?);
    graph.work(Work::Layer(layer.into()), &[x], shape)
}

fn transposed<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let (x, [images, channels, rows, columns]) = inputs.planes(0)?;
    let (_, [from, per_group, kernel_rows, kernel_columns]) = inputs.planes(1)?;
    let groups = groups(node)?;
    if from != channels || !channels.is_multiple_of(groups) {
        return Err(other_channels(from, channels));
    }
    let outputs = bounded([per_group, groups])?;
    if inputs.optional(2).map_or(outputs, Term::count) != outputs {
        return Err("its weights and biases do not go together".into());
    }
    let window = Window::read(node, Some([kernel_rows, kernel_columns]), [rows, columns])?;
    let more = pair(node, "output_padding", 0, 0)?;
    let side = |axis: usize, count: usize| {
        let whole = (count - 1) * window.stride[axis] + window.reach(axis) + more[axis];
        let side = whole
            .checked_sub(window.padding[axis].iter().sum())
            .filter(|side| *side > 0);
        side.ok_or(Message::from("its border is larger than the image"))
    };
    let image = [side(0, rows)?, side(1, columns)?];
    let shape = vec![images, outputs, image[0], image[1]];
    bounded(shape.iter().copied())?;
    bounded([per_group, kernel_rows, kernel_columns, columns])?;
    let windows = window.on(images * outputs, image, [rows, columns]);
    let layer = Transposed::new(windows, weights(inputs, images, groups, channels)?);
    graph.layer(layer, &[x], shape)
}

/// One number for each place of a window: the largest, or the mean, where `counts_border` says whether what lies beside the image counts.
fn pool<T: Number>(
    node: &Node,
    counts_border: Option<bool>,
    graph: &mut Graph<T>,
    inputs: &Inputs<T>,
) -> Result<Term<T>> {
    let (x, [images, channels, rows, columns]) = inputs.planes(0)?;
    let window = Window::read(node, None, [rows, columns])?;
    let windows = window.windows(images * channels, [rows, columns])?;
    let shape = vec![images, channels, windows.count[0], windows.count[1]];
    match counts_border {
        None => graph.layer(MaxPool(windows), &[x], shape),
        Some(counts_border) => graph.layer(window.average(&windows, counts_border), &[x], shape),
    }
}

/// Reduces each channel to one number.
fn global<T: Number>(graph: &mut Graph<T>, inputs: &Inputs<T>, summary: Summary) -> Result<Term<T>> {
    let (x, [images, channels, rows, columns]) = inputs.planes(0)?;
    let channels_in_line = x.shaped(vec![images, channels, rows * columns, 1])?;
    reduced(graph, &channels_in_line, 2, summary)
}

/// (x − mean) / √(variance + ε) · scale + shift, per channel, with the statistics of training.
fn batch_norm<T: Number>(node: &Node, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.floats(0)?;
    let mut shape = vec![1; x.shape.len().max(2)];
    shape[1] = *x.shape.get(1).ok_or_else(|| no_axis(x.shape.len(), 1))?;
    let per_channel = |i: usize| inputs.floats(i)?.shaped(shape.clone());
    let (scale, shift, mean, variance) = (per_channel(1)?, per_channel(2)?, per_channel(3)?, per_channel(4)?);
    let deviation = deviation(node, graph, &variance)?;
    let factor = of_two(graph, Operation::Quotient, &scale, &deviation)?;
    let of_mean = of_two(graph, Operation::Product, &mean, &factor)?;
    let offset = of_two(graph, Operation::Difference, &shift, &of_mean)?;
    let scaled = of_two(graph, Operation::Product, x, &factor)?;
    of_two(graph, Operation::Sum, &scaled, &offset)
}

pub(super) fn read<T: Number>(node: &Node) -> Option<Operator<'_, T>> {
    let is_single = node.outputs.len() == 1;
    match node.operator.as_str() {
        "Conv" => one(|graph, inputs| convolution(node, graph, inputs)),
        // Other paddings than the plain one have not been seen in detectors.
        "ConvTranspose"
            if matches!(node.text("auto_pad"), None | Some("NOTSET")) && node.ints("output_shape").is_none() =>
        {
            one(|graph, inputs| transposed(node, graph, inputs))
        }
        "MaxPool" if is_single => one(|graph, inputs| pool(node, None, graph, inputs)),
        "AveragePool" => {
            let counts_border = node.int("count_include_pad").unwrap_or(0) != 0;
            one(move |graph, inputs| pool(node, Some(counts_border), graph, inputs))
        }
        "GlobalAveragePool" => one(|graph, inputs| global(graph, inputs, Summary::Mean)),
        "GlobalMaxPool" => one(|graph, inputs| global(graph, inputs, Summary::Largest)),
        "BatchNormalization" if is_single => one(|graph, inputs| batch_norm(node, graph, inputs)),
        _ => None,
    }
}
