//! The link between the tick and two drives on a bus: commands out, answers in, and how old these are.

use super::{BusSetup, Frame, mit, odrive};
use crate::drives::{DriveHealth, DriveStiffness, OLDEST_ANSWER, TorqueSample, TorqueSetPoint};
use crate::settings::CheckedSettings;
use core::f32::consts::TAU;
use heapless::Vec;

/// Frames that are sent in a tick, at most.
pub const MOST_FRAMES: usize = 4;

/// The frames of a tick.
pub type Frames = Vec<Frame, MOST_FRAMES>;

/// Heartbeats that may be missing.
const MISSING_HEARTBEATS: f32 = 5.0;

/// What the drives speak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Protocol {
    /// CANSimple of ODrive.
    Odrive,
    /// That of the MIT Mini Cheetah's drives, with the ranges of these.
    Mit(mit::Ranges),
}

impl Protocol {
    /// The torque at a drive's shaft that a frame holds of this one [N·m].
    pub fn torque_in_frame(&self, torque: f32) -> f32 {
        match self {
            Self::Odrive => odrive::torque_in_frame(torque),
            Self::Mit(ranges) => mit::torque_in_frame(torque, ranges),
        }
    }
}

/// The link to the drives of joint 1 and joint 4.
#[derive(Clone, Debug)]
pub struct Link {
    protocol: Protocol,
    drives: [Drive; 2],
    /// Ticks after which a drive without a heartbeat is silent.
    heartbeat_ticks: u16,
    /// Time of a tick [s].
    period: f32,
}

/// What the link knows of one drive.
#[derive(Clone, Debug)]
struct Drive {
    node: u8,
    /// Motor turns per joint turn.
    gear_ratio: f32,
    /// Of the encoder.
    counts_per_turn: f32,
    /// Where its shaft is, and how fast it turned at its last answer [turns/s].
    turns: f32,
    speed: f32,
    /// At its shaft [N·m/rad], [N·m·s/rad].
    stiffness: f32,
    damping: f32,
    /// What it gives at its shaft [N·m]; ODrive has no room on the bus to tell it, and gives what it is asked for.
    torque: f32,
    health: DriveHealth,
    /// Ticks since the last answer, and since the last heartbeat.
    age: u16,
    heartbeat_age: u16,
    /// Ticks for which it is to give torque, at most [`STARTED`].
    enabled: u8,
    /// It has told once that it gives torque, so not telling it means that it gives none.
    tells_state: bool,
    /// Ticks for which an error that it tells may be the one that it was told to clear.
    clearing: u8,
}

/// What a drive is to do in a tick, besides its motion.
#[derive(Clone, Copy)]
struct DriveOrder {
    /// Give torque.
    enable: bool,
    /// Make its spring and damper. ODrive has these gains from its start on, and its position is exact.
    is_stiff: bool,
    /// Clear its errors, in the place of all else.
    clears: bool,
}

/// Ticks after which a drive has got all that makes it give torque.
const STARTED: u8 = 4;
/// Ticks after the order to clear its errors for which a drive may still tell them: what it sent before the order came,
/// and what is as late as an answer may be. A drive tells an error that stays again later.
const CLEARING: u8 = OLDEST_ANSWER as u8 + 1;

impl Link {
    /// The link to the drives of these nodes, on an arm of these settings.
    pub fn new(protocol: Protocol, nodes: [u8; 2], settings: &CheckedSettings) -> Self {
        let [axis1, axis4] = &settings.axes;
        let [node1, node4] = nodes;
        let [stiffness1, stiffness4] = DriveStiffness::of(settings);
        let heartbeats = MISSING_HEARTBEATS * odrive::PERIOD;
        Self {
            protocol,
            drives: [(axis1, node1, stiffness1), (axis4, node4, stiffness4)].map(
                |(axis, node, of)| Drive {
                    node,
                    stiffness: of.stiffness / (axis.gear_ratio * axis.gear_ratio),
                    damping: of.damping / (axis.gear_ratio * axis.gear_ratio),
                    gear_ratio: axis.gear_ratio,
                    counts_per_turn: axis.encoder_counts as f32,
                    turns: 0.0,
                    speed: 0.0,
                    torque: 0.0,
                    health: DriveHealth::Off,
                    age: u16::MAX,
                    heartbeat_age: u16::MAX,
                    enabled: 0,
                    tells_state: false,
                    clearing: 0,
                },
            ),
            // `as` saturates, and cuts.
            heartbeat_ticks: (heartbeats * settings.control.tick_rate + 0.5) as u16,
            period: 1.0 / settings.control.tick_rate,
        }
    }

    /// The link to the drives that these settings name; none if they name none.
    pub fn of(settings: &CheckedSettings) -> Option<Self> {
        let BusSetup { protocol, nodes } = BusSetup::of(settings)?;
        Some(Self::new(protocol, nodes, settings))
    }

    /// Takes a frame from the bus over; those of others are ignored.
    pub fn receive(&mut self, frame: &Frame) {
        match &self.protocol {
            Protocol::Odrive => {
                if let Some((node, message)) = odrive::Message::decode(frame)
                    && let Some(drive) = self.drives.iter_mut().find(|it| it.node == node)
                {
                    drive.told(&message);
                }
            }
            Protocol::Mit(ranges) => {
                if let Some(data) = &frame.data
                    && let reply = mit::Reply::decode(data, ranges)
                    && let Some(drive) = self.drives.iter_mut().find(|it| it.node == reply.node)
                {
                    drive.replied(&reply);
                }
            }
        }
    }

    /// The drives' counts and the rest of a tick's sample, once in each tick: answers grow old by a tick. In the place
    /// of an answer that is late, the shaft has turned on as fast as it did.
    pub fn sample(&mut self, bus_off: bool) -> ([i32; 2], TorqueSample) {
        let needs_heartbeat = self.protocol == Protocol::Odrive;
        for drive in &mut self.drives {
            drive.age = drive.age.saturating_add(1);
            drive.heartbeat_age = drive.heartbeat_age.saturating_add(1);
            drive.clearing = drive.clearing.saturating_sub(1);
            if (2..=OLDEST_ANSWER).contains(&drive.age) {
                drive.turns += drive.speed * self.period;
            }
        }
        let [drive1, drive4] = &self.drives;
        let age = |drive: &Drive| match needs_heartbeat {
            true if drive.heartbeat_age > self.heartbeat_ticks => u16::MAX,
            _ => drive.age,
        };
        let sample = TorqueSample {
            torque: [drive1, drive4].map(|drive| drive.torque * drive.gear_ratio),
            age: [age(drive1), age(drive4)],
            health: [drive1.health, drive4.health],
            bus_off,
        };
        ([drive1.counts(), drive4.counts()], sample)
    }

    /// Makes the frames of a tick: commands first, so that the torques are at the drives as soon as can be.
    pub fn send(&mut self, enable: [bool; 2], set_point: &TorqueSetPoint, frames: &mut Frames) {
        frames.clear();
        let ([torque1, torque4], [ahead1, ahead4]) = (set_point.torque, set_point.ahead);
        let ([omega1, omega4], [enable1, enable4]) = (set_point.velocity, enable);
        let [drive1, drive4] = &mut self.drives;
        let order = |enable| DriveOrder {
            enable,
            is_stiff: set_point.is_stiff,
            clears: set_point.clear_errors,
        };
        // Two drives have two frames each at most.
        let _ =
            frames.push(drive1.command(&self.protocol, order(enable1), [torque1, ahead1, omega1]));
        let _ =
            frames.push(drive4.command(&self.protocol, order(enable4), [torque4, ahead4, omega4]));
        if self.protocol == Protocol::Odrive {
            for drive in [drive1, drive4] {
                let _ = frames.push(odrive::ask_for_estimates(drive.node));
            }
        }
    }
}

impl Drive {
    /// This tick's command, for a torque [N·m], an angle from where the joint was sensed [rad] and a velocity [rad/s], at the
    /// joint. Errors are cleared in the place of it.
    fn command(
        &mut self,
        protocol: &Protocol,
        DriveOrder {
            enable,
            is_stiff,
            clears,
        }: DriveOrder,
        wanted: [f32; 3],
    ) -> Frame {
        if clears && let Some(frame) = self.clear(protocol) {
            return frame;
        }
        let before = self.enabled;
        self.enabled = match enable {
            true if before < STARTED => before + 1,
            true => before,
            false => 0,
        };
        let [torque, ahead, omega] = if enable { wanted } else { [0.0; 3] };
        let turns = self.turns + ahead * self.gear_ratio / TAU;
        let (omega, drive_torque) = (omega * self.gear_ratio, torque / self.gear_ratio);
        let node = self.node;
        match (protocol, before, enable) {
            (Protocol::Odrive, 0, true) => odrive::set_mode(node),
            (Protocol::Odrive, 1, true) => {
                odrive::set_position_gain(node, self.stiffness / self.damping)
            }
            (Protocol::Odrive, 2, true) => odrive::set_velocity_gain(node, TAU * self.damping),
            (Protocol::Odrive, 3, true) => odrive::set_axis_state(node, odrive::CLOSED_LOOP),
            // As long as it tells that it drives, in case the frame was lost.
            (Protocol::Odrive, before, false)
                if before > 0 || self.health == DriveHealth::Drives =>
            {
                self.torque = 0.0;
                odrive::set_axis_state(node, odrive::IDLE)
            }
            // Also without power: its watchdog wants commands.
            (Protocol::Odrive, ..) => {
                self.torque = drive_torque;
                odrive::set_input(node, turns, omega / TAU, drive_torque)
            }
            (Protocol::Mit(_), 0, true) => mit::enable(node, true),
            (Protocol::Mit(ranges), _, true) => {
                let command = mit::Command {
                    position: turns * TAU,
                    velocity: omega,
                    stiffness: if is_stiff { self.stiffness } else { 0.0 },
                    damping: if is_stiff { self.damping } else { 0.0 },
                    torque: drive_torque,
                };
                Frame::new(node.into(), command.encode(ranges))
            }
            (Protocol::Mit(_), _, false) => mit::enable(node, false),
        }
    }

    /// The frame that clears its errors, if it may get one. Until it tells an error again, it has none.
    fn clear(&mut self, protocol: &Protocol) -> Option<Frame> {
        let frame = match protocol {
            Protocol::Odrive => odrive::clear_errors(self.node),
            Protocol::Mit(_) if self.health == DriveHealth::Error => mit::clear_error(self.node),
            Protocol::Mit(_) => return None,
        };
        self.torque = 0.0;
        self.health = DriveHealth::Off;
        self.clearing = CLEARING;
        Some(frame)
    }

    fn told(&mut self, message: &odrive::Message) {
        match *message {
            odrive::Message::Heartbeat { error, state } => {
                self.heartbeat_age = 0;
                self.health = match (error, state) {
                    (0, odrive::CLOSED_LOOP) => DriveHealth::Drives,
                    (0, _) => DriveHealth::Off,
                    _ => self.error(),
                };
            }
            odrive::Message::Estimates { position, velocity } => self.is_at(position, velocity),
        }
    }

    fn replied(&mut self, reply: &mit::Reply) {
        self.tells_state |= reply.is_enabled();
        self.health = if reply.is_error() {
            self.error()
        } else if reply.is_enabled() || !self.tells_state {
            DriveHealth::Drives
        } else {
            DriveHealth::Off
        };
        self.torque = reply.torque;
        self.is_at(reply.position / TAU, reply.velocity / TAU);
    }

    /// What an error that it tells means.
    fn error(&self) -> DriveHealth {
        match self.clearing {
            0 => DriveHealth::Error,
            _ => DriveHealth::Off,
        }
    }

    /// An answer: the shaft is at this position [turns], with this speed [turns/s]. One that is not a number is none.
    fn is_at(&mut self, turns: f32, speed: f32) {
        if turns.is_finite() && speed.is_finite() {
            self.turns = turns;
            self.speed = speed;
            self.age = 0;
        }
    }

    /// The nearest count.
    fn counts(&self) -> i32 {
        let counts = self.turns * self.counts_per_turn;
        // `as` saturates, and cuts towards 0.
        (counts + if counts < 0.0 { -0.5 } else { 0.5 }) as i32
    }
}
