//! The questions of `fivebar new`.

use super::answer::{AnswerError, any_length, length, of_type, pair, quantity};
use fivebar_files::robot::{CanMotor, CanProtocol, Draft, Motor, Motors, ServoMotor, StepperMotor};
use fivebar_firmware::settings::AxisField;
use fivebar_plant::DriverMode;
use std::borrow::Cow;

/// A question about the arm.
pub(super) struct Question {
    /// Its text, with the unit.
    pub(super) text: Cow<'static, str>,
    /// The answer of an empty line.
    pub(super) default: fn(&Draft) -> String,
    /// Puts an answer into the draft, or returns why it is not valid.
    pub(super) take: fn(&mut Draft, &str) -> Result<(), AnswerError>,
}

/// The questions about the arm.
pub(super) const ARM: [Question; 10] = [
    Question {
        text: Cow::Borrowed("Name of the arm"),
        default: |draft| draft.name.clone(),
        take: |draft, answer| {
            draft.name = answer.into();
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Plane of the arm: flat (horizontal) or upright (vertical)"),
        default: |_| "flat".into(),
        take: |draft, answer| {
            draft.upright = choice(answer, ["flat", "upright"])? == 1;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Base, from A to E [m]; 0 for coaxial cranks"),
        default: |draft| shown(draft.base),
        take: |draft, answer| {
            draft.set_base(match any_length(answer)? {
                0.0 => 0.0,
                _ => length(answer)?,
            });
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Cranks, links 1 and 4 [m]; two numbers if they are unlike"),
        default: |draft| both(draft.cranks),
        take: |draft, answer| {
            draft.set_cranks(pair(answer, length)?);
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Couplers, links 2 and 3 [m]; two numbers if they are unlike"),
        default: |draft| both(draft.couplers),
        take: |draft, answer| {
            draft.set_couplers(pair(answer, length)?);
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Mass of a crank [kg]; two numbers if they are unlike"),
        default: |draft| both(draft.crank_masses),
        take: |draft, answer| {
            draft.crank_masses = pair(answer, |answer| quantity(answer, "kg"))?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Mass of a coupler [kg]; two numbers if they are unlike"),
        default: |draft| both(draft.coupler_masses),
        take: |draft, answer| {
            draft.coupler_masses = pair(answer, |answer| quantity(answer, "kg"))?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Payload at C [kg]"),
        default: |draft| shown(draft.payload),
        take: |draft, answer| {
            draft.payload = quantity(answer, "kg")?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Supply voltage [V]"),
        default: |draft| shown(draft.voltage),
        take: |draft, answer| {
            draft.voltage = quantity(answer, "V")?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed(
            "Motors: typical (brushed, 20 W), own (brushed, your data), stepper, can (torque drives on a CAN bus), servo (hobby \
             servos; a higher supply becomes 6 V), or ideal torque sources",
        ),
        default: |_| KINDS[0].into(),
        take: |draft, answer| {
            draft.motors = match choice(answer, KINDS)? {
                0 | 1 => Motors::Brushed(Motor::TYPICAL),
                2 => Motors::Steppers(StepperMotor::TYPICAL),
                3 => Motors::CanDrives(CanMotor::TYPICAL),
                4 => {
                    draft.voltage = draft.voltage.min(SERVO_SUPPLY);
                    Motors::HobbyServos(ServoMotor::TYPICAL)
                }
                _ => Motors::Ideal,
            };
            Ok(())
        },
    },
];

/// The supply that hobby servos have where the answer was a higher one, which is of other motors [V].
const SERVO_SUPPLY: f64 = 6.0;

/// The answers to the last question of the arm.
const KINDS: [&str; 6] = ["typical", "own", "stepper", "can", "servo", "ideal"];

/// The questions that follow the last answer about the arm.
pub(super) fn about_motors(motors: &Motors, answer: &str) -> Vec<Question> {
    match motors {
        Motors::Brushed(_) if asks_for_own(answer) => brushed(),
        Motors::Steppers(_) => steppers(),
        Motors::CanDrives(_) => vec![PROTOCOL],
        Motors::HobbyServos(_) => hobby_servos(),
        Motors::Brushed(_) | Motors::Ideal => Vec::new(),
    }
}

/// The questions about steppers of a hanging arm, which needs brakes, and encoders that show whether they hold it.
pub(super) fn about_hanging(draft: &Draft) -> Vec<Question> {
    match &draft.motors {
        Motors::Steppers(_) if draft.upright => vec![ENCODER, BRAKE],
        _ => Vec::new(),
    }
}

/// The question about a stepper's encoder.
const ENCODER: Question = Question {
    text: Cow::Borrowed(
        "Encoder counts per motor turn, after quadrature: a hanging arm on steppers needs encoders; 0 without",
    ),
    default: |draft| match &draft.motors {
        Motors::Steppers(motor) => motor.encoder_counts.unwrap_or_default().to_string(),
        _ => String::new(),
    },
    take: |draft, answer| {
        let counts = of_type(quantity(answer, "")?, answer)?;
        if let Motors::Steppers(motor) = &mut draft.motors {
            motor.encoder_counts = (counts > 0).then_some(counts);
        }
        Ok(())
    },
};

/// The question about a holding brake.
const BRAKE: Question = Question {
    text: Cow::Borrowed("Torque of the holding brake, at the joint [N·m]; 0 without"),
    default: |draft| shown(draft.brake()),
    take: |draft, answer| {
        draft.brake_torque = Some(quantity(answer, "N·m")?);
        Ok(())
    },
};

/// The questions that follow the one about a protocol.
pub(super) fn about_drives(motors: &Motors) -> Vec<Question> {
    let Motors::CanDrives(motor) = motors else {
        return Vec::new();
    };
    let mut questions = can_drives();
    if motor.protocol != CanProtocol::Odrive {
        // The ranges first: they are checked against the torque and the speed.
        questions.splice(0..0, ranges());
    }
    questions
}

fn asks_for_own(answer: &str) -> bool {
    choice(answer, ["own"]).is_ok()
}

/// A question about a field of a motor.
macro_rules! of_motor {
    (@ $kind:ident, $field:ident, $text:expr, $unit:expr) => {
        Question {
            text: $text,
            default: |draft| match &draft.motors {
                Motors::$kind(motor) => shown(motor.$field),
                _ => String::new(),
            },
            take: |draft, answer| {
                let value = of_type(quantity(answer, $unit)?, answer)?;
                if let Motors::$kind(motor) = &mut draft.motors {
                    motor.$field = value;
                }
                Ok(())
            },
        }
    };
    ($kind:ident, $field:ident = $key:ident) => {
        of_motor!(
            @ $kind,
            $field,
            asked(AxisField::$key),
            AxisField::$key.row().unit
        )
    };
    ($kind:ident, $field:ident, $text:literal) => {
        of_motor!(@ $kind, $field, Cow::Borrowed($text), "")
    };
    ($kind:ident, $field:ident, $text:literal, [$unit:literal]) => {
        of_motor!(
            @ $kind,
            $field,
            Cow::Borrowed(concat!($text, " [", $unit, "]")),
            $unit
        )
    };
}

fn brushed() -> Vec<Question> {
    vec![
        of_motor!(Brushed, gear_ratio = GearRatio),
        of_motor!(Brushed, rotor_inertia = RotorInertia),
        of_motor!(Brushed, torque_constant = TorqueConstant),
        of_motor!(Brushed, resistance = Resistance),
        of_motor!(Brushed, inductance = Inductance),
        of_motor!(Brushed, encoder_counts = EncoderCounts),
        of_motor!(Brushed, peak_current = PeakCurrent),
        of_motor!(Brushed, continuous_current = ContinuousCurrent),
        of_motor!(Brushed, thermal_time_constant = ThermalTimeConstant),
    ]
}

fn steppers() -> Vec<Question> {
    vec![
        of_motor!(Steppers, gear_ratio = GearRatio),
        of_motor!(Steppers, steps_per_turn, "Full steps per motor turn"),
        of_motor!(Steppers, microsteps, "Micro-steps per full step"),
        of_motor!(
            Steppers,
            holding_torque,
            "Holding torque at the motor shaft, or as 4 kgf·cm",
            ["N·m"]
        ),
        of_motor!(
            Steppers,
            rated_current,
            "Current at the peak of a winding: 1.41 times its RMS",
            ["A"]
        ),
        of_motor!(Steppers, resistance, "Resistance of a winding", ["Ω"]),
        of_motor!(Steppers, inductance, "Inductance of a winding", ["H"]),
        of_motor!(Steppers, rotor_inertia = RotorInertia),
        DRIVER,
    ]
}

/// The question about what a stepper's driver gives.
const DRIVER: Question = Question {
    text: Cow::Borrowed(
        "Drivers give the windings: current, or voltage (a TMC2209 as delivered, in StealthChop, which loses steps in motion; its \
         pin SPREAD tied to VIO makes it a current drive)",
    ),
    default: |draft| match &draft.motors {
        Motors::Steppers(motor) => motor.driver.to_string(),
        _ => String::new(),
    },
    take: |draft, answer| {
        let modes = [DriverMode::Current, DriverMode::Voltage];
        let driver = modes[choice(answer, ["current", "voltage"])?];
        if let Motors::Steppers(motor) = &mut draft.motors {
            motor.driver = driver;
        }
        Ok(())
    },
};

fn hobby_servos() -> Vec<Question> {
    vec![
        Question {
            text: Cow::Borrowed("Shortest and longest pulse of a servo, or as 0.5 ms 2.5 ms [s]"),
            default: |draft| match &draft.motors {
                Motors::HobbyServos(motor) => both(motor.pulse_range),
                _ => String::new(),
            },
            take: |draft, answer| {
                let widths = pair(answer, |answer| quantity(answer, "s"))?;
                if let Motors::HobbyServos(motor) = &mut draft.motors {
                    motor.pulse_range = widths;
                }
                Ok(())
            },
        },
        of_motor!(
            HobbyServos,
            travel,
            "Angle between both, or as 180 deg",
            ["rad"]
        ),
        of_motor!(
            HobbyServos,
            max_speed,
            "Greatest speed at this supply, or as 0.1 s/60deg",
            ["rad/s"]
        ),
        of_motor!(
            HobbyServos,
            stall_torque,
            "Stall torque at this supply, or as 2.2 kgf·cm",
            ["N·m"]
        ),
        of_motor!(HobbyServos, dead_band, "Dead band of the pulse", ["s"]),
        of_motor!(HobbyServos, frame_rate, "Pulses in a second", ["Hz"]),
    ]
}

/// The question about the protocol of drives on a CAN bus.
const PROTOCOL: Question = Question {
    text: Cow::Borrowed("Protocol of the drives: odrive, or mit (T-Motor, CubeMars, Damiao)"),
    default: |_| PROTOCOLS[0].into(),
    take: |draft, answer| {
        draft.motors = Motors::CanDrives(match choice(answer, PROTOCOLS)? {
            0 => CanMotor::TYPICAL,
            _ => CanMotor::TYPICAL_MIT,
        });
        Ok(())
    },
};

/// Its answers.
const PROTOCOLS: [&str; 2] = ["odrive", "mit"];

fn can_drives() -> Vec<Question> {
    vec![
        Question {
            text: Cow::Borrowed("Numbers of both drives on the bus"),
            default: |draft| match &draft.motors {
                Motors::CanDrives(motor) => both(motor.nodes.map(f64::from)),
                _ => String::new(),
            },
            take: |draft, answer| {
                // Nodes have no decimals, so every comma is between two.
                let both = answer.replace(',', ", ");
                let [first, second] = pair(&both, |answer| quantity(answer, ""))?;
                let nodes = [of_type(first, answer)?, of_type(second, answer)?];
                if let Motors::CanDrives(motor) = &mut draft.motors {
                    motor.nodes = nodes;
                }
                Ok(())
            },
        },
        of_motor!(
            CanDrives,
            gear_ratio,
            "Turns of the drive's shaft per joint turn; negative if it reverses"
        ),
        of_motor!(
            CanDrives,
            rotor_inertia,
            "Rotor inertia at the drive's shaft",
            ["kg·m²"]
        ),
        of_motor!(
            CanDrives,
            peak_torque,
            "Peak torque at the drive's shaft",
            ["N·m"]
        ),
        of_motor!(
            CanDrives,
            continuous_torque,
            "Continuous torque at the drive's shaft",
            ["N·m"]
        ),
        of_motor!(
            CanDrives,
            max_speed,
            "Greatest speed of the drive's shaft",
            ["rad/s"]
        ),
    ]
}

macro_rules! range {
    ($field:ident, $text:literal, $unit:literal) => {
        Question {
            text: Cow::Borrowed(concat!($text, ", plus and minus [", $unit, "]")),
            default: |draft| match &draft.motors {
                Motors::CanDrives(CanMotor {
                    protocol: CanProtocol::Mit { $field, .. },
                    ..
                }) => shown(*$field),
                _ => String::new(),
            },
            take: |draft, answer| {
                let value = quantity(answer, $unit)?;
                if let Motors::CanDrives(CanMotor {
                    protocol: CanProtocol::Mit { $field, .. },
                    ..
                }) = &mut draft.motors
                {
                    *$field = value;
                }
                Ok(())
            },
        }
    };
}

fn ranges() -> [Question; 3] {
    [
        range!(position_range, "Positions that the frames hold", "rad"),
        range!(velocity_range, "Speeds that the frames hold", "rad/s"),
        range!(torque_range, "Torques that the frames hold", "N·m"),
    ]
}

/// The text of a question for a setting.
fn asked(field: AxisField) -> Cow<'static, str> {
    let row = field.row();
    if row.unit.is_empty() {
        return row.meaning.into();
    }
    format!("{} [{}]", row.meaning, row.unit).into()
}

fn shown(value: impl Into<f64>) -> String {
    let value = value.into();
    if value != 0.0 && value.abs() < 1e-2 {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

fn both([first, second]: [f64; 2]) -> String {
    if first == second {
        shown(first)
    } else {
        format!("{}, {}", shown(first), shown(second))
    }
}

/// The index of the word that the answer is, or with which it begins.
fn choice<const N: usize>(answer: &str, words: [&str; N]) -> Result<usize, AnswerError> {
    let answer = answer.trim().to_lowercase();
    let chosen = words
        .iter()
        .position(|word| !answer.is_empty() && word.starts_with(&answer));
    chosen.ok_or_else(|| AnswerError::Choice {
        answer,
        words: words.join(", "),
    })
}
