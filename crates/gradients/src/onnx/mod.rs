//! ONNX files as differentiable networks.
//!
//! Each node of a file becomes one of our own operators (`operator`), one file a group, and these become layers on plain arrays (`graph`). All
//! shapes are fixed when a file is opened, for one image: what does not depend on the image is then a constant. Weights carry no gradient.

mod arithmetic; // two tensors, number by number
mod choice; // the largest numbers, numbers at indices, samples on a grid
mod combine; // softmax, sums, products of matrices
mod convolution; // convolution, pooling, normalisation
mod elementwise; // each number by itself
mod graph; // a network while it is read
mod logits; // the numbers before the last sigmoids
mod operator; // inputs and outputs of operators
mod read; // nodes of a file as operators
mod rearrange; // reshape, transpose, slice, concatenate
mod resize; // resizing and padding
mod run; // a network as it is run
mod shapes; // operators that compute shapes
mod term; // tensors while a network is read
mod view; // tensors turned, cut or repeated

use crate::layers::tape::Tape;
use run::Plan;
use scaleproof_detect::onnx_model::Model;
use term::{NEVER_COMPUTED, Numbers, Term, Value};

use crate::WhiteBoxError;
use crate::layers::Number;
use scaleproof_core::message::{Message, message};

/// Computes in 32 bits, or in 64 to see what rounding does.
pub struct OnnxNetwork<T = f32> {
    file: String,
    plan: Plan<T>,
    outputs: Vec<NamedOutput<T>>,
    count: usize,
}

struct NamedOutput<T> {
    name: String,
    term: Term<T>,
    /// As long as the output's numbers, or nothing where none is a logit.
    is_logit: Vec<bool>,
}

/// One output tensor, row-major.
#[derive(Debug, Clone)]
pub struct Output {
    pub name: String,
    pub shape: Vec<usize>,
    /// Numbers; where [`Output::is_logit`] says so, logits of the sigmoid that the file ends in.
    pub raw: Vec<f32>,
    pub is_logit: Vec<bool>,
    pub is_whole: bool,
}

impl Output {
    fn new<T: Number>(output: &NamedOutput<T>, numbers: &Numbers<T>) -> Output {
        let raw: Vec<f32> = match numbers {
            Numbers::Floats(v) => v.iter().map(|v| v.wide() as f32).collect(),
            Numbers::Whole(v) => v.iter().map(|v| *v as f32).collect(),
        };
        let mut is_logit = output.is_logit.clone();
        is_logit.resize(raw.len(), false);
        Output {
            name: output.name.clone(),
            shape: output.term.shape.clone(),
            raw,
            is_logit,
            is_whole: output.term.is_whole(),
        }
    }

    pub fn values(&self) -> Vec<f32> {
        let both = self.raw.iter().zip(&self.is_logit);
        both.map(|(raw, is_logit)| if *is_logit { 1.0 / (1.0 + (-raw).exp()) } else { *raw })
            .collect()
    }
}

/// The outputs for one image, with the backward pass from them.
pub struct NetworkPass<'a, T = f32> {
    pub outputs: Vec<Output>,
    network: &'a OnnxNetwork<T>,
    tape: Tape<'a, T>,
}

impl<T: Number> OnnxNetwork<T> {
    /// Reads an ONNX file's bytes for images of this shape, such as [1, 3, 416, 416]; `file` is only named in errors. `photo_size`
    /// is for a network whose second input is the photo's width and height.
    pub fn read(
        bytes: &[u8],
        file: &str,
        shape: &[usize],
        photo_size: Option<[u32; 2]>,
    ) -> Result<Self, WhiteBoxError> {
        let refused = |reason: Message| message!("{file} cannot be differentiated: {reason}");
        let model = Model::read(bytes).map_err(refused)?;
        let operators = read::operators(&model, file)?;
        let (mut graph, mut terms) = read::graph(&model, &operators, shape, photo_size).map_err(refused)?;
        let logits = logits::expose_logits(&mut graph, &mut terms);
        let read = terms.iter().filter_map(Term::slot);
        let outputs = model.outputs.iter().zip(&terms).zip(logits);
        Ok(OnnxNetwork {
            file: file.to_owned(),
            outputs: outputs
                .map(|((name, term), is_logit)| NamedOutput {
                    name: name.clone(),
                    term: term.clone(),
                    is_logit,
                })
                .collect(),
            count: graph.counts[0],
            plan: Plan::new(graph.steps, graph.constants, graph.counts.len(), read),
        })
    }

    /// The outputs for an image's numbers, row-major. With `keeps_way` what [`NetworkPass::vjp`] needs stays in memory.
    pub fn forward(&self, image: Vec<f32>, keeps_way: bool) -> Result<NetworkPass<'_, T>, WhiteBoxError> {
        let failed = |reason: Message| message!("{} failed: {reason}", self.file);
        let (count, found) = (self.count, image.len());
        if found != count {
            return Err(failed(message!("it takes {count} numbers and gets {found}")).into());
        }
        let image = image.into_iter().map(|v| T::of(v.into())).collect();
        let (values, tape) = self.plan.run(image, keeps_way).map_err(failed)?;
        let output = |output: &NamedOutput<T>| -> Result<Output, Message> {
            let numbers = match &output.term.value {
                Value::Constant(numbers) => Some(numbers),
                Value::Image(slot, _) => values[*slot].as_ref(),
            };
            let numbers = numbers.ok_or_else(|| failed(NEVER_COMPUTED.into()))?;
            Ok(Output::new(output, numbers))
        };
        Ok(NetworkPass {
            outputs: self.outputs.iter().map(output).collect::<Result<_, _>>()?,
            network: self,
            tape,
        })
    }
}

impl<T: Number> NetworkPass<'_, T> {
    /// The derivative of `Σ derivative · raw` with respect to the image's numbers: one derivative for each number of each output.
    pub fn vjp(self, derivatives: Vec<Vec<f32>>) -> Vec<f32> {
        let outputs = self.network.outputs.iter().zip(derivatives);
        let followed = outputs.filter_map(|(output, derivative)| {
            let numbers = derivative.into_iter().map(|d| T::of(d.into())).collect();
            Some((output.term.slot()?, numbers))
        });
        match self.network.plan.back(self.tape, followed) {
            Some(gradient) => gradient.into_iter().map(|g| g.wide() as f32).collect(),
            None => vec![0.0; self.network.count],
        }
    }
}
