#[cfg(feature = "full")]
pub mod capture;
#[cfg(feature = "full")]
pub mod film;
