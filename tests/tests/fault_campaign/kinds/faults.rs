//! The faults of the campaign over the kinds of drive, where each can come, and why not elsewhere.

use super::drives::Drive;
use super::faulted::Fault;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Wiring};
use oorandom::Rand64;

/// When a fault comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum During {
    Homing,
    Travel,
    Resting,
    DrawingSlowly,
    DrawingFast,
}

impl During {
    pub(crate) const ALL: [Self; 5] = [
        Self::Homing,
        Self::Travel,
        Self::Resting,
        Self::DrawingSlowly,
        Self::DrawingFast,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Homing => "homing",
            Self::Travel => "travel",
            Self::Resting => "resting",
            Self::DrawingSlowly => "drawing slowly",
            Self::DrawingFast => "drawing fast",
        }
    }
}

/// Why a fault is not injected into a kind of drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Not {
    NoEncoder,
    NoIndex,
    NoCurrentSensor,
    NoBusSensor,
    NoBridge,
    NoWindings,
    NoSteps,
    NoBus,
    NoEnable,
    NoFaultOutput,
    NoSwitch,
    Rigid,
    SlipOfEncoder,
    OwnLoop,
}

impl Not {
    pub(crate) const ALL: [Self; 14] = [
        Self::NoEncoder,
        Self::NoIndex,
        Self::NoCurrentSensor,
        Self::NoBusSensor,
        Self::NoBridge,
        Self::NoWindings,
        Self::NoSteps,
        Self::NoBus,
        Self::NoEnable,
        Self::NoFaultOutput,
        Self::NoSwitch,
        Self::Rigid,
        Self::SlipOfEncoder,
        Self::OwnLoop,
    ];

    /// Its letter in the table.
    pub(crate) fn letter(self) -> char {
        let index = Self::ALL.iter().position(|&not| not == self);
        char::from(b'a' + index.expect("it is listed") as u8)
    }

    pub(crate) fn reason(self) -> &'static str {
        match self {
            Self::NoEncoder => "no encoder on the controller's inputs",
            Self::NoIndex => "no index output in this arm",
            Self::NoCurrentSensor => "the controller measures no current",
            Self::NoBusSensor => "the controller measures no bus voltage",
            Self::NoBridge => "the board has no bridge of its own for this motor",
            Self::NoWindings => "these windings are not simulated one by one",
            Self::NoSteps => "no steps",
            Self::NoBus => "no CAN bus",
            Self::NoEnable => "the drive has no enable wire",
            Self::NoFaultOutput => {
                "no fault output: the drive tells its errors on the bus or not at all"
            }
            Self::NoSwitch => "no home switch",
            Self::Rigid => "the arm of this kind has no elastic belt",
            Self::SlipOfEncoder => "a slip is simulated before an encoder only",
            Self::OwnLoop => "the drive's supply and contactor are its own",
        }
    }
}

/// A fault of the campaign.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    make: fn(&mut Draw<'_>) -> Fault,
    /// Why a kind of drive does not have it.
    not: fn(Drive) -> Option<Not>,
    /// Whether it is there from power-up on only.
    pub(crate) is_built_in: bool,
}

impl Row {
    pub(crate) fn not(&self, drive: Drive) -> Option<Not> {
        (self.not)(drive)
    }

    pub(crate) fn states(&self) -> &'static [During] {
        if self.is_built_in {
            &During::ALL[..1]
        } else {
            &During::ALL
        }
    }

    /// A random fault of this kind. `bus_voltage` is the nominal one [V].
    pub(crate) fn fault(&self, random: &mut Rand64, bus_voltage: f64) -> Fault {
        let joint = Joint::ALL[random.rand_range(0..2) as usize];
        (self.make)(&mut Draw {
            random,
            joint,
            bus_voltage,
        })
    }
}

/// Random values for a fault.
struct Draw<'a> {
    random: &'a mut Rand64,
    joint: Joint,
    bus_voltage: f64,
}

impl Draw<'_> {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random.rand_float()
    }

    fn whole(&mut self, low: u64, high: u64) -> u64 {
        self.random.rand_range(low..high + 1)
    }

    fn sign(&mut self) -> f64 {
        if self.random.rand_range(0..2) == 1 {
            1.0
        } else {
            -1.0
        }
    }

    /// A mistake in the wiring of the joint.
    fn wiring(&self, make: impl FnOnce(&mut Wiring, Joint)) -> Fault {
        let mut wiring = Wiring::default();
        make(&mut wiring, self.joint);
        Fault::Wiring(wiring)
    }

    /// −1, 1/2, 2, or any factor around 1.
    fn gain(&mut self) -> f64 {
        match self.whole(0, 3) {
            0 => -1.0,
            1 => 0.5,
            2 => 2.0,
            _ => self.between(0.1, 1.9),
        }
    }
}

fn any(_: Drive) -> Option<Not> {
    None
}

fn brushed(drive: Drive, why: Not) -> Option<Not> {
    (drive != Drive::Brushed).then_some(why)
}

fn encoder(drive: Drive) -> Option<Not> {
    (!drive.is_measured()).then_some(Not::NoEncoder)
}

/// Of an encoder on the controller's own inputs.
fn own_encoder(drive: Drive) -> Option<Not> {
    let has = matches!(drive, Drive::Brushed | Drive::StepperWithEncoder);
    (!has).then_some(Not::NoEncoder)
}

fn current(drive: Drive) -> Option<Not> {
    brushed(drive, Not::NoCurrentSensor)
}

fn divider(drive: Drive) -> Option<Not> {
    brushed(drive, Not::NoBusSensor)
}

fn bridge(drive: Drive) -> Option<Not> {
    brushed(drive, Not::NoBridge)
}

fn output(drive: Drive) -> Option<Not> {
    let has = drive == Drive::Brushed || drive.has_steps();
    (!has).then_some(Not::NoFaultOutput)
}

fn enable(drive: Drive) -> Option<Not> {
    drive.is_on_bus().then_some(Not::NoEnable)
}

fn supply(drive: Drive) -> Option<Not> {
    drive.is_on_bus().then_some(Not::OwnLoop)
}

fn steps(drive: Drive) -> Option<Not> {
    (!drive.has_steps()).then_some(Not::NoSteps)
}

fn bus(drive: Drive) -> Option<Not> {
    (!drive.is_on_bus()).then_some(Not::NoBus)
}

/// Every fault.
#[rustfmt::skip]
pub(crate) const ROWS: &[Row] = &[
    row("encoder_dead", encoder, |d| Fault::Plant(FaultKind::EncoderDead { joint: d.joint })),
    row("encoder_jump", encoder, |d| {
        let counts = (d.sign() * d.between(1.0, 2000.0)) as i32;
        Fault::Plant(FaultKind::EncoderJump { joint: d.joint, counts })
    }),
    row("encoder_gain", encoder, |d| Fault::Plant(FaultKind::EncoderGain { joint: d.joint, gain: d.gain() })),
    row("encoder_late", |drive| brushed(drive, Not::NoEncoder), |d| {
        Fault::Plant(FaultKind::EncoderLate { joint: d.joint, ticks: d.whole(2, 100) as u32 })
    }),
    row("encoder_channel_stuck", own_encoder, |d| Fault::Plant(FaultKind::EncoderChannelStuck { joint: d.joint })),
    row("encoder_noise", encoder, |d| {
        Fault::Plant(FaultKind::EncoderNoise { joint: d.joint, counts: d.whole(1, 100) as i32 })
    }),
    row("index_stuck", |_| Some(Not::NoIndex), |d| {
        Fault::Plant(FaultKind::IndexStuck { joint: d.joint, high: true })
    }),
    row("switch_stuck", |drive| (drive == Drive::HobbyServo).then_some(Not::NoSwitch), |d| {
        let pressed = d.sign() > 0.0;
        Fault::Plant(FaultKind::SwitchStuck { joint: d.joint, pressed })
    }),
    row("current_offset", current, |d| {
        let amperes = d.between(-10.0, 10.0);
        Fault::Plant(FaultKind::CurrentOffset { joint: d.joint, amperes })
    }),
    row("current_dead", current, |d| Fault::Plant(FaultKind::CurrentDead { joint: d.joint })),
    row("current_gain", current, |d| Fault::Plant(FaultKind::CurrentGain { joint: d.joint, gain: d.gain() })),
    row("current_stuck", current, |d| {
        let amperes = d.between(-5.0, 5.0);
        Fault::Plant(FaultKind::CurrentStuck { joint: d.joint, amperes })
    }),
    row("current_late", current, |d| {
        Fault::Plant(FaultKind::CurrentLate { joint: d.joint, ticks: d.whole(1, 20) as u32 })
    }),
    row("bus_voltage", supply, |d| {
        let volts = d.bus_voltage * d.between(0.0, 1.8);
        Fault::Plant(FaultKind::BusVoltage { volts })
    }),
    row("bus_sensor_stuck", divider, |_| Fault::Plant(FaultKind::BusSensorStuck)),
    row("bus_sensor_gain", divider, |d| Fault::Plant(FaultKind::BusSensorGain { gain: d.between(0.0, 1.8) })),
    row("motor_disconnected", any, |d| Fault::Plant(FaultKind::MotorDisconnected { joint: d.joint })),
    row("winding_shorted", |drive| brushed(drive, Not::NoWindings), |d| {
        Fault::Plant(FaultKind::WindingShorted { joint: d.joint })
    }),
    row("phase_open", |drive| (!drive.has_steps()).then_some(Not::NoWindings), |d| {
        Fault::Plant(FaultKind::PhaseOpen { joint: d.joint })
    }),
    row("motor_stalled", any, |d| Fault::Plant(FaultKind::MotorStalled { joint: d.joint })),
    Row {
        name: "torque_constant", not: any, is_built_in: true,
        make: |d| { let share = d.sign() * d.between(0.2, 0.6); Fault::TorqueConstant(d.joint, share) },
    },
    row("bridge_one_direction", bridge, |d| Fault::Plant(FaultKind::BridgeOneDirection { joint: d.joint })),
    row("bridge_shorted", bridge, |d| Fault::Plant(FaultKind::BridgeShorted { joint: d.joint })),
    row("duty_stuck", bridge, |d| Fault::Plant(FaultKind::DutyStuck { joint: d.joint })),
    row("driver_fault", output, |d| Fault::Plant(FaultKind::DriverFault { joint: d.joint })),
    row("driver_fault_stuck", output, |d| Fault::Plant(FaultKind::DriverFaultStuck { joint: d.joint })),
    row("driver_fault_open", output, |d| Fault::Plant(FaultKind::DriverFaultOpen { joint: d.joint })),
    row("enable_open", enable, |d| d.wiring(|wiring, j| (wiring.enable_dead[j], wiring.signal_dead[j]) = (true, true))),
    row("direction_reversed", |drive| match drive {
        Drive::Brushed => Some(Not::NoSteps),
        drive if drive.is_on_bus() => Some(Not::NoSteps),
        _ => None,
    }, |d| d.wiring(|wiring, j| wiring.motor_reversed[j] = true)),
    row("microsteps_wrong", steps, |d| {
        let factor = if d.sign() > 0.0 { 0.5 } else { 2.0 };
        d.wiring(|wiring, j| wiring.microsteps[j] = factor)
    }),
    row("step_lost", steps, |d| {
        Fault::Plant(FaultKind::StepLost { joint: d.joint, steps: d.whole(1, 40) as u32 })
    }),
    row("can_silent", bus, |d| Fault::Plant(FaultKind::CanSilent { joint: d.joint })),
    row("can_reset", bus, |d| Fault::Plant(FaultKind::CanReset { joint: d.joint })),
    row("can_bus_off", bus, |_| Fault::Plant(FaultKind::CanBusOff)),
    row("answers_stale", bus, |d| Fault::StaleAnswers(d.joint)),
    row("answers_lost", bus, |d| d.wiring(|wiring, j| wiring.answers_lost[j] = 1.0)),
    row("orders_lost", bus, |d| d.wiring(|wiring, j| wiring.orders_lost[j] = 1.0)),
    row("answers_late", bus, |d| { let most = d.between(1e-4, 3e-3); Fault::AnswersLate(d.joint, most) }),
    row("mode_lost", bus, |d| Fault::ModeLost(d.joint)),
    row("drive_broken", bus, |d| Fault::DriveBroken(d.joint)),
    row("same_id", bus, |d| d.wiring(|wiring, j| wiring.node_of_other[j] = true)),
    row("emergency_stop", any, |_| Fault::Plant(FaultKind::EmergencyStop)),
    row("emergency_stop_welded", any, |_| Fault::Plant(FaultKind::EmergencyStopWelded)),
    row("contactor_welded", supply, |_| Fault::Plant(FaultKind::ContactorWelded)),
    row("brake_stuck", any, |d| Fault::Plant(FaultKind::BrakeStuck { joint: d.joint })),
    row("brake_late", any, |d| { let seconds = d.between(0.0, 0.5); Fault::Plant(FaultKind::BrakeLate { joint: d.joint, seconds }) }),
    row("brake_fails", any, |d| Fault::Plant(FaultKind::BrakeFails { joint: d.joint })),
    row("coupling_slips", |drive| match drive {
        Drive::Stepper | Drive::HobbyServo => Some(Not::SlipOfEncoder),
        _ => None,
    }, |d| { let share = d.between(0.02, 0.9); Fault::Plant(FaultKind::CouplingSlips { joint: d.joint, share }) }),
    row("belt_breaks", |drive| brushed(drive, Not::Rigid), |d| Fault::Plant(FaultKind::BeltBreaks { joint: d.joint })),
    row("payload_changes", any, |d| Fault::Plant(FaultKind::PayloadChanges { kilograms: d.between(0.0, 0.2) })),
    row("tool_caught", any, |_| Fault::Plant(FaultKind::ToolCaught)),
    row("ticks_missed", any, |d| Fault::Plant(FaultKind::TicksMissed { ticks: d.whole(1, 50) as u32 })),
];

const fn row(
    name: &'static str,
    not: fn(Drive) -> Option<Not>,
    make: fn(&mut Draw<'_>) -> Fault,
) -> Row {
    Row {
        name,
        make,
        not,
        is_built_in: false,
    }
}
