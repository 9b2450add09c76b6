//! Darknet's layers as ONNX nodes.

use super::cfg::Section;
use super::weights::Weights;
use crate::onnx::{Attribute, GraphWriter};

/// The output of a layer: the name of its tensor 1×c×h×w.
#[derive(Debug, Clone)]
struct Layer {
    name: String,
    /// Channels, rows, columns.
    shape: [usize; 3],
}

pub(super) struct Converter {
    graph: GraphWriter,
    input: [usize; 3],
    layers: Vec<Layer>,
    /// The tables of decoded boxes 1×n×row: name, n, row.
    tables: Vec<(String, usize, usize)>,
}

type Result<T> = std::result::Result<T, String>;

/// No layer of a network has more numbers.
const MOST_NUMBERS: usize = 1 << 28;

/// An image of 8192 px in cells of 8.
const MOST_CELLS: usize = 1 << 20;

/// Number that Darknet adds to a variance (`normalize_cpu`).
const LEAST_VARIANCE: f32 = 1e-5;

impl Converter {
    pub(super) fn new(net: &Section) -> Result<Converter> {
        let side = |key: &str| net.number(key, 0_usize);
        let input = [net.number("channels", 3)?, side("height")?, side("width")?];
        if input[0] != 3 || !input[1..].iter().all(|side| (32..=8192).contains(side)) {
            return Err(format!(
                "[net] is for images of {input:?} (channels, height, width): 3 channels and sides of 32 to 8192 are read"
            ));
        }
        if net.number("letter_box", 0)? != 0 {
            return Err(
                "letter_box pads the photo, which no network says of itself: set it to 0 here, and resize = \"letterbox_centre\" and pad = 127 under [input] in the \
                 manifest that is then written"
                    .to_owned(),
            );
        }
        Ok(Converter {
            graph: GraphWriter::default(),
            input,
            layers: Vec::new(),
            tables: Vec::new(),
        })
    }

    pub(super) fn add(&mut self, section: &Section, weights: &mut Weights) -> Result<()> {
        let last = self.last();
        let layer = match section.kind.as_str() {
            "convolutional" | "conv" => self.convolution(section, weights)?,
            "maxpool" | "max" => self.maxpool(section)?,
            "avgpool" | "avg" => {
                let name = self.graph.node("GlobalAveragePool", &[&last.name], &[]);
                let shape = [last.shape[0], 1, 1];
                Layer { name, shape }
            }
            "upsample" => self.upsample(section)?,
            "route" => self.route(section)?,
            "shortcut" => self.shortcut(section)?,
            "scale_channels" | "sam" => self.scaled(section)?,
            // Nothing is dropped once a network is trained.
            "dropout" => last,
            "yolo" => self.yolo(section)?,
            other => {
                return Err(format!(
                    "[{other}] is not read here (convolutional, maxpool, avgpool, upsample, route, shortcut, scale_channels, sam, dropout and yolo \
                     are): convert the network to ONNX with another program"
                ));
            }
        };
        if layer
            .shape
            .iter()
            .try_fold(1_usize, |all, side| all.checked_mul(*side))
            .is_none_or(|all| all > MOST_NUMBERS)
        {
            return Err(format!(
                "[{}] would have {:?} numbers: is it a Darknet configuration?",
                section.kind, layer.shape
            ));
        }
        self.layers.push(layer);
        Ok(())
    }

    fn last(&self) -> Layer {
        self.layers.last().cloned().unwrap_or(Layer {
            name: "images".to_owned(),
            shape: self.input,
        })
    }

    /// A layer by Darknet's number: below 0 counted back from the one that asks.
    fn layer(&self, number: i64) -> Result<Layer> {
        let at = if number < 0 {
            self.layers.len() as i64 + number
        } else {
            number
        };
        let found = usize::try_from(at).ok().and_then(|at| self.layers.get(at));
        found
            .cloned()
            .ok_or_else(|| format!("it names layer {number}, and {} come before it", self.layers.len()))
    }

    fn convolution(&mut self, section: &Section, weights: &mut Weights) -> Result<Layer> {
        section.refuse(&[
            "binary",
            "xnor",
            "deform",
            "antialiasing",
            "assisted_excitation",
            "share_index",
            "rotate",
            "stretch",
            "sway",
            "flipped",
        ])?;
        let Layer {
            name,
            shape: [channels, rows, columns],
        } = self.last();
        let filters: usize = section.number("filters", 1)?;
        let side: usize = section.number("size", 1)?;
        let stride: usize = section.number("stride", 1)?;
        let strides = [section.number("stride_y", stride)?, section.number("stride_x", stride)?];
        let groups: usize = section.number("groups", 1)?;
        let is_padded = section.number("pad", 0)? != 0;
        let padding: usize = if is_padded {
            side / 2
        } else {
            section.number("padding", 0)?
        };
        let sides = [rows, columns].map(|side| side.saturating_add(2 * padding.min(1 << 16)));
        let is_possible = [filters, side, groups, strides[0], strides[1]]
            .iter()
            .all(|v| (1..=1 << 16).contains(v));
        if !is_possible
            || !channels.is_multiple_of(groups)
            || !filters.is_multiple_of(groups)
            || sides.iter().any(|room| *room < side)
        {
            return Err(format!(
                "[convolutional] cannot be laid over {channels}×{rows}×{columns} numbers: size {side}, stride {strides:?}, groups {groups}"
            ));
        }
        if section.number("dilation", 1)? != 1 {
            return Err("[convolutional] has a dilation, which is not read here".to_owned());
        }
        let each = channels / groups * side * side;
        if each.saturating_mul(filters) > MOST_NUMBERS {
            return Err(format!(
                "[convolutional] would have {filters} filters of {each} numbers"
            ));
        }
        let [rows, columns] = [0, 1].map(|axis| (sides[axis] - side) / strides[axis] + 1);
        let shape = [filters, rows, columns];
        let bias = weights.take(filters);
        let normalised = (section.number("batch_normalize", 0)? != 0).then(|| [(); 3].map(|()| weights.take(filters)));
        let kernel = weights.take(each * filters);
        // What the weights lack is counted to the end, and makes no network.
        let (Some(mut bias), Some(mut kernel)) = (bias, kernel) else {
            return Ok(Layer { name, shape });
        };
        if let Some([Some(scale), Some(mean), Some(variance)]) = normalised {
            for (i, kernel) in kernel.chunks_exact_mut(each).enumerate() {
                let by = scale[i] / (variance[i] + LEAST_VARIANCE).sqrt();
                kernel.iter_mut().for_each(|v| *v *= by);
                bias[i] -= mean[i] * by;
            }
        }
        let kernel = self.graph.floats(&[filters, channels / groups, side, side], &kernel);
        let bias = self.graph.floats(&[filters], &bias);
        let pad = padding as i64;
        let attributes = [
            ("kernel_shape", Attribute::Ints(&[side as i64; 2])),
            ("strides", Attribute::Ints(&strides.map(|v| v as i64))),
            ("pads", Attribute::Ints(&[pad; 4])),
            ("group", Attribute::Int(groups as i64)),
        ];
        let name = self.graph.node("Conv", &[&name, &kernel, &bias], &attributes);
        Ok(Layer {
            name: self.activated(section, name, "logistic")?,
            shape,
        })
    }

    /// The layer after its activation; Darknet's own choice is `otherwise`.
    fn activated(&mut self, section: &Section, name: String, otherwise: &str) -> Result<String> {
        let graph = &mut self.graph;
        Ok(match section.text("activation").unwrap_or(otherwise) {
            "linear" => name,
            "leaky" => graph.node("LeakyRelu", &[&name], &[("alpha", Attribute::Float(0.1))]),
            "relu" => graph.node("Relu", &[&name], &[]),
            "relu6" => {
                let ends = [0.0, 6.0].map(|end| graph.floats(&[], &[end]));
                graph.node("Clip", &[&name, &ends[0], &ends[1]], &[])
            }
            "logistic" => graph.node("Sigmoid", &[&name], &[]),
            "tanh" => graph.node("Tanh", &[&name], &[]),
            "swish" | "silu" => {
                let share = graph.node("Sigmoid", &[&name], &[]);
                graph.node("Mul", &[&name, &share], &[])
            }
            "mish" => {
                let soft = graph.node("Softplus", &[&name], &[]);
                let share = graph.node("Tanh", &[&soft], &[]);
                graph.node("Mul", &[&name, &share], &[])
            }
            other => {
                return Err(format!(
                    "[{}] has activation={other}, which is not read here",
                    section.kind
                ));
            }
        })
    }

    /// Darknet pads below and to the right first.
    fn maxpool(&mut self, section: &Section) -> Result<Layer> {
        section.refuse(&["maxpool_depth", "antialiasing"])?;
        let Layer {
            name,
            shape: [channels, rows, columns],
        } = self.last();
        let stride: usize = section.number("stride", 1)?;
        let strides = [section.number("stride_y", stride)?, section.number("stride_x", stride)?];
        let side: usize = section.number("size", stride)?;
        let padding: usize = section.number("padding", side.saturating_sub(1))?;
        let is_possible =
            [side, strides[0], strides[1]].iter().all(|v| (1..=1 << 12).contains(v)) && padding < 2 * side;
        if !is_possible || rows + padding < side || columns + padding < side {
            return Err(format!(
                "[maxpool] of size {side} cannot be laid over {rows}×{columns} numbers"
            ));
        }
        let [before, after] = [padding / 2, padding - padding / 2].map(|v| v as i64);
        let attributes = [
            ("kernel_shape", Attribute::Ints(&[side as i64; 2])),
            ("strides", Attribute::Ints(&strides.map(|v| v as i64))),
            ("pads", Attribute::Ints(&[before, before, after, after])),
        ];
        let name = self.graph.node("MaxPool", &[&name], &attributes);
        let [rows, columns] =
            [(rows, 0), (columns, 1)].map(|(side_in, axis)| (side_in + padding - side) / strides[axis] + 1);
        Ok(Layer {
            name,
            shape: [channels, rows, columns],
        })
    }

    fn upsample(&mut self, section: &Section) -> Result<Layer> {
        let Layer {
            name,
            shape: [channels, rows, columns],
        } = self.last();
        let stride: usize = section.number("stride", 2)?;
        if !(1..=64).contains(&stride) || section.number("scale", 1.0_f32)? != 1.0 {
            return Err(format!(
                "[upsample] has stride={stride}: 1 to 64 without a scale is read"
            ));
        }
        let by = stride as f32;
        let scales = self.graph.floats(&[4], &[1.0, 1.0, by, by]);
        let attributes = [
            ("mode", Attribute::Text("nearest")),
            ("coordinate_transformation_mode", Attribute::Text("asymmetric")),
            ("nearest_mode", Attribute::Text("floor")),
        ];
        let name = self.graph.node("Resize", &[&name, "", &scales], &attributes);
        Ok(Layer {
            name,
            shape: [channels, rows * stride, columns * stride],
        })
    }

    fn route(&mut self, section: &Section) -> Result<Layer> {
        let named: Vec<i64> = section.numbers("layers")?;
        let layers = named
            .iter()
            .map(|number| self.layer(*number))
            .collect::<Result<Vec<Layer>>>()?;
        let (groups, group): (usize, usize) = (section.number("groups", 1)?, section.number("group_id", 0)?);
        let Some(first) = layers.first() else {
            return Err("[route] names no layers".to_owned());
        };
        let [_, rows, columns] = first.shape;
        let are_alike = layers.iter().all(|layer| layer.shape[1..] == [rows, columns]);
        if !are_alike
            || groups == 0
            || group >= groups
            || layers.iter().any(|layer| !layer.shape[0].is_multiple_of(groups))
        {
            let shapes: Vec<_> = layers.iter().map(|layer| layer.shape).collect();
            return Err(format!(
                "[route] cannot join {shapes:?} (channels, rows, columns) in {groups} groups"
            ));
        }
        let mut names = Vec::new();
        for layer in &layers {
            let part = layer.shape[0] / groups;
            names.push(if groups == 1 {
                layer.name.clone()
            } else {
                let ends = [group * part, (group + 1) * part].map(|end| self.graph.whole(&[end as i64]));
                let axis = self.graph.whole(&[1]);
                self.graph.node("Slice", &[&layer.name, &ends[0], &ends[1], &axis], &[])
            });
        }
        let channels = layers.iter().map(|layer| layer.shape[0] / groups).sum();
        let name = match &names[..] {
            [only] => only.clone(),
            all => {
                let all: Vec<&str> = all.iter().map(String::as_str).collect();
                self.graph.node("Concat", &all, &[("axis", Attribute::Int(1))])
            }
        };
        Ok(Layer {
            name,
            shape: [channels, rows, columns],
        })
    }

    fn shortcut(&mut self, section: &Section) -> Result<Layer> {
        section.refuse(&["weights_type", "weights_normalization"])?;
        let mut sum = self.last();
        for number in section.numbers("from")? {
            let other = self.layer(number)?;
            if other.shape != sum.shape {
                return Err(format!(
                    "[shortcut] cannot add {:?} to {:?} (channels, rows, columns)",
                    other.shape, sum.shape
                ));
            }
            sum.name = self.graph.node("Add", &[&sum.name, &other.name], &[]);
        }
        Ok(Layer {
            name: self.activated(section, sum.name, "linear")?,
            shape: sum.shape,
        })
    }

    /// Another layer times the last one, number by number, or channel by channel where the last has one number each.
    fn scaled(&mut self, section: &Section) -> Result<Layer> {
        section.refuse(&["scale_wh"])?;
        let (last, other) = (self.last(), self.layer(section.number("from", -1)?)?);
        let is_of_channels = last.shape == [other.shape[0], 1, 1];
        if last.shape != other.shape && !is_of_channels {
            return Err(format!(
                "[{}] cannot multiply {:?} by {:?}",
                section.kind, other.shape, last.shape
            ));
        }
        let name = self.graph.node("Mul", &[&other.name, &last.name], &[]);
        Ok(Layer {
            name: self.activated(section, name, "linear")?,
            shape: other.shape,
        })
    }

    /// Decodes a grid into rows of centre and size in pixels of the input, objectness and labels.
    fn yolo(&mut self, section: &Section) -> Result<Layer> {
        let last = self.last();
        let [channels, rows, columns] = last.shape;
        let classes: usize = section.number("classes", 20)?;
        let all: Vec<f32> = section.numbers("anchors")?;
        let mask: Vec<usize> = section.numbers("mask")?;
        let mask = if section.text("mask").is_some() {
            mask
        } else {
            (0..all.len() / 2).collect()
        };
        let own = mask.iter().map(|i| all.get(2 * i..2 * i + 2));
        let Some(own) = own.collect::<Option<Vec<&[f32]>>>().filter(|own| !own.is_empty()) else {
            return Err(format!("[yolo] has mask={mask:?}, and {} anchors", all.len() / 2));
        };
        let (count, row) = (own.len(), classes.saturating_add(5));
        if rows.saturating_mul(columns) > MOST_CELLS {
            return Err(format!(
                "[yolo] has {rows} × {columns} cells: is it a Darknet configuration?"
            ));
        }
        if count.checked_mul(row) != Some(channels)
            || !self.input[1].is_multiple_of(rows)
            || !self.input[2].is_multiple_of(columns)
        {
            return Err(format!(
                "[yolo] of {count} anchors and {classes} classes needs {} channels in whole cells, and {channels}×{rows}×{columns} come in",
                count.saturating_mul(row)
            ));
        }
        let s: f32 = section.number("scale_x_y", 1.0)?;
        let is_new = section.number("new_coords", 0)? != 0;
        let graph = &mut self.graph;
        let shape = graph.whole(&[1, count as i64, row as i64, rows as i64, columns as i64]);
        let split = graph.node("Reshape", &[&last.name, &shape], &[]);
        let rowwise = graph.node("Transpose", &[&split], &[("perm", Attribute::Ints(&[0, 1, 3, 4, 2]))]);
        let part = |graph: &mut GraphWriter, from: i64, to: i64| {
            let [from, to, axis] = [from, to, 4].map(|v| graph.whole(&[v]));
            graph.node("Slice", &[&rowwise, &from, &to, &axis], &[])
        };
        let parts = [(0, 2), (2, 4), (4, row as i64)].map(|(from, to)| part(graph, from, to));
        // With new coordinates the convolution before has the sigmoid.
        let [centre, side, scores] = if is_new {
            parts
        } else {
            let [centre, side, scores] = parts;
            [("Sigmoid", centre), ("Exp", side), ("Sigmoid", scores)]
                .map(|(operator, of)| graph.node(operator, &[&of], &[]))
        };
        let stride = [self.input[2] / columns, self.input[1] / rows].map(|v| v as f32);
        let cells = (0..rows * columns).flat_map(|i| [i % columns, i / columns]);
        let corners: Vec<f32> = cells
            .enumerate()
            .map(|(i, cell)| (cell as f32 - (s - 1.0) / 2.0) * stride[i % 2])
            .collect();
        let [scale, corner] = [
            (&[1, 1, 1, 1, 2], &stride.map(|v| v * s)[..]),
            (&[1, 1, rows, columns, 2], &corners),
        ]
        .map(|(shape, v)| graph.floats(shape, v));
        let scaled = graph.node("Mul", &[&centre, &scale], &[]);
        let centre = graph.node("Add", &[&scaled, &corner], &[]);
        // (2 v)² of an anchor.
        let (side, times) = if is_new {
            (graph.node("Mul", &[&side, &side], &[]), 4.0)
        } else {
            (side, 1.0)
        };
        let anchors: Vec<f32> = own.concat().iter().map(|v| v * times).collect();
        let anchors = graph.floats(&[1, count, 1, 1, 2], &anchors);
        let side = graph.node("Mul", &[&side, &anchors], &[]);
        let joined = graph.node("Concat", &[&centre, &side, &scores], &[("axis", Attribute::Int(4))]);
        let shape = graph.whole(&[1, -1, row as i64]);
        let table = graph.node("Reshape", &[&joined, &shape], &[]);
        self.tables.push((table, count * rows * columns, row));
        Ok(last)
    }

    pub(super) fn finish(mut self) -> Result<Vec<u8>> {
        let Some((_, _, row)) = self.tables.first().cloned() else {
            return Err("it has no [yolo]: only detectors of the YOLOv3 line are read".to_owned());
        };
        if self.tables.iter().any(|table| table.2 != row) {
            return Err("its [yolo] layers have different classes".to_owned());
        }
        let all: Vec<&str> = self.tables.iter().map(|table| table.0.as_str()).collect();
        let output = self.graph.node("Concat", &all, &[("axis", Attribute::Int(1))]);
        let rows = self.tables.iter().map(|table| table.1).sum();
        let [channels, height, width] = self.input;
        let image = [1, channels, height, width];
        Ok(self.graph.finish(
            ["scaleproof", "darknet"],
            ("images", &image),
            (&output, &[1, rows, row]),
        ))
    }
}
