//! Resizing and padding inside the network.

use super::graph::Graph;
use super::operator::{Inputs, Operator, missing, one};
use super::term::{Result, Term, axes_of, bounded};
use super::view::View;
use crate::layers::{Number, Separate};
use scaleproof_core::message::{Message, message};
use scaleproof_detect::onnx_model::Node;

/// Rows and columns to another number, each by a map whose rows are the kernel's weights.
struct Resize<'a> {
    node: &'a Node,
    is_linear: bool,
    coordinates: &'a str,
    nearest: &'a str,
    /// Indices of the inputs with the scales and the sizes.
    inputs: [usize; 2],
}

impl<'a> Resize<'a> {
    fn read(node: &'a Node, opset: i64) -> Option<Resize<'a>> {
        let is_old = node.operator == "Upsample" || opset < 11;
        let number = |name: &str| node.int(name).unwrap_or(0);
        let is_plain = number("antialias") == 0 && number("exclude_outside") == 0;
        let stretches = matches!(node.text("keep_aspect_ratio_policy"), None | Some("stretch"));
        let is_linear = match node.text("mode").unwrap_or("nearest") {
            "nearest" => false,
            "linear" | "bilinear" => true,
            _ => return None,
        };
        let usual = if is_old { "asymmetric" } else { "half_pixel" };
        let coordinates = node.text("coordinate_transformation_mode").unwrap_or(usual);
        let is_known = coordinates != "tf_crop_and_resize" && node.ints("axes").is_none();
        (is_plain && stretches && is_known).then_some(Resize {
            node,
            is_linear,
            coordinates,
            nearest: node
                .text("nearest_mode")
                .unwrap_or(if is_old { "floor" } else { "round_prefer_floor" }),
            inputs: if is_old { [1, 3] } else { [2, 3] },
        })
    }

    /// New rows and columns, and by how much each is scaled.
    fn target<T: Number>(&self, old: [usize; 2], inputs: &Inputs<T>) -> Result<[(usize, f32); 2]> {
        let [scales, sizes] = self.inputs;
        let by_scale =
            |scales: [f32; 2]| std::array::from_fn(|i| ((old[i] as f32 * scales[i]).floor() as usize, scales[i]));
        let has_scales = inputs.optional(scales).is_some_and(|scales| scales.count() > 0);
        match (self.node.floats("scales"), has_scales) {
            (Some([.., y, x]), _) => Ok(by_scale([*y, *x])),
            (None, true) => match inputs.known_floats(scales)? {
                [.., y, x] => Ok(by_scale([y, x].map(|v| v.wide() as f32))),
                _ => Err("its scales are too few".into()),
            },
            (Some(_), _) => Err("its scales are too few".into()),
            (None, false) => match inputs.known(sizes)? {
                [.., y, x] => {
                    let sides = [y, x].map(|side| usize::try_from(*side).unwrap_or(0));
                    Ok(std::array::from_fn(|i| (sides[i], sides[i] as f32 / old[i] as f32)))
                }
                _ => Err("its sizes are too few".into()),
            },
        }
    }

    /// Returns which old index a new one looks at (ONNX: Resize, coordinate_transformation_mode).
    fn source(&self, at: usize, scale: f32, old: usize, new: usize) -> f32 {
        let at = at as f32;
        match self.coordinates {
            "asymmetric" => at / scale,
            "align_corners" if new > 1 => at * (old as f32 - 1.0) / (new as f32 - 1.0),
            "align_corners" => 0.0,
            "pytorch_half_pixel" if new <= 1 => 0.0,
            "tf_half_pixel_for_nn" => (at + 0.5) / scale,
            _ => (at + 0.5) / scale - 0.5,
        }
    }

    /// `new × old` weights, row-major.
    fn weights<T: Number>(&self, old: usize, new: usize, scale: f32) -> Vec<T> {
        let mut weights = vec![T::ZERO; new * old];
        for (at, row) in weights.chunks_exact_mut(old).enumerate() {
            let source = self.source(at, scale, old, new);
            if self.is_linear {
                let source = source.clamp(0.0, old as f32 - 1.0);
                let low = source.floor();
                row[low as usize] += T::of((1.0 - (source - low)).into());
                row[(low as usize + 1).min(old - 1)] += T::of((source - low).into());
            } else {
                let index = match self.nearest {
                    "round_prefer_ceil" => (source + 0.5).floor(),
                    "floor" => source.floor(),
                    "ceil" => source.ceil(),
                    _ => (source - 0.5).ceil(),
                };
                row[index.clamp(0.0, old as f32 - 1.0) as usize] = T::ONE;
            }
        }
        weights
    }

    fn run<T: Number>(&self, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
        let (x, [images, channels, rows, columns]) = inputs.planes(0)?;
        let [(new_rows, down), (new_columns, across)] = self.target([rows, columns], inputs)?;
        if new_rows == 0 || new_columns == 0 || rows == 0 || columns == 0 {
            return Err("it resizes to or from nothing".into());
        }
        bounded([images, channels, new_rows.max(rows), new_columns.max(columns)])?;
        bounded([new_rows, rows])?;
        bounded([new_columns, columns])?;
        let weights = [
            self.weights(rows, new_rows, down),
            self.weights(columns, new_columns, across),
        ];
        let layer = Separate::new(images * channels, [rows, columns], weights);
        graph.layer(layer, &[x], vec![images, channels, new_rows, new_columns])
    }
}

/// Numbers before and after along each axis. `pads`: all befores, then all afters, as ONNX writes them; of the named axes.
fn pairs(pads: &[i64], axes: &[usize], rank: usize) -> Result<Vec<[usize; 2]>> {
    if pads.len() != 2 * axes.len() {
        let (wanted, found) = (2 * axes.len(), pads.len());
        return Err(message!("it takes {wanted} paddings and gets {found}"));
    }
    let mut pairs = vec![[0, 0]; rank];
    let side = |by: i64| usize::try_from(by).map_err(|_| Message::from("it pads by less than nothing"));
    for (i, axis) in axes.iter().enumerate() {
        pairs[*axis] = [side(pads[i])?, side(pads[i + axes.len()])?];
    }
    Ok(pairs)
}

/// Returns which number along an axis of so many stands at a place that may lie beyond; `None` for a border of its own.
fn inside(at: i64, side: i64, mode: &str) -> Option<i64> {
    match mode {
        "edge" => Some(at.clamp(0, side - 1)),
        "reflect" if at < 0 => Some(-at),
        "reflect" if at >= side => Some(2 * (side - 1) - at),
        _ => (0..side).contains(&at).then_some(at),
    }
}

/// A border around a tensor.
fn pad<T: Number>(node: &Node, mode: &str, graph: &mut Graph<T>, inputs: &Inputs<T>) -> Result<Term<T>> {
    let x = inputs.floats(0)?;
    let pads = inputs.setting(node, "pads", 1)?.ok_or_else(|| missing(1))?;
    let axes = match inputs.optional(3) {
        Some(_) => axes_of(inputs.known(3)?, x.shape.len())?,
        None => (0..x.shape.len()).collect(),
    };
    let border = match (node.float("value"), inputs.optional(2)) {
        (Some(stated), _) => T::of(stated.into()),
        (None, Some(_)) => inputs.known_floats(2)?.first().copied().unwrap_or(T::ZERO),
        (None, None) => T::ZERO,
    };
    let pairs = pairs(pads, &axes, x.shape.len())?;
    let sides = x.shape.iter().zip(&pairs);
    bounded(sides.map(|(side, [before, after])| side.saturating_add(*before).saturating_add(*after)))?;
    // An axis after the other; what lies in the border stands after the numbers.
    let (mut view, beyond) = (View::of(&x.shape), x.count());
    for (axis, [before, after]) in pairs.into_iter().enumerate() {
        let side = view.shape[axis];
        if mode == "reflect" && before.max(after) >= side.max(1) {
            return Err("it reflects more than there is".into());
        }
        let places = -(before as i64)..(side + after) as i64;
        let places: Vec<Option<i64>> = places.map(|at| inside(at, side as i64, mode)).collect();
        view = view.bordered(axis, &places, beyond);
    }
    if view.at.len() == beyond {
        return Ok(x.clone());
    }
    let border = Term::floats(vec![1], vec![border]);
    graph.moved(&[x, &border], view.shape, &view.at)
}

pub(super) fn read<T: Number>(node: &Node, opset: i64) -> Option<Operator<'_, T>> {
    match node.operator.as_str() {
        "Resize" | "Upsample" => {
            let resize = Resize::read(node, opset)?;
            one(move |graph, inputs| resize.run(graph, inputs))
        }
        "Pad" => {
            let mode = node.text("mode").unwrap_or("constant");
            let is_known = matches!(mode, "constant" | "edge" | "reflect");
            is_known.then(|| one(move |graph, inputs| pad(node, mode, graph, inputs)))?
        }
        _ => None,
    }
}
