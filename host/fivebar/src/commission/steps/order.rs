//! The steps of an arm by the kind of its drives, in their order: the one place that tells them apart.

use super::{
    Step, arm, belts, bus, dead_band, driver_current, dynamics, electrics, enable, friction,
    geometry, inputs, motors, reserve, told_torque, turns,
};
use fivebar_files::robot::DriveKind;

const SUPPLY: Step = Step {
    name: "supply",
    does: "reads the bus voltage and the current sensors; nothing is switched on",
    run: inputs::supply,
};
const EMERGENCY_STOP: Step = Step {
    name: "emergency-stop",
    does: "asks for the emergency stop, and waits until the bus falls; nothing is switched on",
    run: inputs::emergency_stop,
};
const SWITCHES: Step = Step {
    name: "switches",
    does: "asks for each home switch; nothing is switched on",
    run: inputs::switches,
};
const ENCODERS: Step = Step {
    name: "encoders",
    does: "asks for a turn of each joint by hand; nothing is switched on",
    run: inputs::encoders,
};
const MOTORS: Step = Step {
    name: "motors",
    does: "puts a small voltage on one motor at a time, for 0.15 s and 0.1 rad at most, up to \
           the motor's continuous current",
    run: motors::directions,
};
const ELECTRICS: Step = Step {
    name: "electrics",
    does: "puts voltages on one motor at a time, for 0.8 s and 0.45 rad at most, up to the \
           motor's continuous current, and the whole voltage for 2 ms, up to the bridge's own current \
           limit; the joints must be free to turn away from their switches",
    run: electrics::electrics,
};
const HOMING: Step = Step {
    name: "homing",
    does: "homes the arm three times by the method of [homing], at its speed and current",
    run: arm::homing,
};
const BELTS: Step = Step {
    name: "belts",
    does: "homes the arm, then puts a pseudo-random voltage on one motor at a time, for 0.3 s and 0.45 rad at \
           most; an arm without belts is left as it is",
    run: belts::belts,
};
const FRICTION: Step = Step {
    name: "friction",
    does: "homes the arm, then turns one joint at a time there and back at constant speeds",
    run: friction::friction,
};
const GEOMETRY: Step = Step {
    name: "geometry",
    does: "homes the arm, then asks for the tip in holes of a plate; the bridges are off",
    run: geometry::geometry,
};
const DYNAMICS: Step = Step {
    name: "dynamics",
    does: "homes the arm, then moves both joints fast through the workspace, twice for some seconds",
    run: dynamics::dynamics,
};
const TUNING: Step = Step {
    name: "tuning",
    does: "works out the gains from what was measured; nothing moves",
    run: arm::tuning,
};
const VALIDATION: Step = Step {
    name: "validation",
    does: "draws the demonstration in the air with the values of the drawing, then with the \
           measured ones",
    run: arm::validation,
};

const BRUSHED: [Step; 13] = [
    SUPPLY,
    EMERGENCY_STOP,
    SWITCHES,
    ENCODERS,
    MOTORS,
    ELECTRICS,
    HOMING,
    BELTS,
    FRICTION,
    GEOMETRY,
    DYNAMICS,
    TUNING,
    VALIDATION,
];

/// A stepper's driver tells nothing of its motor, so a person says what the joints do.
const STEPPERS: [Step; 11] = [
    Step {
        does: "asks for the emergency stop; nothing is switched on",
        ..EMERGENCY_STOP
    },
    SWITCHES,
    Step {
        does: "asks for a turn of each joint by hand, if the motors have encoders; nothing is switched on",
        run: enable::encoders,
        ..ENCODERS
    },
    Step {
        name: "current",
        does: "works out what both drivers are to be set to; nothing is switched on",
        run: driver_current::current,
    },
    Step {
        name: "enable",
        does: "asks whether the joints are held without power and with it; the motors hold the arm where it is",
        run: enable::enable,
    },
    Step {
        does: "turns one joint at a time by 5° there and back, slowly, from where a hand has put the arm, and asks what \
               was to be seen",
        run: turns::directions,
        ..MOTORS
    },
    Step {
        name: "micro-steps",
        does: "turns one joint at a time by 20° there and back, slowly, and asks by how much it turned",
        run: turns::distances,
    },
    Step {
        does: "homes the arm ten times by the method of [homing], at its speed",
        ..HOMING
    },
    Step {
        name: "reserve",
        does: "draws short strokes in the air, fast, each motor with a growing share of its torque, and homes the arm after \
               each time, until the switches show that it has lost steps; keep clear of the whole reach",
        run: reserve::reserve,
    },
    Step {
        does: "homes the arm, then moves the tip to places on a paper and asks for a mark at each; with encoders it asks for \
               the tip in holes of a plate",
        ..GEOMETRY
    },
    VALIDATION,
];

/// A servo tells nothing at all.
const SERVOS: [Step; 6] = [
    Step {
        does: "asks for the emergency stop; nothing is switched on",
        ..EMERGENCY_STOP
    },
    Step {
        does: "asks for the arm at its home angles, because a servo turns there at full speed at its first pulse; then turns one \
               joint at a time by 5° there and back, slowly, and asks what was to be seen",
        run: turns::servo_directions,
        ..MOTORS
    },
    Step {
        name: "travel",
        does: "turns one joint at a time by 20° there and back, slowly, and asks by how much it turned",
        run: turns::distances,
    },
    Step {
        name: "dead-band",
        does: "changes the pulse of one servo at a time little by little, and asks when the joint moves",
        run: dead_band::dead_band,
    },
    Step {
        does: "moves the tip to places on a paper and asks for a mark at each",
        ..GEOMETRY
    },
    VALIDATION,
];

/// Drives on a bus tell the angles of their joints, and follow a motion by themselves.
const ON_A_BUS: [Step; 10] = [
    Step {
        name: "drives",
        does: "works out what both drives are to be set to by their maker's program; nothing is switched on",
        run: bus::settings,
    },
    Step {
        does: "asks for the emergency stop; nothing is switched on",
        ..EMERGENCY_STOP
    },
    SWITCHES,
    Step {
        run: bus::answers,
        ..ENCODERS
    },
    Step {
        does: "holds the arm for 5 s where a hand has put it, then turns one joint at a time by 5° there and back, slowly",
        run: bus::motors,
        ..MOTORS
    },
    Step {
        name: "zero",
        does: "asks for the arm in its jig if the drives know their angles; nothing is switched on",
        run: bus::zero,
    },
    HOMING,
    Step {
        name: "torque",
        does: "homes the arm, then draws short strokes in the air, fast, each motor with 0.3 and then half of its torque",
        run: told_torque::told_torque,
    },
    GEOMETRY,
    VALIDATION,
];

/// The steps of each kind.
const ALL: [(DriveKind, &[Step]); 4] = [
    (DriveKind::Brushed, &BRUSHED),
    (DriveKind::Stepper, &STEPPERS),
    (DriveKind::CanTorque, &ON_A_BUS),
    (DriveKind::Servo, &SERVOS),
];

/// The steps of an arm with drives of this kind; none of a new one.
pub(crate) fn of(kind: DriveKind) -> &'static [Step] {
    let its_own = ALL.iter().find(|(of, _)| *of == kind);
    its_own.map_or(&[], |(_, steps)| steps)
}

/// The names of all steps, each once.
pub(crate) fn names() -> Vec<&'static str> {
    let mut names = Vec::new();
    for step in ALL.iter().flat_map(|(_, steps)| *steps) {
        if !names.contains(&step.name) {
            names.push(step.name);
        }
    }
    names
}

/// The step of this name, whichever arm has it.
pub(crate) fn named(name: &str) -> Option<&'static str> {
    names().into_iter().find(|step| *step == name)
}
