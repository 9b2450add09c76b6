#[cfg(feature = "full")]
pub mod capture;
#[cfg(feature = "full")]
pub mod film;
#[cfg(feature = "full")]
pub mod model;
