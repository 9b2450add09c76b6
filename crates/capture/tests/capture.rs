//! Tests of guided capture's parts.

#[path = "capture/access.rs"]
mod access;
#[path = "capture/advice.rs"]
mod advice;
#[path = "capture/connections.rs"]
mod connections;
#[path = "capture/device.rs"]
mod device;
#[path = "capture/dial.rs"]
mod dial;
#[path = "capture/encrypted.rs"]
mod encrypted;
#[path = "capture/guidance.rs"]
mod guidance;
#[path = "capture/motion.rs"]
mod motion;
