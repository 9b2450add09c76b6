//! A detector of the program as a differentiable one: the ONNX file and the manifest that scoring uses.

use std::fmt::Display;
use std::path::Path;

use crate::error::no_image;
use crate::layers::Number;
use crate::onnx::{NetworkPass, OnnxNetwork, Output};
use crate::resample::Resampler;
use crate::{Boxes, ForwardPass, ImageLoss, Prediction, WhiteBox, WhiteBoxError};
use scaleproof_core::files;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_core::workers;
use scaleproof_detect::{
    Anchor, AnchorLabels, Anchors, Data, Manifest, Resize, Tensor, Values, anchors, wants_photo_size,
};

/// A network with its manifest and the labels that count as the model.
pub struct OnnxDetector<T = f32> {
    manifest: Manifest,
    labels: Vec<usize>,
    network: OnnxNetwork<T>,
}

impl<T: Number> OnnxDetector<T> {
    /// Reads a detector's weights. `labels`: the indices into its labels that count as the model.
    ///
    /// # Errors
    /// Labels it does not have; an input or a head that no gradient can pass; unknown operators, by their names; a
    /// network whose outputs are not those of the manifest's head.
    pub fn open(manifest: &Manifest, weights: &Path, labels: &[usize]) -> Result<Self, WhiteBoxError> {
        let refused = |reason: &dyn Display| message!("{} cannot be differentiated: {reason}", manifest.name);
        workers::memory::keep();
        let shape = input_shape(manifest).map_err(|reason| refused(&reason))?;
        if labels.is_empty() || labels.iter().any(|label| manifest.labels.name(*label).is_none()) {
            let count = manifest.labels.count();
            let reason = format!("labels {labels:?} are not among its {count}; name those that count as the model");
            return Err(refused(&reason).into());
        }
        let file = weights.display().to_string();
        // Its boxes are then in pixels of its input, as those of other heads.
        let photo_size = wants_photo_size(&manifest.head).then_some(manifest.input.size_px);
        let detector = OnnxDetector {
            manifest: manifest.clone(),
            labels: labels.to_vec(),
            network: OnnxNetwork::read(&files::read(weights)?, &file, &shape, photo_size)?,
        };
        // A head that does not fit is refused now, not at the first image.
        let [width, height] = manifest.input.size_px;
        let grey = vec![[0.5; 3]; (width * height) as usize];
        let seen = detector.predictions(&grey, [width, height]);
        seen.map_err(|reason| refused(&reason))?;
        Ok(detector)
    }

    /// All anchors, and the backward pass from them.
    pub fn forward(&self, image: &[[f64; 3]], size_px: [u32; 2]) -> Result<Box<dyn ForwardPass + '_>, WhiteBoxError> {
        Ok(Box::new(self.seen(image, size_px, true)?))
    }

    fn seen(&self, image: &[[f64; 3]], size_px: [u32; 2], keeps_way: bool) -> Result<Seen<'_, T>, WhiteBoxError> {
        let [width, height] = size_px;
        if width == 0 || height == 0 || image.len() != width as usize * height as usize {
            return Err(no_image(image.len(), size_px).into());
        }
        let way = Resampler::new(&self.manifest.input, size_px);
        let answer = self.network.forward(way.forward(image), keeps_way)?;
        if let Some(output) = answer.outputs.iter().find(|o| o.raw.iter().any(|v| v.is_nan())) {
            bail!("{} answered with NaN in its output {}", self.manifest.name, output.name);
        }
        let tensors: Vec<Tensor> = answer.outputs.iter().map(tensor).collect();
        let Some(found) = anchors(&self.manifest, &tensors, way.placement().canvas)? else {
            bail!("its head chooses boxes by itself, and no gradient passes the choice; attack another detector");
        };
        let is_sigmoid = |a: &Anchor| answer.outputs[a.output].is_logit.get(a.first_label) == Some(&true);
        if found.are_logits && found.anchors.first().is_some_and(is_sigmoid) {
            bail!("its head expects logits, and the network answers with probabilities: correct the manifest's head");
        }
        let (mut predictions, mut all_terms) = (Vec::new(), Vec::new());
        for anchor in &found.anchors {
            if anchor.label.is_some_and(|label| !self.labels.contains(&label)) {
                continue;
            }
            let terms = self.terms(anchor, &found, &answer.outputs[anchor.output]);
            predictions.push(Prediction {
                box_px: way.placement().to_photo(anchor.b),
                confidence: terms.confidence(),
                loss: terms.loss(),
                is_reported: keeps_way || self.is_reported(anchor, &found, &answer.outputs[anchor.output]),
            });
            all_terms.push(terms);
        }
        Ok(Seen {
            predictions,
            terms: all_terms,
            answer,
            way,
        })
    }

    /// Returns whether the label that scoring takes is one that counts.
    fn is_reported(&self, anchor: &Anchor, anchors: &Anchors, output: &Output) -> bool {
        let best = || anchors.best_label(anchor, &output.raw, self.manifest.labels.count()).0;
        anchor.label.is_some() || anchors.keeps == AnchorLabels::All || self.labels.contains(&best())
    }

    /// Returns what an anchor's confidence is made of: its objectness and the best of the labels that count.
    fn terms(&self, anchor: &Anchor, anchors: &Anchors, output: &Output) -> Terms {
        let [objectness, label] = anchors.exponents;
        let term =
            |index: usize, exponent: f32| Term::new((output, anchor.output), index, exponent, anchors.are_logits);
        let columns = (self.labels.iter()).filter_map(|label| label.checked_sub(anchors.first_scored));
        let scores = match anchor.label {
            Some(_) => vec![anchor.first_label],
            None => columns
                .map(|column| anchor.first_label + column * anchor.label_step)
                .collect(),
        };
        let of_labels = scores.into_iter().map(|index| term(index, label));
        let best = of_labels.max_by(|a, b| a.ln.total_cmp(&b.ln));
        let objectness = anchor.objectness.map(|index| term(index, objectness));
        Terms(objectness.into_iter().chain(best).collect())
    }
}

/// The shape of the network's input, which must be the same for all images.
fn input_shape(manifest: &Manifest) -> Result<Vec<usize>, Message> {
    let input = &manifest.input;
    if matches!(
        input.resize,
        Resize::ShortSide | Resize::ShortestEdge | Resize::Original
    ) {
        bail!("the size of its input depends on the image; attack a detector with an input of its own size");
    }
    if input.values == Values::U8 {
        bail!("it takes images of 8 bits, and no gradient passes their rounding");
    }
    Ok(input.shape(input.size_px))
}

impl<T: Number> WhiteBox for OnnxDetector<T> {
    fn name(&self) -> &str {
        &self.manifest.name
    }

    fn nms_iou(&self) -> f64 {
        self.manifest.head.nms_iou().unwrap_or(1.0)
    }

    fn loss_and_gradient(
        &self,
        image: &[[f64; 3]],
        size_px: [u32; 2],
        outline: &BoxPx,
        boxes: Boxes,
    ) -> Result<Option<ImageLoss>, WhiteBoxError> {
        Ok(ImageLoss::from_pass(self.forward(image, size_px)?, outline, boxes))
    }

    /// Forward only.
    fn predictions(&self, image: &[[f64; 3]], size_px: [u32; 2]) -> Result<Vec<Prediction>, WhiteBoxError> {
        Ok(self.seen(image, size_px, false)?.predictions)
    }

    fn shared(&self) -> Option<&(dyn WhiteBox + Sync)> {
        Some(self)
    }
}

/// Returns the output as the file itself has it, for the heads.
fn tensor(output: &Output) -> Tensor {
    Tensor {
        name: output.name.clone(),
        shape: output.shape.clone(),
        data: if output.is_whole {
            Data::I64(output.raw.iter().map(|v| *v as i64).collect())
        } else {
            Data::F32(output.values())
        },
    }
}

/// One factor of a confidence: p^exponent.
#[derive(Debug, Clone, Copy)]
struct Term {
    /// Output that its number comes from, and the number's index there.
    output: usize,
    index: usize,
    /// ln(p^exponent), exact near 0 where it comes from a logit.
    ln: f64,
    /// d ln / d number.
    derivative: f64,
}

/// Resolution of 1 − p where only p in 32 bits is known.
const FINEST: f64 = 1.0 / (1 << 24) as f64;

impl Term {
    fn new((from, output): (&Output, usize), index: usize, exponent: f32, are_logits: bool) -> Term {
        let (x, exponent) = (f64::from(from.raw[index]), f64::from(exponent));
        let (ln, derivative) = if are_logits || from.is_logit[index] {
            // ln σ(z) = −ln(1 + e^−z), whose derivative is 1 − σ(z).
            let ln = if x > 0.0 {
                -(-x).exp().ln_1p()
            } else {
                x - x.exp().ln_1p()
            };
            (ln, 1.0 / (1.0 + x.exp()))
        } else {
            let p = x.clamp(FINEST, 1.0 - FINEST);
            (p.ln(), 1.0 / p)
        };
        Term {
            output,
            index,
            ln: exponent * ln,
            derivative: exponent * derivative,
        }
    }
}

/// C = Π p^exponent, known by its logarithm, so that 1 − C has all its digits however near C is to 1.
struct Terms(Vec<Term>);

impl Terms {
    /// ln C, below 0.
    fn ln(&self) -> f64 {
        self.0.iter().map(|term| term.ln).sum::<f64>().min(-f64::MIN_POSITIVE)
    }

    fn confidence(&self) -> f64 {
        self.ln().exp()
    }

    /// −ln(1 − C).
    fn loss(&self) -> f64 {
        -(-self.ln().exp_m1()).ln()
    }

    /// d loss / d ln C = C / (1 − C).
    fn derivative(&self) -> f64 {
        1.0 / (-self.ln()).exp_m1()
    }
}

/// The forward pass of one image.
struct Seen<'a, T> {
    predictions: Vec<Prediction>,
    terms: Vec<Terms>,
    answer: NetworkPass<'a, T>,
    way: Resampler,
}

impl<T: Number> ForwardPass for Seen<'_, T> {
    fn predictions(&self) -> &[Prediction] {
        &self.predictions
    }

    fn vjp(self: Box<Self>, weights: &[f64]) -> Vec<[f64; 3]> {
        let mut derivatives: Vec<Vec<f32>> = self.answer.outputs.iter().map(|o| vec![0.0; o.raw.len()]).collect();
        for (terms, weight) in self.terms.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let derivative = weight * terms.derivative();
            for term in &terms.0 {
                derivatives[term.output][term.index] += (derivative * term.derivative) as f32;
            }
        }
        self.way.backward(&self.answer.vjp(derivatives))
    }
}
