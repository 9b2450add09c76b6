//! Error of variants that cannot be compared.

/// Reason why nothing can be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    #[error("no photo has the variant `{base}`, only {variants}")]
    NoBase { base: String, variants: String },
    #[error("all photos have the variant `{base}`: add those of another texture")]
    NothingElse { base: String },
    #[error("no photo has the variant `{control}`, which is to be the control, only {variants}{hint}")]
    NoControl {
        control: String,
        variants: String,
        hint: String,
    },
    #[error("the control is the base itself, `{base}`: it has to be a second plain round, under another name{hint}")]
    ControlIsBase { base: String, hint: String },
    #[error("all photos have the variant `{base}` or that of its control, `{control}`: add those of a texture")]
    NothingBesideControl { base: String, control: String },
    #[error(
        "no photo of `{variant}` was taken from the same place and bin as one of `{base}`: they cannot be compared"
    )]
    NoPair { base: String, variant: String },
}
