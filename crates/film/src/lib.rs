//! A video of a walk round the model becomes photos of a session.

pub mod cache; // decoded frames that may be chosen, in memory
pub mod cause; // the one cause why a walk's frames have no pose
pub mod choose; // the best frames of each bin, or the nearest to other photos' viewpoints
pub mod coverage; // the camera's way round the model, as a picture
pub mod keep; // chosen frames in their colours, located once more the one way, and written
pub mod motion; // share of the camera's motion in σ of a viewpoint
pub mod pairs; // viewpoints of another texture's photos, as targets
pub mod session; // from a video's file to the session on disk
pub mod sheet; // contact sheet of the chosen frames
pub mod tracking; // pose and sharpness of each frame, tracked from frame to frame
pub mod walk; // frames looked at, chosen and kept
