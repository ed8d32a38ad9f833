//! The control laws, from the joint's error down to the bridge's duty.
//!
//! ```text
//! counts → VelocityObserver → θ̂, ω̂ ┐
//!                 θd, ωd, αd ───────┴→ PositionLoop → α → computed torque → friction
//!        → TorqueLimit → current set-point → CurrentLoop → duty
//! ```
//!
//! Each law is an immutable model, built once; the small state that it updates is separate.
//! All are generic over [`crate::Scalar`]; none allocates, panics or loops.
//!
//! # Time
//! With the tick's period T: samples are taken at kT and the duty worked out from them
//! acts from (k+1)T on. [`CurrentLoop`] is designed in discrete time with that tick of
//! delay in its loop and turns it into the lag 1/ωc, ωc being its bandwidth;
//! [`PositionLoop`] predicts the joint to the end of this lag and places its poles with
//! the lag in the loop.
//! The observer adds no lag of first order: the phase it loses grows with frequency cubed.

mod belt;
mod current;
mod discrete;
mod fixtures;
mod friction;
mod inertia;
mod motor_equation;
mod observer;
mod passivity;
mod position;
mod tank;
mod thermal;
mod tool_friction;
mod torque_limit;
mod walls;

pub use belt::{Belt, BeltDemand, BeltGains, BeltLaw, BeltState};
pub use current::{Bus, CurrentLoop, CurrentState, Drive};
pub use fixtures::{FixtureAxis, FixturePush, VirtualFixture};
pub use friction::FrictionCompensation;
pub use inertia::{InertiaAdaptation, InertiaExcess};
pub use motor_equation::{MotorEquation, MotorEstimate};
pub use observer::{ObserverState, VelocityObserver};
pub use passivity::{JointDamping, RenderingLag, Symmetric};
pub use position::{Integral, PositionLoop};
pub use tank::{EnergyTank, TankState};
pub use thermal::{MotorHeat, MotorHeating};
pub use tool_friction::ToolFriction;
pub use torque_limit::TorqueLimit;
pub use walls::{WallLimits, WallPush, Walls};
