//! What is wrong with a network's graph.

/// What in a network's graph does not go together; a [`WhiteBoxError`](super::WhiteBoxError) names the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkFault {
    #[error("at {node}: {fault}")]
    At { node: String, fault: Box<NetworkFault> },
    /// A sentence about settings that make no sense.
    #[error("{0}")]
    Malformed(&'static str),
    /// What the parser or the tensor framework says.
    #[error("{0}")]
    Framework(String),
    #[error("its input {0} is missing")]
    MissingInput(usize),
    #[error("its input {0} holds whole numbers where fractions belong")]
    WholeInput(usize),
    #[error("its input {0} holds fractions where whole numbers belong")]
    FractionInput(usize),
    #[error("its output {0} holds whole numbers")]
    WholeOutput(String),
    #[error("its output {0} is never computed")]
    NotComputed(String),
    #[error("it takes {expected} {what} and gets {found}")]
    Count {
        what: &'static str,
        expected: usize,
        found: usize,
    },
    #[error("a tensor of rank {rank} has no axis {axis}")]
    NoAxis { rank: usize, axis: i64 },
    #[error("a tensor {shape:?} came where rank {rank} belongs")]
    Rank { shape: Vec<usize>, rank: usize },
    #[error("a tensor {shape:?} has more than {most} axes")]
    TooManyAxes { shape: Vec<usize>, most: usize },
    #[error("a tensor of it would have more than {most} numbers")]
    TooLarge { most: usize },
    #[error("a tensor {from:?} cannot become {to:?}")]
    Reshape { from: Vec<usize>, to: Vec<usize> },
    #[error("{what} {left:?} and {right:?} do not go together")]
    Mismatch {
        what: &'static str,
        left: Vec<usize>,
        right: Vec<usize>,
    },
    #[error("it asks for indices {indices:?} of an axis of length {length}")]
    Indices { indices: Vec<usize>, length: usize },
}

impl From<&'static str> for NetworkFault {
    fn from(sentence: &'static str) -> Self {
        Self::Malformed(sentence)
    }
}
