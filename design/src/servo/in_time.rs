//! The closed loop tick by tick: how loads on the joints move them.

use super::arm::Servo;
use super::law::ArmLaw;
use super::linear::solve;
use nalgebra::{DMatrix, DVector, Matrix2};
use num_complex::Complex;

/// The closed loop of an arm at one pose, with loads on its joints.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    /// x ← A x + W w; x begins with the joints' angles.
    a: DMatrix<f64>,
    w: DMatrix<f64>,
}

/// The states of arm and controller, as deviations from the set-point. They are the same at all poses, so an arm that
/// moves slowly goes on with them at the next one.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopState(DVector<f64>);

impl Servo {
    /// This arm under a law, which may be that of another one.
    pub fn closed(&self, law: &ArmLaw) -> ClosedLoop {
        let a = self.closed_loop(law, 1.0);
        let mut w = DMatrix::zeros(a.nrows(), 2);
        w.view_mut((0, 0), self.w.shape()).copy_from(&self.w);
        ClosedLoop { a, w }
    }
}

impl ClosedLoop {
    /// At rest on the set-point.
    pub fn at_rest(&self) -> LoopState {
        LoopState(DVector::zeros(self.a.nrows()))
    }

    /// From loads on the joints to their angles at z [rad/(N·m)].
    pub(super) fn compliance(&self, z: Complex<f64>) -> Matrix2<Complex<f64>> {
        let states = solve(&self.a, &self.w, z);
        Matrix2::from_fn(|row, column| states[(row, column)])
    }

    /// The joints' angles [rad], as deviations, after a tick with these loads on them [N·m].
    ///
    /// # Panics
    /// The state is that of a loop with other drives or another law.
    pub fn tick(&self, state: &mut LoopState, load: [f64; 2]) -> [f64; 2] {
        state.0 = &self.a * &state.0 + &self.w * DVector::from_column_slice(&load);
        [state.0[0], state.0[1]]
    }
}
