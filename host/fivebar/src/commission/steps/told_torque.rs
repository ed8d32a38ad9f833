//! The step that compares the torque which drives on a bus are told to give with the torque that they give.
//!
//! A drive gives c times what it is told, because its torque constant is off by c. It is told τ by the controller, and its own
//! spring and damper add k e + d ė for the error e of its joint. The motion needs the torque τₘ of the model, so
//! c (τ + k e + d ė) = τₘ: a straight line through the origin of (τₘ, τ + k e + d ė) has the slope 1/c. A status tells angles that
//! are older than its motion, which the damper makes much of: 1 ms changes the slope by 0.4, and the stiffer the spring, the less
//! of c is left in it. So the arm of the file is simulated with the same strokes, with c = 1 and with another c, and c is where
//! the slopes of both, as a power of c, meet that of the arm.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::line::Line;
use super::super::operator::Task;
use super::super::record::Value;
use super::super::simulated;
use super::{Outcome, strokes};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::DriveStiffness;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::{Move, Request, Settings, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Mismatch;
use fivebar_sim::drive::Drive;
use fivebar_sim::link::Client;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// The share of its torque that each stroke takes: gently at first, because a drive that gives far too little does not keep
/// the arm to fast strokes; then fast, because they tell c within a few hundredths.
const SHARES: [f64; 2] = [0.3, 0.5];
/// By how much c may be off 1: at first, where little torque tells it within a tenth or two; and then, because masses and
/// friction of a robot file are seldom better known.
const TOLERANCES: [f64; 2] = [0.3, 0.2];
/// A slope so near that of the file's arm is not looked at more closely.
const SAME: f64 = 0.02;
/// Least torque of the strokes, over that of the file's friction: below it friction tells more than the torque.
const LEAST: f64 = 2.0;

/// A joint that is slower stands, or turns its way about [rad/s].
const STILL: f64 = 1e-3;

/// Sums of a line through the origin.
#[derive(Default)]
struct Sums {
    /// Σ τₘ², Σ τₘ (τ + k e + d ė) and the greatest τₘ.
    squares: f64,
    products: f64,
    greatest: f64,
}

/// What a status tells of a joint.
#[derive(Clone, Copy)]
struct Sample {
    tick: u32,
    /// The torque that the model needs, and the one that the controller tells the drive [N·m].
    needed: f64,
    told: f64,
    /// How far the joint is behind its motion [rad].
    error: f64,
}

impl Sample {
    /// None where the arm follows no motion.
    fn of(robot: &Robot, status: &Status, joint: Joint) -> Option<Self> {
        let motion = status.joint_reference?;
        let actuator = robot.actuators?[joint];
        let [theta1, theta4] = motion.angle.map(f64::from);
        let (omega, alpha) = (
            motion.velocity.map(f64::from),
            motion.acceleration.map(f64::from),
        );
        let geometry = &robot.geometry;
        let assembly = robot.home_pose().ok()?.assembly();
        let pose = geometry.forward(theta1, theta4, assembly).ok()?;
        let velocities = geometry
            .forward_velocities(&pose, omega[0], omega[1])
            .ok()?;
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, alpha[0], alpha[1])
            .ok()?;
        let torque = robot.arm().ok()?.inverse_dynamics(
            &pose,
            &velocities,
            &accelerations,
            Vector2::zeros(),
        );
        let coulomb = match omega[joint].abs() > STILL {
            true => actuator.coulomb_friction.copysign(omega[joint]),
            false => 0.0,
        };
        let viscous = actuator.viscous_friction * omega[joint];
        let error = f64::from(motion.angle[joint] - status.angle[joint]);
        Some(Self {
            tick: status.tick,
            needed: torque.ok()?[joint] + coulomb + viscous,
            told: status.torque[joint].into(),
            error: error - (error / TAU).round() * TAU,
        })
    }
}

pub(in super::super) fn told_torque(bench: &mut Bench) -> Result<Outcome, StepError> {
    bench.upload()?;
    bench.home()?;
    let robot = bench.robot.clone();
    let mut values = Vec::new();
    let mut found = Vec::new();
    for joint in Joint::ALL {
        let mut gives = 1.0;
        for (share, tolerance) in SHARES.into_iter().zip(TOLERANCES) {
            gives = share_of(bench, &robot, joint, share, tolerance)?;
        }
        found.push(format!("{joint} {gives:.2}"));
        let name = format!("torque{}_share", joint.number());
        let origin = "torque that the drive gives, over the torque that it is told";
        values.push(Value::new(name, gives, origin));
    }
    let found = found.join(", ");
    Ok(Outcome::new(
        format!("the drives give this share of the torque that they are told: {found}"),
        values,
    ))
}

/// c, of strokes that take this share of the torque; an error if it is further off 1 than this.
fn share_of(
    bench: &mut Bench,
    robot: &Robot,
    joint: Joint,
    share: f64,
    tolerance: f64,
) -> Result<f64, StepError> {
    let moves = strokes::plan(bench, robot, joint, share)?;
    let settings = bench.settings;
    let line = tried(&mut bench.client, robot, &settings, &moves, joint)?;
    // The simulation below takes longer than a powered arm waits for its host.
    bench.power_off()?;
    let friction = bench.drive(joint)?.coulomb_friction;
    if line.greatest < LEAST * friction {
        return Err(StepError::wrong(
            format_args!(
                "{joint} cannot be moved fast enough to tell its torque from its friction: {:.2} N·m of {friction:.2} N·m",
                line.greatest
            ),
            "raise [motion] max_speed and max_acceleration of the robot file",
        ));
    }
    let with = |gives| as_in_its_file(robot, &settings, &moves, joint, gives);
    let gives = share_given(line.gives(), with)?;
    if !(1.0 - tolerance..=1.0 + tolerance).contains(&gives) {
        return Err(StepError::wrong(
            format_args!(
                "the torque constant of {joint} is wrong: its drive gives {gives:.2} times the torque that it is told to"
            ),
            "set the drive's torque constant (8.27 over the motor's rpm/V) or correct torque_constant; if both are right, \
             correct the masses of the links or the rotor's inertia",
        ));
    }
    Ok(gives)
}

/// Draws the strokes with a homed arm.
fn tried(
    client: &mut Client<Box<dyn Line>>,
    robot: &Robot,
    settings: &Settings,
    moves: &[Move],
    joint: Joint,
) -> Result<Sums, StepError> {
    let checked = settings.check().map_err(StepError::other)?;
    let stiffness = DriveStiffness::of(&checked);
    let (mut line, mut last) = (Sums::default(), None::<Sample>);
    let mut take = |_: usize, status: &Status| {
        let now = Sample::of(robot, status, joint);
        if let (Some(before), Some(now)) = (&last, &now) {
            line.add_between(before, now, &stiffness[joint], robot.control.tick_rate);
        }
        last = now;
    };
    Drive::new(client, &|| false).follow(moves, settings, &mut take)?;
    Ok(line)
}

/// c of an arm whose strokes show this slope, if those of the file's arm show `shows` of its c.
fn share_given(
    slope: f64,
    shows: impl Fn(f64) -> Result<f64, StepError>,
) -> Result<f64, StepError> {
    let right = shows(1.0)?;
    let ratio = slope / right;
    if (ratio - 1.0).abs() < SAME {
        return Ok(ratio);
    }
    // About twice as far off, as the spring and the damper hide part of c.
    let other = (ratio * ratio).clamp(0.3, 3.0);
    let power = (shows(other)? / right).ln() / other.ln();
    Ok((ratio.ln() / power).exp())
}

/// The slope that the same strokes show on a simulated arm that is as its file says, under the declared mismatch, but for its
/// drive, which gives this share of the torque that it is told.
fn as_in_its_file(
    robot: &Robot,
    settings: &Settings,
    moves: &[Move],
    joint: Joint,
    gives: f64,
) -> Result<f64, StepError> {
    let mut scenario = Scenario::demonstration(robot.clone());
    // A built arm is rather heavier than its file: by as much as the declared mismatch has it.
    scenario.mismatch = Mismatch::default();
    if let Some(off) = scenario.mismatch.torque_constant.get_mut(joint.index()) {
        *off = gives - 1.0;
    }
    let (line, actions) = simulated::arm(&scenario, robot)?;
    let (mut client, _) = Client::open(line)?;
    Drive::new(&mut client, &|| false).store_settings(settings)?;
    // It stands at its home angles by hand.
    actions.begin(&Task::Home)?;
    while !actions.is_done() {
        client.poll()?;
    }
    let home = HostCommand::Request(Request::SetAngles(robot.home.map(|angle| angle as f32)));
    client.command(home)?.map_err(StepError::other)?;
    actions.begin(&Task::LetGo)?;
    Ok(tried(&mut client, robot, settings, moves, joint)?.gives())
}

impl Sums {
    /// The means of the time between two samples: there the damper adds d times the mean rate of the error.
    fn add_between(&mut self, from: &Sample, to: &Sample, of: &DriveStiffness, tick_rate: f64) {
        let time = f64::from(to.tick.wrapping_sub(from.tick)) / tick_rate;
        if time > 0.0 {
            let spring = f64::from(of.stiffness) * 0.5 * (from.error + to.error);
            let damper = f64::from(of.damping) * (to.error - from.error) / time;
            let told = 0.5 * (from.told + to.told) + spring + damper;
            self.add(0.5 * (from.needed + to.needed), told);
        }
    }

    fn add(&mut self, needed: f64, told: f64) {
        self.squares += needed * needed;
        self.products += needed * told;
        self.greatest = self.greatest.max(needed.abs());
    }

    /// c.
    fn gives(&self) -> f64 {
        self.squares / self.products
    }
}

#[cfg(test)]
mod tests {
    use super::{Sums, share_given};

    /// The spring and the damper hide half of c, and what is shown of 1 is off by a third.
    #[test]
    fn what_the_springs_hide_of_the_share_is_found() {
        for gives in [0.4_f64, 0.9, 1.0, 1.01, 1.4, 2.0] {
            let found = share_given(0.7 * gives.sqrt(), |of| Ok(0.7 * of.sqrt())).unwrap();
            assert!((found - gives).abs() < 0.01 * gives, "{found} for {gives}");
        }
    }

    #[test]
    fn the_share_is_found_from_what_the_drive_is_told() {
        for gives in [0.5, 1.0, 1.5] {
            let mut line = Sums::default();
            for needed in [-0.4, 0.1, 0.7] {
                line.add(needed, needed / gives);
            }
            assert!((line.gives() - gives).abs() < 1e-12, "{gives}");
            assert_eq!(line.greatest, 0.7);
        }
    }
}
