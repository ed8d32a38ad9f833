//! The arm with its motors, bridges and sensors, one tick at a time.

mod injection;
mod state;

use crate::active_faults::{ActiveFaults, BridgeDefect};
use crate::brake::Brake;
use crate::contactor::Contactor;
use crate::drives::Drives;
use crate::dynamics::{DRIVEN, Loads, Model, State};
use crate::encoder::{EncoderSide, TrueEncoder};
use crate::fault::PlantFault;
use crate::index::Index;
use crate::integration::{Step, step_beside};
use crate::latency::Delay;
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::planar::PlanarVector;
use crate::ripple::RipplePeriods;
use crate::sensors::{self, JointSensors};
use crate::stop::HardStop;
use crate::wiring::Wiring;
use crate::worn_joints::WornJoints;
use fivebar_design::Noise;
use fivebar_firmware::drives::BrushedSample;
use fivebar_firmware::settings::{HomingMethod, ToolOutputSettings};
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Steps of the PWM timer: 168 MHz at 20 kHz, counting up and down.
const PWM_STEPS: f64 = 4200.0;
/// A braked or jammed joint is modelled by this inertia of its link [kg·m²].
const HELD: f64 = 1e6;

/// The switches that a hand presses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hands {
    /// The emergency stop.
    pub emergency_stop: bool,
    /// The home switches of joint 1 and joint 4.
    pub home: [bool; 2],
}

/// An arm with its motors, bridges and sensors.
#[derive(Clone, Debug)]
pub struct Plant {
    model: Model,
    state: State,
    wear: Option<WornJoints>,
    /// Drives that are not ideal.
    pub(crate) drives: Option<Drives>,
    encoders: [TrueEncoder; 2],
    delay: Option<Delay>,
    sensors: [JointSensors; 2],
    brakes: [Brake; 2],
    /// Inertia of the driven links without the constraints of the loop [kg·m²].
    free_inertia: [f64; 2],
    /// The supply's voltage [V].
    bus_voltage: f64,
    /// Currents that the bridges do not exceed by themselves [A].
    bridge_limits: [f64; 2],
    contactor: Contactor,
    volts_per_code: f64,
    count_origin: [i32; 2],
    /// Index outputs, on an arm that finds its angles by them.
    indices: Option<[Index; 2]>,
    /// Hard stops, on an arm that finds its angles by them.
    stops: Option<[HardStop; 2]>,
    noise: Noise,
    /// The outputs that the bridges apply now; the latest ones wait for the next period.
    active: ActuatorCommand,
    time: f64,
    /// Scheduled faults, the last one first.
    pending: Vec<PlantFault>,
    pub(crate) faults: ActiveFaults,
    hands: Hands,
    /// Mistakes in the wiring, if any, with the counts from which encoders count.
    wiring: Option<(Wiring, [i32; 2])>,
    /// Ticks that the controller is going to miss.
    late_by: u32,
    /// Ticks that it missed before this one.
    missed_ticks: u32,
    tool_force: Vector2<f64>,
    tool_output: ToolOutputSettings,
}

impl Plant {
    /// The arm with this mismatch, at rest in `pose`. `seed` starts the sensors' noise.
    pub fn new(parameters: &Parameters, mismatch: &Mismatch, pose: &Pose<f64>, seed: u64) -> Self {
        let model = Model::new(parameters, mismatch);
        let mut noise = Noise::new(seed);
        let mut state = model.state_at(pose, [0.0; 4]);
        // In the turn of home: switches and stops are at angles, not at directions.
        for (link, axis) in DRIVEN.into_iter().zip(&parameters.settings.axes) {
            let angle = &mut state.q[link].angular;
            *angle += ((f64::from(axis.home_angle) - *angle) / TAU).round() * TAU;
        }
        let encoder = |joint: Joint| {
            let (known, motor) = (&parameters.encoders[joint], &parameters.motors[joint]);
            TrueEncoder::new(known, motor.gear_ratio, &mismatch.encoder_error[joint])
        };
        let latency =
            |joint: Joint| parameters.encoders[joint].latency + mismatch.encoder_latency[joint];
        let settings = &parameters.settings;
        let encoders = Joint::ALL.map(encoder);
        let drives = Drives::new(
            parameters,
            mismatch,
            RipplePeriods::BRUSHED,
            (&model, &state),
        );
        let sensors = Joint::ALL.map(|joint: Joint| {
            let known = JointSensors::new(settings, mismatch, joint);
            let switch = parameters.switches.map(|switches| switches[joint]);
            JointSensors {
                switch: switch.unwrap_or(known.switch),
                shown_at_home: shown_at(known.home, joint, &encoders[joint], &drives),
                ..known
            }
        });
        let method = settings.home_reference.method;
        let stops =
            (method == HomingMethod::HardStop).then(|| sensors.each_ref().map(HardStop::at_home));
        let indices = (method == HomingMethod::Index)
            .then(|| Joint::ALL.map(|joint: Joint| Index::new(settings.axes[joint].index_counts)));
        let count_origin = count_origin(method, &sensors, &mut noise);
        let mut plant = Self {
            stops,
            indices,
            brakes: Joint::ALL.map(|joint| {
                Brake::new(
                    parameters.brake_torque[joint],
                    parameters.brake_times[joint],
                )
            }),
            free_inertia: DRIVEN.map(|link| model.chain.bodies[link].inertia),
            drives: Some(drives).filter(|drives| !drives.are_ideal()),
            encoders,
            delay: Delay::new(Joint::ALL.map(latency)),
            state,
            model,
            wear: None,
            sensors,
            bus_voltage: parameters.bus_voltage,
            bridge_limits: settings.axes.map(|axis| {
                let over_current = settings.protection.over_current;
                0.5 * f64::from(axis.peak_current + over_current)
            }),
            contactor: Contactor::CLOSED,
            volts_per_code: parameters.volts_per_code,
            count_origin,
            noise,
            active: ActuatorCommand {
                brake: true,
                tool: 0,
                ..ActuatorCommand::default()
            },
            time: 0.0,
            pending: Vec::new(),
            faults: ActiveFaults::default(),
            hands: Hands::default(),
            wiring: None,
            late_by: 0,
            missed_ticks: 0,
            tool_force: Vector2::zeros(),
            tool_output: settings.tool_output,
        };
        plant.record_angles();
        plant
    }

    /// The same with motors that are no brushed ones, each with its gear ratio and its inertia at the shaft [kg·m²]. Their
    /// torques are those of [`Drives::motor_torque`].
    pub(crate) fn with_other_motors(
        parameters: &Parameters,
        rotors: [(f64, f64); 2],
        mismatch: &Mismatch,
        pose: &Pose<f64>,
        seed: u64,
    ) -> Self {
        let mut parameters = parameters.clone();
        for (motor, (gear_ratio, rotor_inertia)) in parameters.motors.iter_mut().zip(rotors) {
            *motor = Motor {
                gear_ratio,
                rotor_inertia,
                // A winding without effect, which needs no short step.
                torque_constant: 0.0,
                resistance: 1.0,
                inductance: 1.0,
                ..*motor
            };
        }
        let mut arm = Self::new(&parameters, mismatch, pose, seed);
        arm.drives = Some(Drives::new(
            &parameters,
            mismatch,
            RipplePeriods::OUTRUNNER,
            (&arm.model, &arm.state),
        ));
        arm
    }

    /// The same arm with worn joints. It is integrated with adaptive steps, and each joint's
    /// contacts are recorded. Its drives must be ideal ([`Plant::drives`] is none).
    #[must_use]
    pub fn worn(mut self, wear: WornJoints) -> Self {
        self.model.chain.constrained = wear.constrained();
        self.wear = Some(wear);
        self
    }

    /// The same arm, integrated in half the step: one as long as L/R makes 1.6 % more of the inductance L.
    #[must_use]
    pub fn with_resolved_windings(mut self) -> Self {
        self.model.finer_steps = 2.0;
        self
    }

    /// Wires the arm like this; an encoder counts wrongly from its present angle on.
    pub fn rewire(&mut self, wiring: &Wiring) {
        let wrong = *wiring != Wiring::default();
        self.wiring = wrong.then(|| (*wiring, Joint::ALL.map(|joint| self.counts(joint))));
    }

    /// Presses these switches, and no others.
    pub fn press(&mut self, hands: Hands) {
        self.hands = hands;
    }

    /// Advances by one tick of `period` [s] in which a hand holds the arm in `pose`, at rest; its
    /// bridges are off.
    pub fn hold_by_hand(&mut self, pose: &Pose<f64>, period: f64) {
        let before = self.state.q;
        self.state = self.model.state_at(pose, [0.0; 4]);
        // The links go on in the turn in which they were.
        for (link, before) in self.state.q.iter_mut().zip(before) {
            link.angular += ((before.angular - link.angular) / TAU).round() * TAU;
        }
        if let Some(drives) = &mut self.drives {
            drives.rest_at(&self.state);
        }
        self.time += period;
        self.missed_ticks = 0;
        self.record_angles();
    }

    /// Samples all sensors at once.
    pub fn sense(&mut self) -> SensorSample {
        let counts =
            Joint::ALL.map(|j| self.faults.frozen_counts[j].unwrap_or_else(|| self.counts(j)));
        let home = Joint::ALL.map(|j| {
            let followed = || self.sensors[j].at_home(self.angle(j));
            self.faults.stuck_switch[j].unwrap_or_else(|| self.hands.home[j] || followed())
        });
        let index = Joint::ALL.map(|j| {
            let turned = counts[j].wrapping_sub(self.count_origin[j]);
            self.indices.is_some_and(|both| both[j].is_shown(turned))
        });
        let current = self.state.current;
        let sample = SensorSample {
            counts,
            drives: BrushedSample {
                current: Joint::ALL
                    .map(|j| self.sensors[j].current_code(current[j], &mut self.noise)),
                bus_voltage: sensors::adc_code(self.bus_voltage() / self.volts_per_code),
            },
            home,
            index,
            emergency_stop: self.is_stopped(),
            driver_fault: self.faults.driver_fault,
            missed_ticks: self.missed_ticks,
        };
        let sample = match &self.wiring {
            None => sample,
            Some((wiring, origin)) => {
                let zero = Joint::ALL.map(|j| self.sensors[j].current_zero_code);
                wiring.seen(sample, *origin, zero)
            }
        };
        self.faults.sensors.seen(sample, &mut self.noise)
    }

    /// Whether the emergency stop's contact is open.
    fn is_stopped(&self) -> bool {
        (self.faults.emergency_stop || self.hands.emergency_stop) && !self.faults.stop_welded
    }

    /// Advances by one tick of `period` [s], and by the ticks that the controller misses.
    /// The bridges apply the outputs of the tick before, because PWM registers load at the
    /// end of their period.
    pub fn step(&mut self, command: &ActuatorCommand, period: f64) {
        for _ in 0..=self.begin_tick() {
            self.advance(command, period);
        }
    }

    /// Injects the faults that are due. Returns the ticks that the controller misses.
    pub(crate) fn begin_tick(&mut self) -> u32 {
        self.inject_due_faults();
        self.missed_ticks = std::mem::take(&mut self.late_by);
        self.missed_ticks
    }

    /// Advances by `period` [s], by the outputs of the call before.
    pub(crate) fn advance(&mut self, command: &ActuatorCommand, period: f64) {
        let (loads, duty) = self.load(command, period);
        if let Some(wear) = &mut self.wear {
            wear.step(&self.model, &mut self.state, &loads, period);
        } else if let Some(step) = self.drives_step(loads, duty, period) {
            step_beside(&mut [step]);
        } else {
            let steps = (period / self.model.longest_step()).ceil().max(1.0);
            for _ in 0..steps as usize {
                self.model.step(&mut self.state, &loads, period / steps);
            }
        }
        self.end(duty);
    }

    /// The step by which an arm whose drives are not ideal advances by `period` [s]; [`Plant::end`] comes after it.
    pub(crate) fn begin(&mut self, command: &ActuatorCommand, period: f64) -> Option<Step<'_>> {
        let (loads, duty) = self.load(command, period);
        self.drives_step(loads, duty, period)
    }

    fn drives_step(&mut self, loads: Loads, duty: [Option<f64>; 2], time: f64) -> Option<Step<'_>> {
        Some(Step {
            drives: self.drives.as_mut()?,
            model: &self.model,
            state: &mut self.state,
            loads,
            duty,
            time,
        })
    }

    /// The loads and the duties of the next `period` [s].
    fn load(&mut self, command: &ActuatorCommand, period: f64) -> (Loads, [Option<f64>; 2]) {
        let command = match &self.wiring {
            None => *command,
            Some((wiring, _)) => wiring.driven(command),
        };
        let applied = std::mem::replace(&mut self.active, command);
        let duty = Joint::ALL.map(|j| self.duty(&applied, j));
        let bus = self.contactor.behind(self.bus_voltage);
        self.contactor.pass(self.is_stopped(), period);
        let loads = Loads {
            voltage: duty.map(|duty| duty.map(|duty| duty * bus)),
            joint_torque: Joint::ALL.map(|j| self.brake(j, applied.brake, period) + self.stop(j)),
            tool_force: self.tool_force + self.catching_force(),
        };
        self.time += period;
        if let Some(drives) = &mut self.drives {
            drives.pen_is_down = self.tool_output.level(applied.tool) > 0.0;
        }
        (loads, duty)
    }

    /// What follows a step by these duties.
    pub(crate) fn end(&mut self, duty: [Option<f64>; 2]) {
        self.limit_currents(duty);
        self.record_angles();
    }

    /// A bridge shorts its motor for a while when its current is at the limit. The mean of that is modelled: a
    /// current that stays at it.
    fn limit_currents(&mut self, duty: [Option<f64>; 2]) {
        for (j, duty) in duty.into_iter().enumerate() {
            let missing = self
                .wiring
                .is_some_and(|(wiring, _)| wiring.bridge_limit_missing[j]);
            let shorted = self.faults.bridges[j] == Some(BridgeDefect::Shorted);
            let Some(duty) = duty.filter(|_| !missing && !shorted) else {
                continue;
            };
            let (current, limit) = (&mut self.state.current[j], self.bridge_limits[j]);
            // A motor that is driven by its joint gets its current from its speed, which no bridge limits.
            if *current * duty > 0.0 && current.abs() > limit {
                *current = limit.copysign(*current);
            }
        }
    }

    /// Records the encoders' shafts for encoders with latency.
    fn record_angles(&mut self) {
        if self.delay.is_some() {
            let [(angle1, speed1), (angle4, speed4)] = Joint::ALL.map(|j| self.shaft(j));
            if let Some(delay) = &mut self.delay {
                delay.record(self.time, [angle1, angle4], [speed1, speed4]);
            }
        }
    }

    /// The duty of a bridge as its compare register holds it; none if it is off.
    fn duty(&self, command: &ActuatorCommand, joint: Joint) -> Option<f64> {
        if !self.is_powered(joint) || !command.enable[joint] {
            return None;
        }
        // The compare register holds whole steps; NaN becomes 0.
        let duty = f64::from(command.drives.duty[joint]).clamp(-1.0, 1.0);
        let register = (duty * PWM_STEPS).round() as i32;
        let duty = f64::from(register) / PWM_STEPS;
        Some(self.faults.bridges[joint].map_or(duty, |defect| defect.acting(duty)))
    }

    /// Engages or releases a brake; returns its torque while it slows its joint down [N·m].
    fn brake(&mut self, joint: Joint, engage: bool, period: f64) -> f64 {
        let omega = self.state.v[DRIVEN[joint]].angular;
        let engage = engage || self.faults.brake_stuck[joint];
        let brake = &mut self.brakes[joint];
        let held = brake.holding;
        brake.command(engage, omega, period);
        let slowing = brake.slowing(omega);
        if brake.holding != held {
            self.hold(joint, !held);
        }
        slowing
    }

    /// The torque of a joint's hard stop [N·m].
    fn stop(&self, joint: Joint) -> f64 {
        let speed = self.state.v[DRIVEN[joint]].angular;
        let stop = self.stops.map(|stops| stops[joint]);
        stop.map_or(0.0, |stop| stop.torque(self.angle(joint), speed))
    }

    /// Holds a joint, or releases it unless it is also jammed.
    fn hold(&mut self, joint: Joint, hold: bool) {
        let link = DRIVEN[joint];
        if hold {
            self.model.chain.bodies[link].inertia = HELD;
            self.state.v[link] = PlanarVector::ZERO;
            self.model
                .chain
                .close_joints(&mut self.state.q, &mut self.state.v);
        } else if !self.faults.stalled[joint] {
            self.model.chain.bodies[link].inertia = self.free_inertia[joint];
        }
    }

    /// Sets the positions and velocities of the links: a test puts the arm where it could not go by itself.
    pub fn set_links(&mut self, links: &State) {
        (self.state.q, self.state.v) = (links.q, links.v);
    }

    /// Sets the time since the start [s].
    pub(crate) fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    /// Sets the external force on the tool [N].
    pub fn set_tool_force(&mut self, force: Vector2<f64>) {
        self.tool_force = force;
    }
}

/// What an encoder shows where its joint rests at `theta` [rad].
fn shown_at(theta: f64, joint: Joint, encoder: &TrueEncoder, drives: &Drives) -> f64 {
    encoder.measured(match encoder.side {
        EncoderSide::Motor => drives.rotor_at(joint, theta),
        EncoderSide::Joint => theta,
    })
}

/// The counts at home. Incremental counters start anywhere, absolute ones in any turn.
fn count_origin(method: HomingMethod, sensors: &[JointSensors; 2], noise: &mut Noise) -> [i32; 2] {
    let start = [noise.integer(), noise.integer()];
    match method {
        HomingMethod::Absolute => Joint::ALL.map(|j| sensors[j].absolute_origin(start[j] % 3)),
        HomingMethod::Switch
        | HomingMethod::HardStop
        | HomingMethod::Given
        | HomingMethod::Index => start,
    }
}
