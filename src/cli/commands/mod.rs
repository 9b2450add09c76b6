#[cfg(feature = "full")]
pub mod film;
