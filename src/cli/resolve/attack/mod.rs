pub mod evaluate;
pub mod frames;
pub mod history;
pub mod import;
pub mod judge;
pub mod on_frames;
pub mod render;
pub mod run;
