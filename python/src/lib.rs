//! The Python package's compiled half, `fivebar._native`.
//!
//! It takes and returns flat arrays of `f64`, one row for each point or state. Shapes, defaults
//! and names of sides belong to the Python half (`package/fivebar`), which also documents the
//! interface.

mod accuracy;
mod batch;
mod dynamics;
mod error;
mod live;
mod measured;
mod mechanism;
mod motion;
mod photo;
mod plant;
mod pool;
mod positions;
mod robot;
mod simulation;
mod status;
mod study;
mod synthesis;
mod touch;

/// The module, as Python imports it.
#[pyo3::pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    #[pymodule_export]
    use super::accuracy::{
        accuracy, accuracy_along, accuracy_blocks, accuracy_map_of, accuracy_part,
        linkage_accuracy, slider_accuracy,
    };
    #[pymodule_export]
    use super::dynamics::{derivatives, forward_dynamics, inverse_dynamics};
    #[pymodule_export]
    use super::live::{Connection, taught_path_as, taught_rests};
    #[pymodule_export]
    use super::measured::{
        calibrate, calibration_poses, excitations, identify, identify_payload, simulated_log,
    };
    #[pymodule_export]
    use super::mechanism::{export, linkage, mobility};
    #[pymodule_export]
    use super::motion::{inverse_motion, jacobian, motion};
    #[pymodule_export]
    use super::photo::{photo, photo_marks};
    #[pymodule_export]
    use super::plant::{Plant, Plants};
    #[pymodule_export]
    use super::positions::{forward, inverse, mode_change};
    #[pymodule_export]
    use super::robot::{Robot, built_in};
    #[pymodule_export]
    use super::simulation::Scenario;
    #[pymodule_export]
    use super::status::statuses;
    #[pymodule_export]
    use super::study::{Plan, clearance, crossing, margins, workspace};
    #[pymodule_export]
    use super::synthesis::Study;
}
