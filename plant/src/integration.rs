//! The integration of arms whose drives are not ideal: one by itself, or several side by side with the same bits.
//!
//! The state of the arm (positions, velocities, currents) is extended by the rotors behind springs
//! (θm, ωm), the bristles of friction that holds (z) at joints and pen, and the sums of supplied and lost energy. All
//! of it is integrated by the classic fourth-order Runge–Kutta method, then the joints are closed.
//! [`Model::step`] integrates an arm whose drives are all ideal.

use crate::chain::Chain;
use crate::drive::DriveState;
use crate::drives::{Drives, Energy};
use crate::dynamics::{CARRIER, DRIVEN, Loads, Model, Push, State, free_accelerations};
use crate::lanes::{Lanes, Mask, Real};
use crate::planar::{PlanarVector, rotation, times};
use crate::supply::Supply;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;
use std::array::from_fn;

/// An arm, and a step of it under constant loads.
pub(crate) struct Step<'a> {
    pub(crate) drives: &'a mut Drives,
    pub(crate) model: &'a Model,
    pub(crate) state: &'a mut State,
    /// `loads.voltage` is without the supply's resistance.
    pub(crate) loads: Loads,
    /// `loads.voltage` by the supply's voltage.
    pub(crate) duty: [Option<f64>; 2],
    /// How long it is [s].
    pub(crate) time: f64,
}

/// What is integrated of an arm besides its links.
#[derive(Clone, Copy)]
pub(crate) struct Rest {
    pub(crate) current: [f64; 2],
    pub(crate) drives: [DriveState; 2],
    pub(crate) energy: Energy,
    pub(crate) motor_work: f64,
    pub(crate) deflection: Vector2<f64>,
}

impl Rest {
    const ZERO: Self = Self {
        current: [0.0; 2],
        drives: [DriveState::ZERO; 2],
        energy: Energy::ZERO,
        motor_work: 0.0,
        deflection: Vector2::new(0.0, 0.0),
    };

    /// Goes on by `time` [s] at these rates.
    #[inline(always)]
    fn advance(&mut self, rates: &Self, time: f64) {
        for j in Joint::ALL {
            let (state, rate) = (&mut self.drives[j], &rates.drives[j]);
            state.angle += rate.angle * time;
            state.speed += rate.speed * time;
            state.bristles += rate.bristles * time;
            self.current[j] += rates.current[j] * time;
        }
        self.energy.supplied += rates.energy.supplied * time;
        self.energy.lost += rates.energy.lost * time;
        self.motor_work += rates.motor_work * time;
        self.deflection += rates.deflection * time;
    }
}

/// All that is integrated of several arms, or its rates.
#[derive(Clone, Copy)]
struct Whole<const N: usize> {
    q: [PlanarVector<Lanes<N>>; 4],
    v: [PlanarVector<Lanes<N>>; 4],
    rest: [Rest; N],
}

impl<const N: usize> Whole<N> {
    /// Goes on by these times [s] at these rates.
    #[inline(always)]
    fn advance(&mut self, rates: &Self, times: Lanes<N>) {
        for link in 0..4 {
            self.q[link] = self.q[link] + rates.q[link] * times;
            self.v[link] = self.v[link] + rates.v[link] * times;
        }
        for i in 0..N {
            self.rest[i].advance(&rates.rest[i], times.0[i]);
        }
    }

    /// One of the arms.
    #[inline(always)]
    fn arm(&self, i: usize) -> State {
        let mut arm = State {
            q: [PlanarVector::ZERO; 4],
            v: [PlanarVector::ZERO; 4],
            current: self.rest[i].current,
        };
        for link in 0..4 {
            arm.q[link] = self.q[link].lane(i);
            arm.v[link] = self.v[link].lane(i);
        }
        arm
    }
}

/// The models of several arms.
struct Models<const N: usize> {
    chain: Chain<Lanes<N>>,
    gravity: Vector2<Lanes<N>>,
    tool: Vector2<Lanes<N>>,
}

/// Advances several arms whose chains have the same constraints, each by its own time.
#[inline(always)]
pub(crate) fn step_beside<const N: usize>(arms: &mut [Step<'_>; N]) {
    for arm in &mut *arms {
        arm.begin();
    }
    let steps: [f64; N] = from_fn(|i| arms[i].internal_steps());
    let times = Lanes(from_fn(|i| arms[i].time / steps[i]));
    let models = Models {
        chain: Chain::beside(from_fn(|i| &arms[i].model.chain)),
        gravity: vector(|i| arms[i].model.gravity),
        tool: vector(|i| arms[i].model.tool),
    };
    let mut whole = Whole {
        q: from_fn(|link| planar_vector(|i| arms[i].state.q[link])),
        v: from_fn(|link| planar_vector(|i| arms[i].state.v[link])),
        rest: [Rest::ZERO; N],
    };
    for (rest, arm) in whole.rest.iter_mut().zip(&*arms) {
        *rest = arm.drives.rest(arm.state);
    }
    let most = steps.into_iter().fold(0.0, f64::max) as usize;
    for done in 0..most {
        let next = runge_kutta(arms, &models, &whole, times);
        let on = |mask: Mask, i: usize| mask | Mask::from(done < steps[i] as usize) << i;
        let on = (0..N).fold(0, on);
        for link in 0..4 {
            whole.q[link] = whole.q[link].with(next.q[link], on);
            whole.v[link] = whole.v[link].with(next.v[link], on);
        }
        for i in 0..N {
            if on >> i & 1 == 1 {
                whole.rest[i] = next.rest[i];
            }
        }
    }
    for (i, arm) in arms.iter_mut().enumerate() {
        *arm.state = whole.arm(i);
        arm.drives.end(&whole.rest[i]);
    }
}

impl Drives {
    /// What is integrated in a step besides the links.
    #[inline(always)]
    fn rest(&self, state: &State) -> Rest {
        Rest {
            current: state.current,
            drives: self.state,
            energy: self.energy,
            motor_work: self.motor_work,
            deflection: self.deflection,
        }
    }

    /// Takes what a step has made of it.
    #[inline(always)]
    fn end(&mut self, rest: &Rest) {
        self.state = rest.drives;
        self.energy = rest.energy;
        self.motor_work = rest.motor_work;
        self.deflection = rest.deflection;
    }
}

impl Step<'_> {
    fn begin(&mut self) {
        self.drives
            .begin(self.model, self.state, &self.loads, self.duty);
        self.state.clear_floating_currents(&self.loads);
    }

    #[inline(always)]
    fn internal_steps(&self) -> f64 {
        let longest = self.drives.longest_step(self.model, self.state);
        (self.time / longest).ceil().max(1.0)
    }

    /// The rates of all but the links, the torques of both joints and the force on the tool.
    #[inline(always)]
    fn rates<const N: usize>(&self, i: usize, whole: &Whole<N>) -> (Rest, [f64; 2], Vector2<f64>) {
        let (drives, model, loads, duty) = (&*self.drives, self.model, &self.loads, self.duty);
        let own = &whole.rest[i];
        let mut torque = loads.joint_torque;
        let mut rates = Rest::ZERO;
        let drop = drives.supply.map_or(0.0, |s| s.drop(duty, own.current));
        rates.energy.lost += drop * Supply::current(duty, own.current);
        for j in Joint::ALL {
            let motor = &model.motors[j];
            let link = DRIVEN[j];
            let (theta, omega) = (whole.q[link].angular.0[i], whole.v[link].angular.0[i]);
            let action = drives.action(motor, &own.drives[j], j, (theta, omega), own.current[j]);
            torque[j] += action.torque;
            rates.drives[j] = action.rates;
            rates.energy.lost += action.lost;
            rates.motor_work += action.motor_power;
            rates.energy.supplied += loads.joint_torque[j] * omega;
            if let Some(voltage) = loads.voltage[j] {
                let current = own.current[j];
                let u = voltage - duty[j].unwrap_or(0.0) * drop;
                let back_emf = action.constant * action.speed;
                rates.current[j] = (u - motor.resistance * current - back_emf) / motor.inductance;
                rates.energy.supplied += voltage * current;
                rates.energy.lost += motor.resistance * current * current;
            }
        }
        let mut force = loads.tool_force;
        if force != Vector2::zeros() {
            rates.energy.supplied += force.dot(&model.tool_velocity(&whole.arm(i)));
        }
        if let Some(pen) = drives.pen.filter(|_| drives.pen_is_down) {
            let velocity = model.tool_velocity(&whole.arm(i));
            let (rate, lost) = pen.rate(velocity, own.deflection);
            (rates.deflection, rates.energy.lost) = (rate, rates.energy.lost + lost);
            force += pen.force(own.deflection);
        }
        (rates, torque, force)
    }
}

#[inline(always)]
fn runge_kutta<const N: usize>(
    arms: &[Step<'_>; N],
    models: &Models<N>,
    whole: &Whole<N>,
    times: Lanes<N>,
) -> Whole<N> {
    let [half, third, sixth] = [
        times * Lanes::each(0.5),
        times / Lanes::each(3.0),
        times / Lanes::each(6.0),
    ];
    let (mut next, mut at) = (*whole, *whole);
    let mut k = *whole;
    rates(arms, models, &at, &mut k);
    for (ahead, share) in [(half, sixth), (half, third), (times, third)] {
        next.advance(&k, share);
        at = *whole;
        at.advance(&k, ahead);
        rates(arms, models, &at, &mut k);
    }
    next.advance(&k, sixth);
    models.chain.close_joints(&mut next.q, &mut next.v);
    next
}

/// The rates at a state, written into `rates`.
#[inline(always)]
fn rates<const N: usize>(
    arms: &[Step<'_>; N],
    models: &Models<N>,
    whole: &Whole<N>,
    rates: &mut Whole<N>,
) {
    let mut torque = [Lanes::each(0.0); 2];
    let mut force = Vector2::new(Lanes::each(0.0), Lanes::each(0.0));
    let mut pushed = 0;
    for (i, arm) in arms.iter().enumerate() {
        let (own, torques, pushes) = arm.rates(i, whole);
        rates.rest[i] = own;
        for j in Joint::ALL {
            torque[j].0[i] = torques[j];
        }
        (force.x.0[i], force.y.0[i]) = (pushes.x, pushes.y);
        pushed |= Mask::from(pushes != Vector2::zeros()) << i;
    }
    let chain = &models.chain;
    let push = (pushed != 0).then(|| Push {
        arm: times(&rotation(whole.q[CARRIER].angular), models.tool),
        force,
        on: pushed,
    });
    let free = free_accelerations(chain, models.gravity, torque, push.as_ref());
    rates.q = whole.v;
    (rates.v, _) = chain.accelerations(&chain.arms(&whole.q), &whole.v, &free);
}

/// The vectors of several arms.
#[inline(always)]
fn vector<const N: usize>(of: impl Fn(usize) -> Vector2<f64>) -> Vector2<Lanes<N>> {
    Vector2::new(Lanes(from_fn(|i| of(i).x)), Lanes(from_fn(|i| of(i).y)))
}

#[inline(always)]
fn planar_vector<const N: usize>(of: impl Fn(usize) -> PlanarVector) -> PlanarVector<Lanes<N>> {
    PlanarVector {
        linear: vector(|i| of(i).linear),
        angular: Lanes(from_fn(|i| of(i).angular)),
    }
}
