//! Calibration and identification against reference data and against simulated arms.

mod arms;
mod calibration;
mod identification;
