#[cfg(feature = "full")]
pub mod capture;
#[cfg(feature = "full")]
pub mod decided;
#[cfg(feature = "full")]
pub mod film;
