pub mod evaluate;
pub mod frames;
pub mod history;
pub mod judge;
pub mod on_frames;
pub mod photos;
pub mod train_dtn;
