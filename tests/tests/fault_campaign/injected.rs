//! The kinds of faults of the campaign: each with its random values, and why some are not found.

use crate::arms::Arm;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::FaultKind;
use oorandom::Rand64;

/// A fault to inject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// Of the arm.
    Plant(FaultKind),
    /// The host sends nothing any more.
    HostSilent,
}

/// A kind of faults.
pub(crate) struct Kind {
    /// Its name, as in scenario files.
    pub(crate) name: &'static str,
    /// Whether an arm can have it.
    pub(crate) suits: fn(&Arm) -> bool,
    /// A random fault of a joint.
    make: fn(&mut Draw<'_>) -> Fault,
    /// Why it is not found, where it is not.
    pub(crate) unseen: &'static str,
}

/// Random values for a fault.
struct Draw<'a> {
    random: &'a mut Rand64,
    joint: Joint,
    arm: &'a Arm,
}

impl Draw<'_> {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random.rand_float()
    }

    fn whole(&mut self, low: u64, high: u64) -> u64 {
        self.random.rand_range(low..high + 1)
    }

    fn level(&mut self) -> bool {
        self.random.rand_range(0..2) == 1
    }

    /// −1, 1/4, 1/2, 2, or any factor around 1.
    fn gain(&mut self) -> f64 {
        match self.whole(0, 4) {
            0 => -1.0,
            1 => 0.25,
            2 => 0.5,
            3 => 2.0,
            _ => self.between(0.1, 1.9),
        }
    }

    /// A share of the motor's peak current, of either sign [A].
    fn amperes(&mut self, share: f64) -> f64 {
        let peak = f64::from(self.arm.settings.axes[self.joint].peak_current);
        self.between(-share, share) * peak
    }
}

impl Kind {
    /// A random fault of this kind.
    pub(crate) fn fault(&self, random: &mut Rand64, arm: &Arm) -> Fault {
        let joint = Joint::ALL[random.rand_range(0..2) as usize];
        (self.make)(&mut Draw { random, joint, arm })
    }
}

const ANY: fn(&Arm) -> bool = |_| true;

/// Every kind.
#[rustfmt::skip]
pub(crate) const KINDS: &[Kind] = &[
    Kind {
        name: "encoder_dead", suits: ANY,
        make: |d| Fault::Plant(FaultKind::EncoderDead { joint: d.joint }),
        unseen: "the arm rests, and the fault shows with its next motion",
    },
    Kind {
        name: "encoder_jump", suits: ANY,
        make: |d| {
            let (size, up) = (d.whole(1, 2000) as i32, d.level());
            Fault::Plant(FaultKind::EncoderJump { joint: d.joint, counts: if up { size } else { -size } })
        },
        unseen: "the jump is smaller than the turn of a tick at over-speed: the joint stays off by so little",
    },
    Kind {
        name: "encoder_gain", suits: ANY,
        make: |d| Fault::Plant(FaultKind::EncoderGain { joint: d.joint, gain: d.gain() }),
        unseen: "the arm hardly moves, or the factor is near 1: the path is distorted, and nothing else measures the joint",
    },
    Kind {
        name: "encoder_late", suits: ANY,
        make: |d| Fault::Plant(FaultKind::EncoderLate { joint: d.joint, ticks: d.whole(2, 100) as u32 }),
        unseen: "at rest late counts are the same counts; a short delay takes phase margin only",
    },
    Kind {
        name: "encoder_channel_stuck", suits: ANY,
        make: |d| Fault::Plant(FaultKind::EncoderChannelStuck { joint: d.joint }),
        unseen: "the arm rests, and the fault shows with its next motion",
    },
    Kind {
        name: "encoder_noise", suits: ANY,
        make: |d| Fault::Plant(FaultKind::EncoderNoise { joint: d.joint, counts: d.whole(1, 100) as i32 }),
        unseen: "a few counts of noise make the motors noisy and take accuracy only",
    },
    Kind {
        name: "index_stuck", suits: |arm| arm.has_index,
        make: |d| { let high = d.level(); Fault::Plant(FaultKind::IndexStuck { joint: d.joint, high }) },
        unseen: "the index is read at the end of homing, later than the 3 s of a trial: fault 20 then",
    },
    Kind {
        name: "switch_stuck", suits: ANY,
        make: |d| { let pressed = d.level(); Fault::Plant(FaultKind::SwitchStuck { joint: d.joint, pressed }) },
        unseen: "it reads what it should here, or homing searches for it for longer than the 3 s of a trial: fault 11 then",
    },
    Kind {
        name: "current_offset", suits: ANY,
        make: |d| { let amperes = d.amperes(2.0); Fault::Plant(FaultKind::CurrentOffset { joint: d.joint, amperes }) },
        unseen: "a small shift: the position loop's integral compensates for it",
    },
    Kind {
        name: "current_dead", suits: ANY,
        make: |d| Fault::Plant(FaultKind::CurrentDead { joint: d.joint }),
        unseen: "the motor has no current",
    },
    Kind {
        name: "current_gain", suits: ANY,
        make: |d| Fault::Plant(FaultKind::CurrentGain { joint: d.joint, gain: d.gain() }),
        unseen: "the factor is near 1, where hot copper explains as much; or the currents are small",
    },
    Kind {
        name: "current_stuck", suits: ANY,
        make: |d| { let amperes = d.amperes(1.2); Fault::Plant(FaultKind::CurrentStuck { joint: d.joint, amperes }) },
        unseen: "where the arm rests with a small current, the current loop's integral ends at its limit",
    },
    Kind {
        name: "current_late", suits: ANY,
        make: |d| Fault::Plant(FaultKind::CurrentLate { joint: d.joint, ticks: d.whole(1, 20) as u32 }),
        unseen: "a delay of a tick or two takes phase margin of the current loop only, and a loop without motion is not excited",
    },
    Kind {
        name: "bus_voltage", suits: ANY,
        make: |d| { let volts = d.arm.parameters.bus_voltage * d.between(0.0, 1.8); Fault::Plant(FaultKind::BusVoltage { volts }) },
        unseen: "the voltage is within the range of the settings, or the bridges are off",
    },
    Kind {
        name: "bus_sensor_stuck", suits: ANY,
        make: |_| Fault::Plant(FaultKind::BusSensorStuck),
        unseen: "never while the bus is sound: the reading is right; a bus that changes later is not seen",
    },
    Kind {
        name: "bus_sensor_gain", suits: ANY,
        make: |d| Fault::Plant(FaultKind::BusSensorGain { gain: d.between(0.0, 1.8) }),
        unseen: "the reading is within the range of the settings: the current loop's gain is wrong by the factor; or the bridges are off",
    },
    Kind {
        name: "motor_disconnected", suits: ANY,
        make: |d| Fault::Plant(FaultKind::MotorDisconnected { joint: d.joint }),
        unseen: "the arm rests, or the other motor carries the joint",
    },
    Kind {
        name: "winding_shorted", suits: ANY,
        make: |d| Fault::Plant(FaultKind::WindingShorted { joint: d.joint }),
        unseen: "the position loop makes up for half of the torque while the motion is slow",
    },
    Kind {
        name: "motor_stalled", suits: ANY,
        make: |d| Fault::Plant(FaultKind::MotorStalled { joint: d.joint }),
        unseen: "the arm rests",
    },
    Kind {
        name: "bridge_one_direction", suits: ANY,
        make: |d| Fault::Plant(FaultKind::BridgeOneDirection { joint: d.joint }),
        unseen: "the motion needs no torque in the other direction, or too little of it",
    },
    Kind {
        name: "bridge_shorted", suits: ANY,
        make: |d| Fault::Plant(FaultKind::BridgeShorted { joint: d.joint }),
        unseen: "the bridges stay off",
    },
    Kind {
        name: "duty_stuck", suits: ANY,
        make: |d| Fault::Plant(FaultKind::DutyStuck { joint: d.joint }),
        unseen: "the arm rests, or the bridges are off",
    },
    Kind {
        name: "driver_fault", suits: ANY,
        make: |d| Fault::Plant(FaultKind::DriverFault { joint: d.joint }),
        unseen: "it is read while the bridges are awake",
    },
    Kind {
        name: "driver_fault_stuck", suits: ANY,
        make: |d| Fault::Plant(FaultKind::DriverFaultStuck { joint: d.joint }),
        unseen: "it is read while the bridges are awake",
    },
    Kind {
        name: "driver_fault_open", suits: ANY,
        make: |d| Fault::Plant(FaultKind::DriverFaultOpen { joint: d.joint }),
        unseen: "it is read while the bridges are awake",
    },
    Kind {
        name: "emergency_stop", suits: ANY,
        make: |_| Fault::Plant(FaultKind::EmergencyStop),
        unseen: "",
    },
    Kind {
        name: "emergency_stop_welded", suits: ANY,
        make: |_| Fault::Plant(FaultKind::EmergencyStopWelded),
        unseen: "never: one contact that is welded cannot be told from one that is not pressed; the arm goes on. \
                 Press the button before each shift, or use two contacts and a safety relay",
    },
    Kind {
        name: "contactor_welded", suits: ANY,
        make: |_| Fault::Plant(FaultKind::ContactorWelded),
        unseen: "never in a run: the bus voltage shows it while the emergency stop is pressed, and commissioning \
                 looks for it; the timer's break input switches the bridges off as well",
    },
    Kind {
        name: "brake_late", suits: |arm| arm.has_brakes,
        make: |d| { let seconds = d.between(0.0, 0.5); Fault::Plant(FaultKind::BrakeLate { joint: d.joint, seconds }) },
        unseen: "the brakes are tried only when the arm is disarmed, and the arm must sink by 0.01 rad",
    },
    Kind {
        name: "brake_fails", suits: |arm| arm.has_brakes,
        make: |d| Fault::Plant(FaultKind::BrakeFails { joint: d.joint }),
        unseen: "the brakes are tried only when the arm is disarmed, and the arm must sink by 0.01 rad; an arm \
                 without power falls",
    },
    Kind {
        name: "coupling_slips", suits: ANY,
        make: |d| { let share = d.between(0.02, 0.9); Fault::Plant(FaultKind::CouplingSlips { joint: d.joint, share }) },
        unseen: "only a home switch on the joint shows a slip, when the joint comes to it; the job is elsewhere",
    },
    Kind {
        name: "brake_stuck", suits: |arm| arm.has_brakes,
        make: |d| Fault::Plant(FaultKind::BrakeStuck { joint: d.joint }),
        unseen: "the arm rests",
    },
    Kind {
        name: "belt_breaks", suits: |arm| arm.has_belts,
        make: |d| Fault::Plant(FaultKind::BeltBreaks { joint: d.joint }),
        unseen: "homing finds the switches no more, but looks for them for longer than 3 s",
    },
    Kind {
        name: "payload_changes", suits: ANY,
        make: |d| {
            let kilograms = d.between(-d.arm.parameters.arm.payload(), 0.2);
            Fault::Plant(FaultKind::PayloadChanges { kilograms })
        },
        unseen: "the position loop carries it; where it does not, a joint follows badly",
    },
    Kind {
        name: "tool_caught", suits: ANY,
        make: |_| Fault::Plant(FaultKind::ToolCaught),
        unseen: "the arm rests",
    },
    Kind {
        name: "ticks_missed", suits: ANY,
        make: |d| Fault::Plant(FaultKind::TicksMissed { ticks: d.whole(1, 50) as u32 }),
        unseen: "two ticks in a row may be missed; with the bridges off any number",
    },
    Kind {
        name: "host_silent", suits: ANY,
        make: |_| Fault::HostSilent,
        unseen: "an arm at rest waits 60 s for its host; a crossing does not stop in the singularity, and ends at rest",
    },
];
