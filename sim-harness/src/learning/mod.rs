//! Learning of a job that is run again.
//!
//! Friction, cogging and what is wrong with the masses deflect the arm at the same places of the path in every run. The
//! host sees it in the encoders' angles and lets the next run follow the path with a shift:
//!
//! cₖ = r + δₖ,  δₖ₊₁ = Q (δₖ + γ (r − yₖ)),
//!
//! where r is the path, yₖ the tool as the sensors see it in run k, Q a low-pass filter without a phase and γ a share.
//! The shift is what is wrong with the arm, so δ ≈ r − y without it; the learning filter is 1, because the controller
//! itself makes up for the loop's lag: it leads the set-point by it and feeds the torque of the set-point's motion
//! forward. `contraction.rs` has the condition under which this converges, and the band of Q that follows from it.
//!
//! The shifted path goes to the controller as timed moves, which it checks as any other motion before it follows them.
//! Nothing of the learning is in the controller. What the encoders do not show stays as it is: lengths, the angles of
//! the home switches and the encoders' own errors are left to calibration.

mod contraction;
mod follower;
mod memory;
mod repeat;
mod sensors;
mod shift;
mod spline;
mod timed_path;

pub use contraction::{Filter, Response};
pub use memory::{Digest, Forgotten, Memory};
pub use repeat::{Ended, Repetition, repeat};
pub use shift::Learnt;
pub(crate) use spline::Spline;

use crate::simulation::RunError;
use fivebar_files::robot::{HomeError, MissingMasses};
use fivebar_firmware::settings::SettingsError;
use fivebar_kinematics::five_bar::GeometryError;

/// Time between the knots of the path and of its shift [s].
const KNOT: f64 = 4e-3;

/// Why a job is not learnt.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LearningError {
    /// A run was refused or ended early.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The robot has lengths only.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The robot's settings are not valid.
    #[error("{0}")]
    Settings(#[from] SettingsError),
    /// The robot's tool is not valid.
    #[error(transparent)]
    Tool(#[from] GeometryError),
    /// The robot has no home pose.
    #[error(transparent)]
    Home(#[from] HomeError),
    /// Steppers and hobby servos have no encoders.
    #[error(
        "runs are compared by what encoders see, and {0} has none: leave out --repeat and --learn, or give the robot \
         brushed motors"
    )]
    NoEncoders(&'static str),
    /// The tool's power follows its speed.
    #[error(
        "the tool's power follows its speed (`scale_with_speed`), so it needs the job's feed rates, and a job that is \
         learnt goes by times: leave out --learn"
    )]
    PowerBySpeed,
    /// A move that is not along a path.
    #[error(
        "line {0} moves the joints or changes the working mode in the middle of the job, and only lines and arcs are \
         learnt: leave out --learn, or take that line into a job of its own"
    )]
    JointMove(u32),
    /// Two levels of the tool in moves of one line.
    #[error(
        "line {0} has moves with two levels of the tool: write them as two lines, or leave out --learn"
    )]
    TwoLevels(u32),
    /// Nothing moves.
    #[error("the job moves nothing: there is nothing to learn")]
    NoMotion,
    /// The loop is unstable with an arm that may be meant.
    #[error(
        "the position loop is unstable with links of −20 to +30 % inertia or 0 to twice the payload (see `fivebar \
         margins`), so learning may not converge: leave bandwidths out of [control]"
    )]
    Unstable,
    /// No filter makes the learning converge.
    #[error(
        "learning may not converge: what is left of an error could grow by the factor {0:.2} from run to run; leave \
         bandwidths out of [control], so that they follow from the arm"
    )]
    Diverges(f64),
}
