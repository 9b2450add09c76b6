//! Output tensors of a network.

#[derive(Debug, Clone)]
pub struct Tensor {
    pub name: String,
    pub shape: Vec<usize>,
    pub data: Data,
}

#[derive(Debug, Clone)]
pub enum Data {
    F32(Vec<f32>),
    I64(Vec<i64>),
}

impl Tensor {
    /// The first of some outputs that has fractions and such a shape: its number and its values.
    pub(super) fn shaped(outputs: &[Tensor], fits: impl Fn(&[usize]) -> bool) -> Option<(usize, &[f32])> {
        let mut shaped = outputs.iter().enumerate().filter(|(_, t)| fits(&t.shape));
        shaped.find_map(|(i, t)| Some((i, t.floats()?)))
    }

    /// Its values, where they are fractions.
    pub fn floats(&self) -> Option<&[f32]> {
        match &self.data {
            Data::F32(v) => Some(v),
            Data::I64(_) => None,
        }
    }
}
