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
#[path = "capture/jpegs.rs"]
mod jpegs;
#[path = "capture/motion.rs"]
mod motion;
#[path = "capture/served.rs"]
mod served;
#[path = "capture/stored.rs"]
mod stored;
#[path = "capture/stream.rs"]
mod stream;
