//! Simulated detections: tags as seen from a viewpoint, with noise and known faults. For sweeps that test at which faults `locate` abstains.

mod fault;
mod simulator;
mod strike;

pub use fault::SimulatedFault;
pub use simulator::{Noise, SimulatedView, Simulator, looking_at, normal};
