//! What is wrong with a network's graph.

/// What in a network's graph does not go together; a [`WhiteBoxError`](super::WhiteBoxError) names the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NetworkFault {
    #[error("at {0}: {1}")]
    At(String, Box<NetworkFault>),
    /// A sentence about settings that make no sense.
    #[error("{0}")]
    Malformed(&'static str),
    /// Why the file cannot be read, in the reader's words.
    #[error("{0}")]
    Unreadable(String),
    #[error("its input {0} is missing")]
    MissingInput(usize),
    #[error("its input {0} holds whole numbers where fractions belong")]
    WholeInput(usize),
    #[error("its input {0} holds fractions where whole numbers belong")]
    FractionInput(usize),
    #[error("it takes {1} {0} and gets {2}")]
    Count(&'static str, usize, usize),
    #[error("a tensor of rank {0} has no axis {1}")]
    NoAxis(usize, i64),
    #[error("a tensor {0:?} came where rank {1} belongs")]
    Rank(Vec<usize>, usize),
    #[error("its tensors would have more than {0} numbers")]
    TooLarge(usize),
    #[error("a tensor {0:?} cannot become {1:?}")]
    Reshape(Vec<usize>, Vec<usize>),
    #[error("{0} {1:?} and {2:?} do not go together")]
    Mismatch(&'static str, Vec<usize>, Vec<usize>),
    #[error("it asks for indices {0:?} of an axis of length {1}")]
    Indices(Vec<usize>, usize),
}

impl NetworkFault {
    /// At a node of the network.
    pub(crate) fn at(self, node: &str) -> Self {
        NetworkFault::At(node.to_owned(), self.into())
    }
}

impl From<&'static str> for NetworkFault {
    fn from(sentence: &'static str) -> Self {
        Self::Malformed(sentence)
    }
}
