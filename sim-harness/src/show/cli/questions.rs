//! The questions of `fivebar new`, and the reading of their answers.

use crate::input::robot::{Draft, Motor};
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
    pub(super) text: &'static str,
    /// The answer of an empty line.
    pub(super) default: fn(&Draft) -> String,
    /// Puts an answer into the draft, or returns why it is not valid.
    pub(super) take: fn(&mut Draft, &str) -> Result<(), AnswerError>,
}

/// The questions about the arm.
pub(super) const ARM: [Question; 10] = [
    Question {
        text: "Name of the arm",
        default: |draft| draft.name.clone(),
        take: |draft, answer| {
            draft.name = answer.into();
            Ok(())
        },
    },
    Question {
        text: "Plane of the arm: flat (horizontal) or upright (vertical)",
        default: |_| "flat".into(),
        take: |draft, answer| {
            draft.upright = choice(answer, ["flat", "upright"])? == 1;
            Ok(())
        },
    },
    Question {
        text: "Base, from A to E [m]",
        default: |draft| shown(draft.base),
        take: |draft, answer| {
            draft.set_base(length(answer)?);
            Ok(())
        },
    },
    Question {
        text: "Cranks, links 1 and 4 [m]; two numbers if they are unlike",
        default: |draft| both(draft.cranks),
        take: |draft, answer| {
            draft.set_cranks(pair(answer, length)?);
            Ok(())
        },
    },
    Question {
        text: "Couplers, links 2 and 3 [m]; two numbers if they are unlike",
        default: |draft| both(draft.couplers),
        take: |draft, answer| {
            draft.set_couplers(pair(answer, length)?);
            Ok(())
        },
    },
    Question {
        text: "Mass of a crank [kg]; two numbers if they are unlike",
        default: |draft| both(draft.crank_masses),
        take: |draft, answer| {
            draft.crank_masses = pair(answer, number)?;
            Ok(())
        },
    },
    Question {
        text: "Mass of a coupler [kg]; two numbers if they are unlike",
        default: |draft| both(draft.coupler_masses),
        take: |draft, answer| {
            draft.coupler_masses = pair(answer, number)?;
            Ok(())
        },
    },
    Question {
        text: "Payload at C [kg]",
        default: |draft| shown(draft.payload),
        take: |draft, answer| {
            draft.payload = number(answer)?;
            Ok(())
        },
    },
    Question {
        text: "Supply voltage [V]",
        default: |draft| shown(draft.voltage),
        take: |draft, answer| {
            draft.voltage = number(answer)?;
            Ok(())
        },
    },
    Question {
        text: "Motors: typical (20 W), own (your data), or ideal torque sources",
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

/// Whether the answer to the last question of the arm asks for [`MOTOR`].
pub(super) fn asks_for_own_motor(answer: &str) -> bool {
    choice(answer, ["own"]).is_ok()
}

macro_rules! of_motor {
    ($text:literal, $field:ident) => {
        Question {
            text: $text,
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
pub(super) const MOTOR: [Question; 9] = [
    of_motor!("Gear ratio, motor turns per joint turn", gear_ratio),
    of_motor!("Rotor inertia [kg·m²]", rotor_inertia),
    of_motor!("Torque constant [N·m/A]", torque_constant),
    of_motor!("Winding resistance [Ω]", resistance),
    of_motor!("Winding inductance [H]", inductance),
    of_motor!(
        "Encoder counts per motor turn, after quadrature",
        encoder_counts
    ),
    of_motor!("Peak current [A]", peak_current),
    of_motor!("Continuous current [A]", continuous_current),
    of_motor!("Time constant of heating [s]", thermal_time_constant),
];

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
