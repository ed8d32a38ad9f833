//! The chain with worn joints, whose pins fly, strike and slide in their bearings.
//!
//! A worn joint has no constraint. Body k−1 has its bearing, body k its pin, and the contact
//! forces of [`Journal`] act between them. The other joints keep their constraints.
//! Positions, velocities and currents are integrated together with adaptive steps, from one
//! change of contact to the next.

use crate::chain::{JOINTS, LeverArms, PerJoint};
use crate::contact::Contact;
use crate::contact::{
    ClearanceError, ContactForce, DormandPrince45, Eccentricity, HybridSystem, Journal, Phase,
};
use crate::dynamics::{Loads, Model, State};
use crate::planar::PlanarVector;
use nalgebra::{SVector, Vector2};

/// Twelve coordinates, their rates, two currents.
const STATES: usize = 26;
type StateVector = SVector<f64, STATES>;

/// The error of a position in one step [m]: a hundredth of the 10 nm that a load of 1 N presses a pin
/// into its bearing.
const POSITION_ERROR: f64 = 1e-10;
/// The error of an angle in one step [rad]: on a link of 0.1 m that of a position.
const ANGLE_ERROR: f64 = 1e-9;
/// The error of a velocity in one step [m/s].
const SPEED_ERROR: f64 = 1e-6;
/// The error of an angular velocity in one step [rad/s]: on a link of 0.1 m that of a velocity.
const SPIN_ERROR: f64 = 1e-5;
/// The error of a current in one step [A].
const CURRENT_ERROR: f64 = 1e-6;

/// Forces and contacts of one joint over a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactStatistics {
    /// Greatest force [N].
    pub peak_force: f64,
    /// Number of impacts.
    pub impacts: u32,
    /// Greatest speed of an impact [m/s].
    pub fastest_impact: f64,
    /// Number of times that the pin left its bearing.
    pub flights: u32,
    /// Time without contact [s].
    pub flight_time: f64,
}

impl ContactStatistics {
    /// The statistics of two times together.
    pub fn combined(&self, later: &Self) -> Self {
        Self {
            peak_force: self.peak_force.max(later.peak_force),
            impacts: self.impacts + later.impacts,
            fastest_impact: self.fastest_impact.max(later.fastest_impact),
            flights: self.flights + later.flights,
            flight_time: self.flight_time + later.flight_time,
        }
    }
}

/// The worn joints and their contacts.
#[derive(Clone, Debug)]
pub struct WornJoints {
    journals: [Option<Journal>; JOINTS],
    phases: [Phase; JOINTS],
    statistics: [ContactStatistics; JOINTS],
    method: DormandPrince45<STATES>,
}

/// The arm with worn joints during one tick, as the integrator sees it.
struct WornArm<'a> {
    model: &'a Model,
    loads: &'a Loads,
    journals: &'a [Option<Journal>; JOINTS],
    phases: &'a mut [Phase; JOINTS],
    statistics: &'a mut [ContactStatistics; JOINTS],
}

impl WornJoints {
    /// Joints A to E with these clearances [m]. Their pins begin in the centres of their
    /// bearings. A joint with clearance 0 is not worn.
    ///
    /// # Errors
    /// A clearance that is not between 0 and the bearing's radius.
    pub fn new(contact: &Contact, clearance: [f64; JOINTS]) -> Result<Self, ClearanceError> {
        let mut journals = [None; JOINTS];
        for (journal, clearance) in journals.iter_mut().zip(clearance) {
            if clearance != 0.0 {
                *journal = Some(Journal::new(contact, clearance)?);
            }
        }
        let tolerance = StateVector::from_fn(|i, _| match i {
            0..12 if i % 3 < 2 => POSITION_ERROR,
            0..12 => ANGLE_ERROR,
            12..24 if i % 3 < 2 => SPEED_ERROR,
            12..24 => SPIN_ERROR,
            _ => CURRENT_ERROR,
        });
        Ok(Self {
            journals,
            phases: [Phase::Flight; JOINTS],
            statistics: [ContactStatistics::default(); JOINTS],
            method: DormandPrince45::new(tolerance),
        })
    }

    /// Which joints need a constraint.
    pub fn constrained(&self) -> [bool; JOINTS] {
        self.journals.map(|journal| journal.is_none())
    }

    /// Advances the arm by `time` [s] under constant loads.
    pub fn step(&mut self, model: &Model, state: &mut State, loads: &Loads, time: f64) {
        state.clear_floating_currents(loads);
        let mut x = packed(state);
        let mut worn_arm = WornArm {
            model,
            loads,
            journals: &self.journals,
            phases: &mut self.phases,
            statistics: &mut self.statistics,
        };
        self.method.advance(&mut worn_arm, &mut x, time);
        *state = unpacked(&x);
        model.chain.close_joints(&mut state.q, &mut state.v);
    }

    /// Takes the statistics since the last call.
    pub fn take_statistics(&mut self) -> [ContactStatistics; JOINTS] {
        std::mem::take(&mut self.statistics)
    }

    /// Accelerations of the bodies, and the force through each joint, by contact or by
    /// constraint [N].
    pub fn accelerations(
        &self,
        model: &Model,
        state: &State,
        torque: [f64; 2],
        tool_force: Vector2<f64>,
    ) -> ([PlanarVector; 4], PerJoint) {
        accelerations(
            model,
            &self.journals,
            &self.phases,
            state,
            torque,
            tool_force,
        )
    }

    /// Energy stored in the contacts [J].
    pub fn energy(&self, model: &Model, state: &State) -> f64 {
        let gaps = model.chain.gaps(&state.q);
        let stored = |k: usize| {
            self.journals[k].map_or(0.0, |journal| journal.energy(self.phases[k], gaps[k]))
        };
        (0..JOINTS).map(stored).sum()
    }

    /// The distance of each pin from its bearing's centre, as a share of the clearance; none
    /// for a joint that is not worn.
    pub fn eccentricity(&self, model: &Model, state: &State) -> [Option<f64>; JOINTS] {
        let gaps = model.chain.gaps(&state.q);
        std::array::from_fn(|k| {
            let journal = self.journals[k]?;
            Some(gaps[k].norm() / journal.clearance())
        })
    }
}

/// The motion of each pin in its bearing.
#[inline]
fn motions(model: &Model, arms: &LeverArms, state: &State) -> [Eccentricity; JOINTS] {
    let gaps = model.chain.gaps_with(arms, &state.q);
    let rates = arms.joint_motion(&state.v);
    let spin = |body: Option<usize>| {
        let body = body.and_then(|i| state.v.get(i));
        body.map_or(0.0, |v| v.angular)
    };
    std::array::from_fn(|k| Eccentricity {
        offset: gaps[k],
        rate: rates[k],
        pin_spin: spin(Some(k)),
        bearing_spin: spin(k.checked_sub(1)),
    })
}

fn accelerations(
    model: &Model,
    journals: &[Option<Journal>; JOINTS],
    phases: &[Phase; JOINTS],
    state: &State,
    torque: [f64; 2],
    tool_force: Vector2<f64>,
) -> ([PlanarVector; 4], PerJoint) {
    let chain = &model.chain;
    let arms = chain.arms(&state.q);
    let motions = motions(model, &arms, state);
    let mut free = model.free_accelerations(state, torque, tool_force);
    let mut contacts = [Vector2::zeros(); JOINTS];
    for k in 0..JOINTS {
        let touch = journals[k].and_then(|journal| journal.contact_force(phases[k], &motions[k]));
        let Some(ContactForce {
            force,
            on_pin,
            on_bearing,
        }) = touch
        else {
            continue;
        };
        contacts[k] = force;
        if k < 4 {
            let arm = arms.near[k] + on_pin;
            free[k] = free[k] + chain.bodies[k].acceleration_by(arm, force);
        }
        if k > 0 {
            let arm = arms.far[k - 1] + on_bearing;
            free[k - 1] = free[k - 1] + chain.bodies[k - 1].acceleration_by(arm, -force);
        }
    }
    let (a, mut forces) = chain.accelerations(&arms, &state.v, &free);
    for k in 0..JOINTS {
        forces[k] += contacts[k];
    }
    (a, forces)
}

impl WornArm<'_> {
    fn accelerations(&self, state: &State) -> ([PlanarVector; 4], PerJoint) {
        let torque = self.model.joint_torque(state, self.loads);
        let force = self.loads.tool_force;
        accelerations(self.model, self.journals, self.phases, state, torque, force)
    }

    /// The worn joints whose phase ends at `x`.
    fn due(&self, x: &StateVector) -> [Option<Journal>; JOINTS] {
        let gaps = self.model.chain.gaps(&unpacked(x).q);
        std::array::from_fn(|k| {
            self.journals[k].filter(|journal| journal.guard(self.phases[k], gaps[k]))
        })
    }
}

impl HybridSystem<STATES> for WornArm<'_> {
    fn rates(&self, x: &StateVector) -> StateVector {
        let state = unpacked(x);
        let (a, _) = self.accelerations(&state);
        packed(&State {
            q: state.v,
            v: a,
            current: self.model.current_rates(&state, self.loads),
        })
    }

    fn guard(&self, x: &StateVector) -> bool {
        self.due(x).iter().any(Option::is_some)
    }

    fn transition(&mut self, x: &StateVector) {
        let state = unpacked(x);
        let arms = self.model.chain.arms(&state.q);
        let motions = motions(self.model, &arms, &state);
        for (k, journal) in self.due(x).into_iter().enumerate() {
            let Some(journal) = journal else { continue };
            let statistics = &mut self.statistics[k];
            match self.phases[k] {
                Phase::Flight => {
                    statistics.impacts += 1;
                    statistics.fastest_impact =
                        statistics.fastest_impact.max(motions[k].penetration_rate());
                }
                Phase::Contact { .. } => statistics.flights += 1,
            }
            self.phases[k] = journal.next_phase(self.phases[k], &motions[k]);
        }
    }

    fn record(&mut self, x: &StateVector, step: f64) {
        let (_, forces) = self.accelerations(&unpacked(x));
        for (k, (statistics, force)) in self.statistics.iter_mut().zip(forces).enumerate() {
            statistics.peak_force = statistics.peak_force.max(force.norm());
            if self.journals[k].is_some() && self.phases[k] == Phase::Flight {
                statistics.flight_time += step;
            }
        }
    }
}

fn packed(state: &State) -> StateVector {
    let mut x = StateVector::zeros();
    for (i, part) in state.q.iter().chain(&state.v).enumerate() {
        let three = [part.linear.x, part.linear.y, part.angular];
        x.fixed_rows_mut::<3>(3 * i).copy_from_slice(&three);
    }
    x.fixed_rows_mut::<2>(24).copy_from_slice(&state.current);
    x
}

fn unpacked(x: &StateVector) -> State {
    let part = |i: usize| PlanarVector {
        linear: Vector2::new(x[3 * i], x[3 * i + 1]),
        angular: x[3 * i + 2],
    };
    State {
        q: std::array::from_fn(part),
        v: std::array::from_fn(|i| part(4 + i)),
        current: [x[24], x[25]],
    }
}
