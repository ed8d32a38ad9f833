//! The position loop of the whole arm as it is sampled: observer, delays, current loop, drives
//! with springs, and the arm's inertia at a pose; its margins, and bandwidths that follow from
//! the arm.
//!
//! ```text
//!            one tick late
//!  τd ─►(÷ N k)─►[current loop]─►[z⁻¹]─►[windings, rotors, springs, arm]─►θ─►[latency]─┐
//!  ▲                                                                                   │
//!  └──────── M(θ) · [position loop] ◄── [observer] ◄───────────────────────────────────┘
//! ```
//!
//! The loop is opened at the demanded torques τd, both at once: L(z) is the 2×2 matrix from
//! torques put in there to the torques demanded then, with its sign turned. 1 + λ(z) = 0 for an
//! eigenvalue λ of L is the characteristic equation, so margins are those of the two loci
//! λ(e^(jωT)): a factor on both torques, a phase or a delay in both.
//!
//! The arm is linear about rest: velocity terms are of second order, and the gravity's gradient
//! and Coulomb friction are left out; friction adds damping where the arm moves.

mod arm;
mod belt;
mod belt_law;
mod belt_loop;
mod bus_loop;
mod compliance;
mod exponential;
mod in_time;
mod law;
mod linear;
mod margins;
mod response;
mod simplex;
mod states;
mod tuning;

pub(crate) use exponential::exponential;

pub use arm::{Servo, ServoDrive};
pub use belt::{BeltJoint, BeltTuning, MOST_LATE, tune_belt};
pub use bus_loop::{BusDrive, BusServo};
pub use in_time::{ClosedLoop, LoopState};
pub use law::{ArmLaw, Gains};
pub use margins::{LoopPoint, Margins};
pub use states::MOST_KEPT;
pub use tuning::{CURRENTS, TARGET_MODULUS, Tuning, tune};
