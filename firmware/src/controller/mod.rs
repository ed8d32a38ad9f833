//! The controller: one tick from samples to bridge commands, and what it is asked for
//! from below.

mod follow;
mod joint;
mod model;
mod path;
mod planning;
mod queue;
mod report;
mod request;
mod search;
mod setpoint;
mod status;

use crate::homing::Search;
use crate::io::{Command, Sensed};
use crate::safety::{Event, Fault, Limits, Response, State, TOLERATED_TICKS};
use crate::settings::{Settings, SettingsError};
use fivebar_kinematics::Vec2;
use fivebar_kinematics::control::Bus;
use fivebar_kinematics::five_bar::WorkingMode;
use joint::Joint;
use model::{DUTY_LIMIT, Model};
use path::Path;
pub use path::Stretch;
pub(crate) use path::stopping_time;
pub use planning::{Hold, PlanningSnapshot};
pub use queue::PIECES;
pub use request::{Refusal, Request};
use setpoint::Setpoint;
pub use status::{JointReference, Snapshot, Status};

/// The whole controller of an arm.
///
/// What every tick needs comes first, here and in the model: a load of the FPU reaches 1 KiB
/// from its base, and so they have one base in common.
#[repr(C)]
pub struct Controller {
    joints: [Joint; 2],
    setpoint: Setpoint,
    /// Position errors [rad] as last worked out.
    error: [f32; 2],
    bus_voltage: f32,
    ticks: u32,
    /// The tick after which the host was heard last.
    heard_at: u32,
    state: State,
    /// The working mode that the arm is in.
    mode: WorkingMode,
    limits: Limits,
    /// There was a tick before.
    begun: bool,
    homed: bool,
    /// The latched fault lets the arm be held.
    held: bool,
    model: Model,
    path: Path,
    settings: Settings,
    searches: [Search; 2],
    /// The latched fault, as it was raised.
    latched: Option<Snapshot>,
    missed_ticks: u32,
    /// Counts the paths forgotten before their end.
    path_generation: u32,
}

/// What one tick's samples say that may be a fault.
struct Samples {
    innovation: [f32; 2],
    current: [f32; 2],
    velocity: [f32; 2],
    too_hot: bool,
}

/// What the joints are to give.
#[derive(Clone, Copy)]
struct Demand {
    /// τ1, τ4 [N·m].
    torque: [f32; 2],
    /// What has clipped so far.
    limits: Limits,
}

/// What a tick has to do besides watching.
enum Work {
    /// Nothing: the bridges are off.
    Rest,
    /// Look for the home switches.
    Search,
    /// Hold or follow the path.
    Follow,
}

impl Controller {
    /// A controller for the arm of these settings, Stopped and not homed.
    ///
    /// # Errors
    /// The first setting that is not sound.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        Ok(Self {
            model: Model::new(settings)?,
            settings: *settings,
            joints: [Joint::new(), Joint::new()],
            begun: false,
            state: State::Stopped,
            homed: false,
            mode: settings.working_mode(),
            latched: None,
            held: false,
            path: Path::new(stopping_time(settings), 1.0 / settings.control.tick_rate),
            setpoint: Setpoint::hold([Vec2::zero(); 2]),
            searches: [Search::new(0.0); 2],
            error: [0.0; 2],
            limits: Limits::NONE,
            bus_voltage: 0.0,
            ticks: 0,
            missed_ticks: 0,
            heard_at: 0,
            path_generation: 0,
        })
    }

    /// The settings in use.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// One tick: what the bridges are told until the next.
    ///
    /// Bounded: no loop but over the two joints and at most two pieces of path. The
    /// outputs act from the next tick on.
    pub fn tick(&mut self, sensed: &Sensed) -> Command {
        self.ticks = self.ticks.wrapping_add(1);
        self.bus_voltage = f32::from(sensed.bus_voltage) * self.model.bus_voltage_per_code;
        let samples = self.measure(sensed);
        if sensed.missed_ticks > 0 {
            self.overrun(sensed.missed_ticks);
        }
        if let Some(fault) = self.sampled_fault(sensed, &samples) {
            self.latch(fault);
        }
        let demand = match self.work() {
            Work::Rest => None,
            Work::Search => self.search(sensed),
            Work::Follow => self.follow(),
        };
        let command = match demand {
            Some(demand) => self.drive(demand),
            None => self.off(),
        };
        if let Some(fault) = self.stopping_fault() {
            self.latch(fault);
        }
        command
    }

    #[inline(always)]
    fn measure(&mut self, sensed: &Sensed) -> Samples {
        let [joint1, joint4] = &mut self.joints;
        let [model1, model4] = &self.model.axes;
        let observer = &self.model.observer;
        let [alpha1, alpha4] = self.setpoint.alpha;
        let [counts1, counts4] = sensed.counts;
        let [current1, current4] = sensed.current;
        if !self.begun {
            self.begun = true;
            joint1.begin(counts1);
            joint4.begin(counts4);
        }
        let innovation = [
            joint1.measure(observer, model1, counts1, current1, alpha1),
            joint4.measure(observer, model4, counts4, current4, alpha4),
        ];
        // Motors warm slowly: each is looked at in every other tick.
        let too_hot = if self.ticks & 1 == 0 {
            joint1.warm(model1)
        } else {
            joint4.warm(model4)
        };
        Samples {
            innovation,
            current: [joint1.current, joint4.current],
            velocity: [joint1.velocity(), joint4.velocity()],
            too_hot,
        }
    }

    /// The gravest fault that the samples alone show. Unpowered, only what makes the
    /// angles or the stop button untrue counts.
    #[inline(always)]
    fn sampled_fault(&self, sensed: &Sensed, samples: &Samples) -> Option<Fault> {
        let monitor = &self.model.monitor;
        if sensed.emergency_stop {
            return Some(Fault::EmergencyStop);
        }
        if monitor.jumped(samples.innovation) {
            return Some(Fault::EncoderJump);
        }
        if !self.is_powered() {
            return None;
        }
        let [driver1, driver4] = sensed.driver_fault;
        if driver1 | driver4 {
            return Some(Fault::DriverFault);
        }
        if monitor.over_current(samples.current) {
            return Some(Fault::OverCurrent);
        }
        if monitor.over_speed(samples.velocity) {
            return Some(Fault::OverSpeed);
        }
        if let Some(fault) = monitor.bus(self.bus_voltage) {
            return Some(fault);
        }
        samples.too_hot.then_some(Fault::OverTemperature)
    }

    /// Ticks were missed. So many at once that the loops no longer know the arm are a
    /// fault while the bridges are on; all are counted.
    #[cold]
    fn overrun(&mut self, missed: u32) {
        self.missed_ticks = self.missed_ticks.saturating_add(missed);
        if missed > TOLERATED_TICKS && self.is_powered() {
            self.latch(Fault::TickOverrun);
        }
    }

    /// What a tick has to do in this state.
    #[inline(always)]
    fn work(&self) -> Work {
        match self.state {
            State::Armed | State::Running | State::Stopping => Work::Follow,
            State::Fault if self.held => Work::Follow,
            State::Homing => Work::Search,
            State::Stopped | State::Fault => Work::Rest,
        }
    }

    /// Whether the bridges are on.
    #[inline(always)]
    fn is_powered(&self) -> bool {
        match self.work() {
            Work::Rest => false,
            Work::Search | Work::Follow => true,
        }
    }

    /// Latches a fault with a snapshot of how things stand. The first one stays, unless it
    /// left the arm powered and the new one does not.
    #[cold]
    #[inline(never)]
    fn latch(&mut self, fault: Fault) {
        let hold = match fault.response() {
            Response::PowerOff => false,
            // What stops under control needs a path or a place to hold.
            Response::ControlledStop => match self.state {
                State::Armed | State::Running | State::Stopping => true,
                State::Fault => self.held,
                State::Stopped | State::Homing => false,
            },
        };
        if self.latched.is_none() || (self.held && !hold) {
            self.latched = Some(Snapshot {
                fault,
                tick: self.ticks,
                state: self.state,
                angle: self.angles(),
                velocity: self.velocities(),
                error: self.error,
                current: self.joints.each_ref().map(|joint| joint.current),
                torque: self.torques(),
                bus_voltage: self.bus_voltage,
            });
            self.held = hold;
        }
        if fault.loses_angles() {
            self.homed = false;
        }
        if let Some(next) = self.state.after(Event::Fault) {
            self.enter(next);
        }
        if self.held {
            self.path.brake();
        }
    }

    /// Enters a state: what each needs at entry, besides what its request prepared.
    fn enter(&mut self, next: State) {
        let before = self.state;
        self.state = next;
        match next {
            State::Stopped => {
                self.latched = None;
                self.held = false;
                self.forget_path();
                for (joint, model) in self.joints.iter_mut().zip(&self.model.axes) {
                    joint.settle(model);
                }
            }
            State::Armed => {
                if before != State::Running {
                    self.forget_path();
                }
            }
            State::Stopping => self.path.brake(),
            State::Homing | State::Running | State::Fault => {}
        }
    }

    /// Forgets the path, and lets the planner know that its end does not hold any more.
    fn forget_path(&mut self) {
        self.path_generation = self.path_generation.wrapping_add(1);
        self.path.clear();
    }

    /// Sets the current loops to work. The last check before the bridges: nothing that is
    /// not a number gets past it.
    #[inline(always)]
    fn drive(&mut self, demand: Demand) -> Command {
        let bus = Bus::new(self.bus_voltage, DUTY_LIMIT);
        let [joint1, joint4] = &mut self.joints;
        let [model1, model4] = &self.model.axes;
        let [torque1, torque4] = demand.torque;
        let limited1 = joint1.drive(model1, torque1, &bus);
        let limited4 = joint4.drive(model4, torque4, &bus);
        self.limits = demand.limits.with(Limits::VOLTAGE, limited1 || limited4);
        let duty = [joint1.duty, joint4.duty];
        // Both are within ±1 or not numbers, and so is their sum.
        let [duty1, duty4] = duty;
        if !(duty1 + duty4).is_finite() {
            self.latch(Fault::NotANumber);
            return self.off();
        }
        Command {
            duty,
            enable: [true; 2],
            brake: false,
        }
    }

    /// Bridges off, brake on.
    fn off(&mut self) -> Command {
        self.limits = Limits::NONE;
        self.setpoint.rest();
        for joint in &mut self.joints {
            joint.release();
        }
        Command {
            duty: [0.0; 2],
            enable: [false; 2],
            brake: true,
        }
    }

    #[inline(always)]
    fn angles(&self) -> [f32; 2] {
        let [joint1, joint4] = &self.joints;
        [joint1.angle(), joint4.angle()]
    }

    /// The demanded torques [N·m].
    fn torques(&self) -> [f32; 2] {
        let [joint1, joint4] = &self.joints;
        let [model1, model4] = &self.model.axes;
        [joint1.torque(model1), joint4.torque(model4)]
    }

    #[inline(always)]
    fn velocities(&self) -> [f32; 2] {
        let [joint1, joint4] = &self.joints;
        [joint1.velocity(), joint4.velocity()]
    }
}

/// A controller that nobody else shares needs no lock.
impl rtic_core::Mutex for Controller {
    type T = Self;

    fn lock<R>(&mut self, work: impl FnOnce(&mut Self) -> R) -> R {
        work(self)
    }
}
