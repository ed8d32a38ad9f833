//! The answers to the questions of `fivebar new`: numbers with units, and two of them.

use std::f64::consts::{FRAC_PI_3, PI, TAU};
use std::str::FromStr;

/// Why an answer is not valid.
#[derive(Debug, thiserror::Error)]
pub(super) enum AnswerError {
    #[error("\"{answer}\" is no valid number{}", with_unit(.unit))]
    Number { answer: String, unit: &'static str },
    #[error("a length must be more than 0 m, not {0}")]
    Length(f64),
    #[error("\"{answer}\" is none of {words}")]
    Choice { answer: String, words: String },
}

/// A number with or without its unit, which may have a prefix: `0.08`, `80 g`, `24V`, `0,2`.
pub(super) fn quantity(answer: &str, unit: &'static str) -> Result<f64, AnswerError> {
    let text = answer.trim().replace(',', ".");
    let ends = text
        .char_indices()
        .map(|(at, letter)| at + letter.len_utf8());
    let read = |end: usize| {
        Some((
            text.get(..end)?.parse::<f64>().ok()?,
            text.get(end..)?.trim(),
        ))
    };
    let found = ends.rev().find_map(read);
    let value = found.and_then(
        |(number, suffix)| match (suffix.replace(' ', "").as_str(), unit) {
            // So data sheets of servos have their speed.
            ("s/60deg" | "s/60°", "rad/s") => Some(FRAC_PI_3 / number),
            _ => Some(number * factor(suffix, unit)?),
        },
    );
    let value = value.filter(|value| value.is_finite());
    value.ok_or_else(|| AnswerError::Number {
        answer: answer.trim().into(),
        unit,
    })
}

/// The units of `unit` in a suffix: 1, or 0.001 for `g` of `kg` and `mA` of `A`.
fn factor(suffix: &str, unit: &str) -> Option<f64> {
    let is_unit = |text: &str| !unit.is_empty() && (text == unit || (unit == "Ω" && text == "ohm"));
    if suffix.is_empty() || is_unit(suffix) {
        return Some(1.0);
    }
    if unit == "kg" {
        return (suffix == "g").then_some(1e-3);
    }
    if let Some(factor) = other_unit(suffix, unit) {
        return Some(factor);
    }
    let prefixes = [("m", 1e-3), ("µ", 1e-6), ("u", 1e-6), ("k", 1e3)];
    let known = prefixes
        .into_iter()
        .find(|(prefix, _)| suffix.strip_prefix(prefix).is_some_and(is_unit));
    known.map(|(_, factor)| factor)
}

/// Units of data sheets: degrees, turns in a minute, and the torques of servos and steppers. A `kg` of a torque is the weight
/// of one.
fn other_unit(suffix: &str, unit: &str) -> Option<f64> {
    let plain: String = suffix
        .chars()
        .filter(|letter| !" ·*-.".contains(*letter))
        .collect();
    match (unit, plain.as_str()) {
        ("rad", "deg" | "°" | "degree" | "degrees") => Some(PI / 180.0),
        ("rad/s", "deg/s" | "°/s") => Some(PI / 180.0),
        ("rad/s", "rpm") => Some(TAU / 60.0),
        ("N·m", "Nm") => Some(1.0),
        ("N·m", "mNm") => Some(1e-3),
        ("N·m", "Ncm") => Some(1e-2),
        ("N·m", "kgfcm" | "kgcm") => Some(0.098_066_5),
        ("N·m", "ozin" | "ozfin") => Some(7.061_552e-3),
        _ => None,
    }
}

fn with_unit(unit: &str) -> String {
    match unit {
        "" => " here".into(),
        unit => format!(" here, with or without its unit {unit}"),
    }
}

/// The value as the number that its setting is.
pub(super) fn of_type<T: FromStr>(value: f64, answer: &str) -> Result<T, AnswerError> {
    value.to_string().parse().map_err(|_| AnswerError::Number {
        answer: answer.trim().into(),
        unit: "",
    })
}

pub(super) fn any_length(answer: &str) -> Result<f64, AnswerError> {
    let length = super::length::length(&answer.replace(',', "."));
    length.map_err(|_| AnswerError::Number {
        answer: answer.trim().into(),
        unit: "m, cm, mm or in",
    })
}

pub(super) fn length(answer: &str) -> Result<f64, AnswerError> {
    let length = any_length(answer)?;
    if length > 0.0 {
        Ok(length)
    } else {
        Err(AnswerError::Length(length))
    }
}

/// One value for both, or one for each: `0.1, 0.2`, `100mm,120mm`, `0,1; 0,2`. A comma between two digits is a decimal
/// comma, unless the answer has decimal points. Without another sign a blank before a number separates, if there is one:
/// `0 1`, `0.5 ms 2.5 ms`.
pub(super) fn pair(
    answer: &str,
    one: fn(&str) -> Result<f64, AnswerError>,
) -> Result<[f64; 2], AnswerError> {
    let is_digit = |letter: Option<char>| letter.is_some_and(|letter| letter.is_ascii_digit());
    let separates = |&(at, letter): &(usize, char)| {
        let (before, behind) = (&answer[..at], &answer[at + letter.len_utf8()..]);
        let is_decimal = is_digit(before.chars().next_back()) && is_digit(behind.chars().next());
        letter == ';' || (letter == ',' && (!is_decimal || answer.contains('.')))
    };
    let answer = answer.trim();
    let begins = |letter: char| letter.is_ascii_digit() || "+-.".contains(letter);
    let mut blanks = (answer.match_indices(' '))
        .map(|(at, _)| at)
        .filter(|at| answer[at + 1..].starts_with(begins));
    let blank = match (blanks.next(), blanks.next()) {
        (Some(at), None) => Some((at, ' ')),
        _ => None,
    };
    let separator = answer.char_indices().find(separates).or(blank);
    match separator {
        None => one(answer).map(|value| [value; 2]),
        Some((at, _)) => Ok([one(&answer[..at])?, one(&answer[at + 1..])?]),
    }
}

#[cfg(test)]
mod tests {
    use super::{length, pair, quantity};

    #[test]
    fn numbers_have_units_and_decimal_commas() {
        for (answer, unit, value) in [
            ("80g", "kg", 0.08),
            ("0,2", "kg", 0.2),
            (" 80 g ", "kg", 0.08),
            ("24V", "V", 24.0),
            ("1.2 mH", "H", 1.2e-3),
            ("500mA", "A", 0.5),
            ("2,5 ohm", "Ω", 2.5),
            ("1e-5 kg·m²", "kg·m²", 1e-5),
            ("-3", "", -3.0),
            ("180 deg", "rad", std::f64::consts::PI),
            ("120°", "rad", std::f64::consts::TAU / 3.0),
            ("60 rpm", "rad/s", std::f64::consts::TAU),
            ("90 deg/s", "rad/s", std::f64::consts::FRAC_PI_2),
            ("0.1 s/60deg", "rad/s", std::f64::consts::FRAC_PI_3 / 0.1),
            ("0,1 s / 60°", "rad/s", std::f64::consts::FRAC_PI_3 / 0.1),
            ("2.2 kgf cm", "N·m", 0.215_746_3),
            ("2.2kg·cm", "N·m", 0.215_746_3),
            ("40 N·cm", "N·m", 0.4),
            ("0.4Nm", "N·m", 0.4),
        ] {
            let found = quantity(answer, unit).unwrap();
            assert!((found - value).abs() < 1e-15, "{answer}: {found}");
        }
        for wrong in ["", "nan", "inf", "80 V", "wide", "1.2.3", "1 m"] {
            assert!(quantity(wrong, "kg").is_err(), "{wrong}");
        }
    }

    #[test]
    fn two_numbers_are_apart_from_decimal_commas() {
        for (answer, both) in [
            ("0.1", [0.1, 0.1]),
            ("0,1", [0.1, 0.1]),
            ("0.1,0.2", [0.1, 0.2]),
            ("0.1, 0.2", [0.1, 0.2]),
            ("0,1, 0,2", [0.1, 0.2]),
            ("0,1;0,2", [0.1, 0.2]),
            ("100mm,150 mm", [0.1, 0.15]),
            ("60 mm", [0.06, 0.06]),
            ("0.1 0.2", [0.1, 0.2]),
            ("0,1 0,2", [0.1, 0.2]),
            ("100 mm 150 mm", [0.1, 0.15]),
        ] {
            let found = pair(answer, length).unwrap();
            assert!(
                (0..2).all(|one| (found[one] - both[one]).abs() < 1e-15),
                "{answer}: {found:?}"
            );
        }
        for wrong in ["-1", "0", "wide", "1,2,3", "60 kg", "0.1, ", "1 2 3"] {
            assert!(pair(wrong, length).is_err(), "{wrong}");
        }
    }
}
