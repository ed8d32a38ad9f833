//! Calibration and identification against reference data and against simulated arms.

mod arms;
mod belts;
mod bus;
mod calibration;
mod coaxial;
mod coverage;
mod excitations;
mod identification;
mod logs;
mod measured_arm;
mod mixed;
mod payload;
mod random_logs;
mod refused_points;
mod simulated_arm;
mod tip_error;
mod truth;
