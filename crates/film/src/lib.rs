//! A video of a walk round the model becomes photos of a session.
//!
//! - [`look`]: where the camera stood in each frame, how sharp it is, and whether the whole model is in it; tracked from frame to frame;
//! - [`motion`]: what the camera's motion in each frame adds to σ of its viewpoint;
//! - [`choose`]: the best frames of each bin, or the nearest to other photos' viewpoints;
//! - [`hold`]: those that may be chosen, held while the film is looked at;
//! - [`pairs`]: the viewpoints that frames are to be pairs of;
//! - [`keep`]: chosen frames in their colours, located once more the one way, and written;
//! - [`walk`]: all of this for one video, and [`session`] from its file to the session on disk; [`cause`]: why its frames have no pose;
//! - [`coverage`] and [`sheet`]: what was seen, chosen and refused, as pictures.

pub mod cause;
pub mod choose;
pub mod coverage;
pub mod hold;
pub mod keep;
pub mod look;
pub mod motion;
pub mod pairs;
pub mod session;
pub mod sheet;
pub mod walk;
