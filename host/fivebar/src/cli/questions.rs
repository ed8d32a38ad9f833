//! The questions of `fivebar new`, and the reading of their answers.

use fivebar_files::robot::{Draft, Motor};
use fivebar_firmware::settings::AxisField;
use std::borrow::Cow;
use std::str::FromStr;

/// Why an answer is not valid.
#[derive(Debug, thiserror::Error)]
pub(super) enum AnswerError {
    #[error("\"{0}\" is no valid number here")]
    Number(String),
    #[error("a length must be more than 0 m, not {0}")]
    Length(f64),
    #[error("\"{answer}\" is none of {words}")]
    Choice { answer: String, words: String },
}

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
            draft.set_base(match number(answer)? {
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
            draft.crank_masses = pair(answer, number)?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Mass of a coupler [kg]; two numbers if they are unlike"),
        default: |draft| both(draft.coupler_masses),
        take: |draft, answer| {
            draft.coupler_masses = pair(answer, number)?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Payload at C [kg]"),
        default: |draft| shown(draft.payload),
        take: |draft, answer| {
            draft.payload = number(answer)?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Supply voltage [V]"),
        default: |draft| shown(draft.voltage),
        take: |draft, answer| {
            draft.voltage = number(answer)?;
            Ok(())
        },
    },
    Question {
        text: Cow::Borrowed("Motors: typical (20 W), own (your data), or ideal torque sources"),
        default: |_| "typical".into(),
        take: |draft, answer| {
            draft.motor = match choice(answer, ["typical", "own", "ideal"])? {
                2 => None,
                _ => Some(Motor::TYPICAL),
            };
            Ok(())
        },
    },
];

/// Whether the answer to the last question of the arm asks for the questions of [`motor`].
pub(super) fn asks_for_own_motor(answer: &str) -> bool {
    choice(answer, ["own"]).is_ok()
}

macro_rules! of_motor {
    ($key:ident, $field:ident) => {
        Question {
            text: asked(AxisField::$key),
            default: |draft| match &draft.motor {
                Some(motor) => shown(motor.$field),
                None => String::new(),
            },
            take: |draft, answer| {
                let value = number(answer)?;
                if let Some(motor) = &mut draft.motor {
                    motor.$field = value;
                }
                Ok(())
            },
        }
    };
}

/// The questions about the motor; both joints have the same motor.
pub(super) fn motor() -> [Question; 9] {
    [
        of_motor!(GearRatio, gear_ratio),
        of_motor!(RotorInertia, rotor_inertia),
        of_motor!(TorqueConstant, torque_constant),
        of_motor!(Resistance, resistance),
        of_motor!(Inductance, inductance),
        of_motor!(EncoderCounts, encoder_counts),
        of_motor!(PeakCurrent, peak_current),
        of_motor!(ContinuousCurrent, continuous_current),
        of_motor!(ThermalTimeConstant, thermal_time_constant),
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

fn number<T: FromStr>(answer: &str) -> Result<T, AnswerError> {
    let answer = answer.trim();
    let is_finite = answer.parse().is_ok_and(f64::is_finite);
    let number = answer.parse().ok().filter(|_| is_finite);
    number.ok_or_else(|| AnswerError::Number(answer.into()))
}

fn length(answer: &str) -> Result<f64, AnswerError> {
    let length = number(answer)?;
    if length > 0.0 {
        Ok(length)
    } else {
        Err(AnswerError::Length(length))
    }
}

/// One value for both, or one for each.
fn pair(answer: &str, one: fn(&str) -> Result<f64, AnswerError>) -> Result<[f64; 2], AnswerError> {
    match answer.split_once(',') {
        None => one(answer).map(|value| [value; 2]),
        Some((first, second)) => Ok([one(first)?, one(second)?]),
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
