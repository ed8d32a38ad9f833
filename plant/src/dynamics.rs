//! The state of the arm with its motors, and its integration.

use crate::chain::{Chain, PerJoint};
use crate::lanes::{Mask, Real};
use crate::motor::Motor;
use crate::planar::{Body, PlanarVector, perp, rotation, times};
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{Scalar, Vector2};

/// The chain with motors, gravity and tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// The bodies. Links 1 and 4 include their rotors, unless the drive has a spring between
    /// them; link 2 includes the payload.
    pub chain: Chain,
    /// The drives at A and E.
    pub motors: [Motor; 2],
    /// In-plane gravity [m/s²].
    pub gravity: Vector2<f64>,
    /// The tool on link 2, from the link's centre of mass, in the link's frame [m].
    pub tool: Vector2<f64>,
    /// Integration steps in the longest time that resolves motors and friction, from 1.
    pub(crate) finer_steps: f64,
}

/// Positions, velocities and currents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Centres of mass [m] and angles θ1…θ4 of the links [rad].
    pub q: [PlanarVector; 4],
    /// Their rates.
    pub v: [PlanarVector; 4],
    /// Motor currents [A].
    pub current: [f64; 2],
}

/// The inputs of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loads {
    /// Voltage at each motor's terminals [V]; none if they float.
    pub voltage: [Option<f64>; 2],
    /// Torque on each driven joint besides those of motor and friction [N·m].
    pub joint_torque: [f64; 2],
    /// Force on the tool [N].
    pub tool_force: Vector2<f64>,
}

/// The links that the motors turn.
pub(crate) const DRIVEN: [usize; 2] = [0, 3];
/// The link that carries the tool.
pub(crate) const CARRIER: usize = 1;

/// Least integration step [s]. It resolves the fastest winding that a robot file may have;
/// friction that changes its sign faster does so within one step.
pub(crate) const SHORTEST_STEP: f64 = 1e-6;

/// Rates of change of a [`State`].
#[derive(Clone, Copy)]
pub(crate) struct Rates {
    pub(crate) v: [PlanarVector; 4],
    pub(crate) a: [PlanarVector; 4],
    pub(crate) current: [f64; 2],
}

impl State {
    /// Sets the currents of floating terminals to zero: diodes end them within microseconds.
    pub(crate) fn clear_floating_currents(&mut self, loads: &Loads) {
        for (current, voltage) in self.current.iter_mut().zip(loads.voltage) {
            if voltage.is_none() {
                *current = 0.0;
            }
        }
    }

    #[inline(always)]
    pub(crate) fn after(&self, rates: &Rates, time: f64) -> Self {
        let mut next = *self;
        for i in 0..4 {
            next.q[i] = self.q[i] + rates.v[i] * time;
            next.v[i] = self.v[i] + rates.a[i] * time;
        }
        for j in Joint::ALL {
            next.current[j] = self.current[j] + rates.current[j] * time;
        }
        next
    }
}

/// A force on the tool, at its place from the centre of mass of link 2, of the arms that are on.
pub(crate) struct Push<T: Scalar> {
    pub(crate) arm: Vector2<T>,
    pub(crate) force: Vector2<T>,
    pub(crate) on: Mask,
}

/// The accelerations that the applied forces alone would give.
#[inline(always)]
pub(crate) fn free_accelerations<T: Real>(
    chain: &Chain<T>,
    gravity: Vector2<T>,
    torque: [T; 2],
    push: Option<&Push<T>>,
) -> [PlanarVector<T>; 4] {
    let mut free = [PlanarVector {
        linear: gravity,
        angular: T::zero(),
    }; 4];
    for (link, torque) in DRIVEN.into_iter().zip(torque) {
        free[link].angular += torque / chain.bodies[link].inertia;
    }
    if let Some(&Push { arm, force, on }) = push {
        let pushed = free[CARRIER] + chain.bodies[CARRIER].acceleration_by(arm, force);
        free[CARRIER] = free[CARRIER].with(pushed, on);
    }
    free
}

impl Model {
    /// Torque of each drive at its joint [N·m], friction included.
    pub fn drive_torque(&self, state: &State) -> [f64; 2] {
        Joint::ALL.map(|j| {
            let omega = state.v[DRIVEN[j]].angular;
            self.motors[j].torque(state.current[j]) + self.motors[j].friction(omega)
        })
    }

    /// Accelerations of the bodies, and the force of each joint on body k [N].
    pub fn accelerations(
        &self,
        state: &State,
        torque: [f64; 2],
        tool_force: Vector2<f64>,
    ) -> ([PlanarVector; 4], PerJoint) {
        let free = self.free_accelerations(state, torque, tool_force);
        let arms = self.chain.arms(&state.q);
        self.chain.accelerations(&arms, &state.v, &free)
    }

    /// The accelerations that the applied forces alone would give.
    #[inline(always)]
    pub(crate) fn free_accelerations(
        &self,
        state: &State,
        torque: [f64; 2],
        tool_force: Vector2<f64>,
    ) -> [PlanarVector; 4] {
        let push = (tool_force != Vector2::zeros()).then(|| Push {
            arm: self.tool_arm(state),
            force: tool_force,
            on: f64::ALL,
        });
        free_accelerations(&self.chain, self.gravity, torque, push.as_ref())
    }

    /// The tool from its link's centre of mass, in the frame of the base [m].
    fn tool_arm(&self, state: &State) -> Vector2<f64> {
        times(&rotation(state.q[CARRIER].angular), self.tool)
    }

    /// The tool's position [m].
    pub fn tool(&self, state: &State) -> Vector2<f64> {
        state.q[CARRIER].linear + self.tool_arm(state)
    }

    /// The tool's velocity [m/s].
    pub fn tool_velocity(&self, state: &State) -> Vector2<f64> {
        let v = state.v[CARRIER];
        v.linear + perp(self.tool_arm(state)) * v.angular
    }

    /// Kinetic energy, with the rotors' [J].
    pub fn kinetic_energy(&self, state: &State) -> f64 {
        let of = |(body, v): (&Body, &PlanarVector)| {
            0.5 * (body.mass * v.linear.norm_squared() + body.inertia * v.angular * v.angular)
        };
        self.chain.bodies.iter().zip(&state.v).map(of).sum()
    }

    /// Kinetic and potential energy [J].
    pub fn energy(&self, state: &State) -> f64 {
        let height = |(body, q): (&Body, &PlanarVector)| body.mass * self.gravity.dot(&q.linear);
        let fallen: f64 = self.chain.bodies.iter().zip(&state.q).map(height).sum();
        self.kinetic_energy(state) - fallen
    }

    /// The inertias of links 1 and 4 about A and E [kg·m²].
    pub(crate) fn about_pivots(&self) -> [f64; 2] {
        let [link1, _, _, link4] = &self.chain.bodies;
        [
            link1.inertia + link1.mass * link1.near.norm_squared(),
            link4.inertia + link4.mass * link4.far.norm_squared(),
        ]
    }

    /// The longest integration step that resolves motors and friction [s].
    pub fn longest_step(&self) -> f64 {
        let about_pivot = self.about_pivots();
        let rates = Joint::ALL.map(|j| self.motors[j].fastest_rate(about_pivot[j]));
        (1.0 / (self.finer_steps * rates[0].max(rates[1]))).max(SHORTEST_STEP)
    }

    /// All torque on each driven joint [N·m].
    #[inline(always)]
    pub(crate) fn joint_torque(&self, state: &State, loads: &Loads) -> [f64; 2] {
        let [torque1, torque4] = self.drive_torque(state);
        let [extra1, extra4] = loads.joint_torque;
        [torque1 + extra1, torque4 + extra4]
    }

    #[inline(always)]
    fn rates(&self, state: &State, loads: &Loads) -> Rates {
        let torque = self.joint_torque(state, loads);
        let (a, _) = self.accelerations(state, torque, loads.tool_force);
        Rates {
            v: state.v,
            a,
            current: self.current_rates(state, loads),
        }
    }

    /// di/dt of the motors [A/s].
    #[inline(always)]
    pub(crate) fn current_rates(&self, state: &State, loads: &Loads) -> [f64; 2] {
        Joint::ALL.map(|j| {
            let omega = state.v[DRIVEN[j]].angular;
            loads.voltage[j].map_or(0.0, |voltage| {
                self.motors[j].current_rate(voltage, state.current[j], omega)
            })
        })
    }

    /// Advances the state by `time` [s]: one step of the classic fourth-order Runge–Kutta
    /// method, then the projection onto the constraints.
    pub fn step(&self, state: &mut State, loads: &Loads, time: f64) {
        state.clear_floating_currents(loads);
        let k1 = self.rates(state, loads);
        let k2 = self.rates(&state.after(&k1, 0.5 * time), loads);
        let k3 = self.rates(&state.after(&k2, 0.5 * time), loads);
        let k4 = self.rates(&state.after(&k3, time), loads);
        let mut next = state.after(&k1, time / 6.0);
        next = next.after(&k2, time / 3.0);
        next = next.after(&k3, time / 3.0);
        next = next.after(&k4, time / 6.0);
        self.chain.close_joints(&mut next.q, &mut next.v);
        *state = next;
    }
}
