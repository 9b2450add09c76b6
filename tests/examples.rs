//! The programs in `examples/`: what a Rust program needs is public, and does what its first lines say.
