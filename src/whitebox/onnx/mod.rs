//! ONNX files as differentiable networks, on the tensors of `burn`.
//!
//! `onnx-ir` parses the file; each of its nodes becomes one of our own operators (`operator`), one file a group. All shapes are fixed when a
//! file is opened, for one image: what does not depend on the image is then a constant. Weights carry no gradient.

mod arithmetic;
mod choice;
mod combine;
mod convolution;
mod elementwise;
mod graph;
mod logits;
mod operator;
mod read;
mod rearrange;
mod resize;
mod shapes;
mod value;

use burn::tensor::{Device, Tensor, TensorData};

use graph::Graph;
use value::{Floats, RANK, Value, full};

use crate::whitebox::quietly::quietly;
use crate::whitebox::{NetworkFault, WhiteBoxError};

/// A network for images of one shape.
pub(crate) struct OnnxNetwork {
    file: String,
    graph: Graph,
    shape: Vec<usize>,
    device: Device,
    logits: Vec<Vec<bool>>,
}

/// One output tensor, row-major.
#[derive(Debug, Clone)]
pub(crate) struct Output {
    pub name: String,
    pub shape: Vec<usize>,
    /// Where [`Output::is_logit`] says so, the logit of the sigmoid that the file ends in.
    pub raw: Vec<f32>,
    pub is_logit: Vec<bool>,
    /// Whether they are whole numbers, such as labels.
    pub is_whole: bool,
}

impl Output {
    /// What the file itself answers.
    pub(crate) fn values(&self) -> Vec<f32> {
        let sigmoid = |z: f32| 1.0 / (1.0 + (-z).exp());
        let both = self.raw.iter().zip(&self.is_logit);
        both.map(|(raw, is_logit)| if *is_logit { sigmoid(*raw) } else { *raw })
            .collect()
    }
}

/// The outputs for one image, with their autodiff graph.
pub(crate) struct NetworkPass {
    pub outputs: Vec<Output>,
    /// `None` for whole numbers, which no gradient passes.
    tensors: Vec<Option<Tensor<RANK>>>,
    image: Tensor<RANK>,
    device: Device,
}

impl OnnxNetwork {
    /// Reads an ONNX file's bytes for images of this shape, such as [1, 3, 416, 416]; `file` is only named in errors. `photo_size`
    /// is for a network whose second input is the photo's width and height.
    ///
    /// # Errors
    /// What is no ONNX file, makes no sense, or has operators that are not here, by their names.
    pub(crate) fn read(
        bytes: &[u8],
        file: &str,
        shape: &[usize],
        photo_size: Option<[u32; 2]>,
        device: &Device,
    ) -> Result<OnnxNetwork, WhiteBoxError> {
        // The parser and the tensors panic on graphs whose parts do not go together.
        quietly(|| Self::try_read(bytes, file, shape, photo_size, device)).unwrap_or_else(|| {
            Err(WhiteBoxError::OnnxNetwork {
                file: file.to_owned(),
                reason: NetworkFault::Malformed("its graph makes no sense"),
            })
        })
    }

    fn try_read(
        bytes: &[u8],
        file: &str,
        shape: &[usize],
        photo_size: Option<[u32; 2]>,
        device: &Device,
    ) -> Result<OnnxNetwork, WhiteBoxError> {
        let device = device.clone().autodiff();
        let graph = read::read(bytes, file, photo_size, &device)?;
        let mut network = OnnxNetwork {
            file: file.to_owned(),
            graph,
            shape: shape.to_vec(),
            device,
            logits: Vec::new(),
        };
        network.fold_constants().map_err(|reason| WhiteBoxError::OnnxNetwork {
            file: file.to_owned(),
            reason,
        })?;
        Ok(network)
    }

    /// Runs once on black, and keeps what every image will meet.
    fn fold_constants(&mut self) -> Result<(), NetworkFault> {
        let black = vec![0.0; self.shape.iter().product()];
        let (_, image) = self.image(black, true)?;
        let values = self.graph.run_all(image)?;
        let logits = logits::expose_logits(&mut self.graph, &values)?;
        self.logits = logits;
        let (_, image) = self.image(vec![0.0; self.shape.iter().product()], true)?;
        let values = self.graph.run_all(image)?;
        self.graph.fold_constants(&values);
        Ok(())
    }

    fn image(&self, numbers: Vec<f32>, requires_grad: bool) -> Result<(Tensor<RANK>, Value), NetworkFault> {
        let leaf = Tensor::from_data(TensorData::new(numbers, full(&self.shape)?), &self.device);
        let leaf = if requires_grad { leaf.require_grad() } else { leaf };
        let value = Floats {
            x: leaf.clone(),
            rank: self.shape.len(),
        };
        Ok((leaf, Value::Floats(value)))
    }

    /// The outputs for an image's numbers, row-major. With `requires_grad` the autodiff graph stays in memory until [`NetworkPass::vjp`] consumes it.
    ///
    /// # Errors
    /// A number of numbers that is not the shape's.
    pub(crate) fn forward(&self, image: Vec<f32>, requires_grad: bool) -> Result<NetworkPass, WhiteBoxError> {
        self.try_forward(image, requires_grad)
            .map_err(|reason| WhiteBoxError::Run {
                file: self.file.clone(),
                reason,
            })
    }

    fn try_forward(&self, numbers: Vec<f32>, requires_grad: bool) -> Result<NetworkPass, NetworkFault> {
        if numbers.len() != self.shape.iter().product::<usize>() {
            return Err(NetworkFault::Count(
                "numbers",
                self.shape.iter().product(),
                numbers.len(),
            ));
        }
        let (image, value) = self.image(numbers, requires_grad)?;
        let (mut outputs, mut tensors) = (Vec::new(), Vec::new());
        for (i, value) in self.graph.run(value)?.into_iter().enumerate() {
            let shape = value.shape();
            let (raw, tensor) = match value {
                Value::Floats(value) => (value.values()?, Some(value.x)),
                Value::Integers(value) => (value.data.iter().map(|v| *v as f32).collect(), None),
            };
            let mut is_logit = self.logits[i].clone();
            is_logit.resize(raw.len(), false);
            outputs.push(Output {
                name: self.graph.outputs[i].0.clone(),
                shape,
                raw,
                is_logit,
                is_whole: tensor.is_none(),
            });
            tensors.push(tensor);
        }
        Ok(NetworkPass {
            outputs,
            tensors,
            image,
            device: self.device.clone(),
        })
    }
}

impl NetworkPass {
    /// The derivative of `Σ derivative · raw` with respect to the image's numbers: one derivative for each number of each output. NaN where the
    /// device fails to hand it over.
    pub(crate) fn vjp(self, derivatives: Vec<Vec<f32>>) -> Vec<f32> {
        let mut sum: Option<Tensor<1>> = None;
        for (tensor, derivatives) in self.tensors.into_iter().zip(derivatives) {
            let Some(tensor) = tensor else { continue };
            // Backwards costs as much for zeros.
            if !tensor.is_tracked() || derivatives.iter().all(|derivative| *derivative == 0.0) {
                continue;
            }
            let derivatives = Tensor::from_data(TensorData::new(derivatives, tensor.dims()), &self.device);
            let part = (tensor * derivatives).sum();
            sum = Some(match sum {
                Some(sum) => sum + part,
                None => part,
            });
        }
        let count = self.image.shape().num_elements();
        match sum.and_then(|sum| self.image.grad(&sum.backward())) {
            Some(gradient) => gradient
                .try_into_vec_as::<f32>()
                .unwrap_or_else(|_| vec![f32::NAN; count]),
            None => vec![0.0; count],
        }
    }
}
