//! Benchmarks of the kinematics, of the simulated arm and of the accuracy analysis, in `benches/`.
//! They are a crate of their own, so that `cargo test` does not build criterion.
