//! What every operator of a network can do. One file per group of operators makes them.

use std::sync::Arc;

use burn::tensor::Device;

use super::value::{Floats, Integers, Result, Value};
use crate::NetworkFault;
use crate::layers::{Layer, Moved};

type Run = dyn Fn(Inputs) -> Result<Vec<Value>> + Send + Sync;
pub(super) type MakeLayer = dyn Fn(&[Argument], &[usize]) -> Option<Box<dyn Layer>> + Send + Sync;

/// What is known of an input before there is an image.
// Most arguments are constants.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone)]
pub(super) enum Argument {
    Absent,
    Constant(Value),
    /// Its shape; its numbers follow from the image.
    Image(Vec<usize>),
}

impl Argument {
    pub(super) fn numbers(&self) -> Option<Vec<f32>> {
        match self {
            Argument::Constant(Value::Floats(v)) => v.values().ok(),
            _ => None,
        }
    }

    pub(super) fn image_shape(&self) -> Option<&[usize]> {
        match self {
            Argument::Image(shape) => Some(shape),
            _ => None,
        }
    }

    pub(super) fn constant(&self) -> Option<Value> {
        match self {
            Argument::Constant(value) => Some(value.clone()),
            _ => None,
        }
    }
}

/// An operator with its settings, its tensors not included.
#[derive(Clone)]
pub(super) struct Operator {
    /// The outputs for some inputs, in ONNX's order.
    pub run: Arc<Run>,
    /// Which inputs' numbers come out unchanged, only elsewhere.
    pub rearranged: Rearranged,
    pub is_sigmoid: bool,
    pub is_product: bool,
    /// Makes the layer on plain arrays that does the same, for the arguments and the output's shape; the layer's inputs are those arguments that
    /// follow from the image. `None` for arguments that it cannot do.
    pub layer: Option<Arc<MakeLayer>>,
    /// Whether its outputs follow from the inputs' shapes alone, whatever the numbers are.
    pub reads_shapes_only: bool,
}

impl Operator {
    pub(super) fn with_outputs(run: impl Fn(Inputs) -> Result<Vec<Value>> + Send + Sync + 'static) -> Operator {
        Operator {
            run: Arc::new(run),
            rearranged: Rearranged::Nothing,
            is_sigmoid: false,
            is_product: false,
            layer: None,
            reads_shapes_only: false,
        }
    }

    /// With one output.
    pub(super) fn new<V: Into<Value>>(run: impl Fn(Inputs) -> Result<V> + Send + Sync + 'static) -> Operator {
        Operator::with_outputs(move |inputs| Ok(vec![run(inputs)?.into()]))
    }

    /// With one output that has the first input's numbers.
    pub(super) fn moving<V: Into<Value>>(run: impl Fn(Inputs) -> Result<V> + Send + Sync + 'static) -> Operator {
        Operator::new(run).rearranging(Rearranged::First)
    }

    pub(super) fn with_layer(
        self,
        make: impl Fn(&[Argument], &[usize]) -> Option<Box<dyn Layer>> + Send + Sync + 'static,
    ) -> Operator {
        let layer: Option<Arc<MakeLayer>> = Some(Arc::new(make));
        Operator { layer, ..self }
    }

    /// The layers on plain arrays that do the same, one an output.
    pub(super) fn layers(
        &self,
        arguments: &[Argument],
        shapes: &[Vec<usize>],
        device: &Device,
    ) -> Option<Vec<Box<dyn Layer>>> {
        match (&self.layer, shapes) {
            (Some(make), [shape]) => Some(vec![make(arguments, shape)?]),
            _ => self.moved(arguments, device),
        }
    }

    /// Where the numbers of a rearrangement go is seen by rearranging their indices.
    fn moved(&self, arguments: &[Argument], device: &Device) -> Option<Vec<Box<dyn Layer>>> {
        if matches!(self.rearranged, Rearranged::Nothing | Rearranged::Ordered) {
            return None;
        }
        let moved = self.moved_inputs(arguments.len());
        let (mut values, mut counts) = (Vec::new(), Vec::new());
        for (i, argument) in arguments.iter().enumerate() {
            values.push(match argument {
                Argument::Absent => None,
                Argument::Constant(value) if i >= moved => Some(value.clone()),
                Argument::Image(shape) if i < moved => {
                    let (first, count) = (counts.iter().sum::<usize>(), shape.iter().product::<usize>());
                    counts.push(count);
                    let indices = (first..first + count).map(|index| index as f32).collect();
                    Some(Value::Floats(Floats::new(indices, shape, device).ok()?))
                }
                _ => return None,
            });
        }
        if counts.iter().sum::<usize>() > MOST_INDICES {
            return None;
        }
        let outputs = (self.run)(Inputs { values, device }).ok()?;
        let layer = |output: &Value| -> Option<Box<dyn Layer>> {
            let Value::Floats(indices) = output else { return None };
            let indices: Vec<usize> = indices.values().ok()?.into_iter().map(|index| index as usize).collect();
            Some(Box::new(Moved::new(counts.clone(), &indices)))
        };
        outputs.iter().map(layer).collect()
    }

    /// How many of its inputs it moves, of so many.
    pub(super) fn moved_inputs(&self, inputs: usize) -> usize {
        match self.rearranged {
            Rearranged::Nothing => 0,
            Rearranged::All => inputs,
            Rearranged::First | Rearranged::Ordered => 1,
        }
    }

    pub(super) fn rearranging(self, rearranged: Rearranged) -> Operator {
        Operator { rearranged, ..self }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rearranged {
    Nothing,
    /// The first input's; the others say where to.
    First,
    /// The first input's, as their own order has it; the second output says where they lay.
    Ordered,
    All,
}

/// Larger whole numbers are not all among those of 32 bits.
const MOST_INDICES: usize = 1 << 24;

pub(super) struct Inputs<'a> {
    /// Those left out are `None`.
    pub values: Vec<Option<Value>>,
    pub device: &'a Device,
}

impl Inputs<'_> {
    /// How many there are, those left out at the end not counted.
    pub(super) fn count(&self) -> usize {
        self.values.iter().rposition(Option::is_some).map_or(0, |last| last + 1)
    }

    pub(super) fn value(&mut self, i: usize) -> Result<Value> {
        let value = self.values.get_mut(i).and_then(Option::take);
        value.ok_or(NetworkFault::MissingInput(i))
    }

    pub(super) fn floats(&mut self, i: usize) -> Result<Floats> {
        self.optional_floats(i)?.ok_or(NetworkFault::MissingInput(i))
    }

    pub(super) fn optional_floats(&mut self, i: usize) -> Result<Option<Floats>> {
        match self.values.get_mut(i).and_then(Option::take) {
            Some(Value::Floats(v)) => Ok(Some(v)),
            Some(Value::Integers(_)) => Err(NetworkFault::WholeInput(i)),
            None => Ok(None),
        }
    }

    pub(super) fn whole(&self, i: usize) -> Result<&Integers> {
        match self.values.get(i) {
            Some(Some(Value::Integers(v))) => Ok(v),
            Some(Some(Value::Floats(_))) => Err(NetworkFault::FractionInput(i)),
            _ => Err(NetworkFault::MissingInput(i)),
        }
    }
}

/// Settings that older files state and newer ones compute.
#[derive(Debug, Clone)]
pub(super) enum IntegerSetting {
    Known(Vec<i64>),
    Input(usize),
}

impl IntegerSetting {
    pub(super) fn known<T: Copy + TryInto<i64>>(values: &[T]) -> IntegerSetting {
        IntegerSetting::Known(values.iter().map(|v| (*v).try_into().unwrap_or(i64::MAX)).collect())
    }

    pub(super) fn values(&self, inputs: &Inputs) -> Result<Vec<i64>> {
        match self {
            IntegerSetting::Known(values) => Ok(values.clone()),
            IntegerSetting::Input(i) => Ok(inputs.whole(*i)?.data.clone()),
        }
    }

    /// The values of a setting that may be left out.
    pub(super) fn optional(setting: &Option<IntegerSetting>, inputs: &Inputs) -> Result<Option<Vec<i64>>> {
        setting.as_ref().map(|setting| setting.values(inputs)).transpose()
    }
}

/// The setting in one of the parser's types, which are alike.
macro_rules! setting {
    ($kind:ident, $written:expr) => {
        match $written {
            $kind::Static(v) => IntegerSetting::known(v),
            $kind::Runtime(r) => IntegerSetting::Input(r.input_index),
        }
    };
}
pub(super) use setting;

/// An axis that may count from the end.
pub(super) fn axis_of(axis: i64, rank: usize) -> Result<usize> {
    let from_start = usize::try_from(if axis < 0 { axis + rank as i64 } else { axis });
    let axis_there = from_start.ok().filter(|a| *a < rank);
    axis_there.ok_or(NetworkFault::NoAxis(rank, axis))
}

/// Several axes that may count from the end.
pub(super) fn axes_of(axes: &[i64], rank: usize) -> Result<Vec<usize>> {
    axes.iter().map(|axis| axis_of(*axis, rank)).collect()
}
