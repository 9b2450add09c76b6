//! ONNX files as differentiable networks.
//!
//! `onnx-ir` parses the file; each of its nodes becomes one of our own operators (`operator`) on the tensors of `burn`, one file a group. All
//! shapes are fixed when a file is opened, for one image: what does not depend on the image is then a constant. Weights carry no gradient.
//! On a processor most operators become layers on plain arrays (`plan`), which take a fraction of the time.

mod arithmetic;
mod choice;
mod combine;
mod convolution;
mod elementwise;
mod graph;
mod logits;
mod operator;
mod part;
mod plan;
mod read;
mod rearrange;
mod resize;
mod shapes;
mod value;

use burn::tensor::{Device, Tensor, TensorData};

use graph::Graph;
use part::Back;
use plan::Plan;
use value::{Floats, Held, Value, full};

use crate::network::quietly::quietly;
use crate::{NetworkFault, WhiteBoxError};

pub struct OnnxNetwork {
    file: String,
    plan: Plan,
    outputs: Vec<String>,
    count: usize,
    logits: Vec<Vec<bool>>,
}

/// One output tensor, row-major.
#[derive(Debug, Clone)]
pub struct Output {
    pub name: String,
    pub shape: Vec<usize>,
    /// Where [`Output::is_logit`] says so, the logit of the sigmoid that the file ends in.
    pub raw: Vec<f32>,
    pub is_logit: Vec<bool>,
    pub is_whole: bool,
}

impl Output {
    fn new(value: Held, mut is_logit: Vec<bool>, name: String) -> Output {
        let (shape, raw, is_whole) = match value {
            Held::Floats { shape, numbers } => (shape, numbers.to_vec(), false),
            Held::Whole(v) => (v.shape, v.data.iter().map(|v| *v as f32).collect(), true),
        };
        is_logit.resize(raw.len(), false);
        Output {
            name,
            shape,
            raw,
            is_logit,
            is_whole,
        }
    }

    pub fn values(&self) -> Vec<f32> {
        let sigmoid = |z: f32| 1.0 / (1.0 + (-z).exp());
        let both = self.raw.iter().zip(&self.is_logit);
        both.map(|(raw, is_logit)| if *is_logit { sigmoid(*raw) } else { *raw })
            .collect()
    }
}

/// The outputs for one image, with the backward pass from them.
pub struct NetworkPass<'a> {
    pub outputs: Vec<Output>,
    network: &'a OnnxNetwork,
    tape: Vec<Back<'a>>,
}

impl OnnxNetwork {
    /// Reads an ONNX file's bytes for images of this shape, such as [1, 3, 416, 416]; `file` is only named in errors. `photo_size`
    /// is for a network whose second input is the photo's width and height.
    pub fn read(
        bytes: &[u8],
        file: &str,
        shape: &[usize],
        photo_size: Option<[u32; 2]>,
        device: &Device,
    ) -> Result<OnnxNetwork, WhiteBoxError> {
        let refused = |reason: NetworkFault| {
            let file = file.to_owned();
            WhiteBoxError::OnnxNetwork { file, reason }
        };
        // The parser and the tensors panic on graphs whose parts do not go together.
        let network = quietly(|| {
            let mut graph = read::read(bytes, file, photo_size, &device.clone().autodiff())?;
            let (plan, logits) = planned(&mut graph, shape).map_err(refused)?;
            Ok(OnnxNetwork {
                file: file.to_owned(),
                plan,
                outputs: graph.outputs.into_iter().map(|(name, _)| name).collect(),
                count: shape.iter().product(),
                logits,
            })
        });
        network.unwrap_or_else(|| Err(refused("its graph makes no sense".into())))
    }

    /// The outputs for an image's numbers, row-major. With `keeps_way` what [`NetworkPass::vjp`] needs stays in memory.
    pub fn forward(&self, image: Vec<f32>, keeps_way: bool) -> Result<NetworkPass<'_>, WhiteBoxError> {
        let failed = |reason: NetworkFault| {
            let file = self.file.clone();
            WhiteBoxError::Run { file, reason }
        };
        if image.len() != self.count {
            return Err(failed(NetworkFault::Count("numbers", self.count, image.len())));
        }
        let (values, tape) = self.plan.run(image, keeps_way).map_err(failed)?;
        let outputs = values.into_iter().zip(&self.logits).zip(&self.outputs);
        let outputs = outputs.map(|((value, is_logit), name)| Output::new(value, is_logit.clone(), name.clone()));
        Ok(NetworkPass {
            outputs: outputs.collect(),
            network: self,
            tape,
        })
    }
}

/// Runs on black, and keeps what every image will meet. Answers with the plan, and which numbers of the outputs are logits.
fn planned(graph: &mut Graph, shape: &[usize]) -> Result<(Plan, Vec<Vec<bool>>), NetworkFault> {
    let numbers = TensorData::new(vec![0.0_f32; shape.iter().product()], full(shape)?);
    let black = |device: &Device| {
        let x = Tensor::from_data(numbers.clone(), device).require_grad();
        Value::Floats(Floats { x, rank: shape.len() })
    };
    let values = graph.run_all(black(&graph.device))?;
    let logits = logits::expose_logits(graph, &values)?;
    let values = graph.run_all(black(&graph.device))?;
    graph.fold_constants(&values);
    Ok((Plan::new(graph, &values)?, logits))
}

impl NetworkPass<'_> {
    /// The derivative of `Σ derivative · raw` with respect to the image's numbers: one derivative for each number of each output. NaN where the
    /// device fails to hand it over.
    pub fn vjp(self, derivatives: Vec<Vec<f32>>) -> Vec<f32> {
        let count = self.network.count;
        match self.network.plan.back(self.tape, derivatives) {
            Ok(gradient) => gradient.unwrap_or_else(|| vec![0.0; count]),
            Err(_) => vec![f32::NAN; count],
        }
    }
}
