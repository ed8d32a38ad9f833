//! Lengths with a unit, as people type them.

use super::value_error::ValueError;

/// Units: a value times the first number, over the second one, is in metres. The division by a power of ten gives the
/// nearest number to what is written, where a product with 1e-6 does not.
const UNITS: [(&str, f64, f64); 7] = [
    ("um", 1.0, 1e6),
    ("µm", 1.0, 1e6),
    ("mm", 1.0, 1e3),
    ("cm", 1.0, 1e2),
    ("in", 25.4, 1e3),
    ("\"", 25.4, 1e3),
    ("m", 1.0, 1.0),
];

/// A length [m]: `30mm`, `1.5in`, or `0.03` in metres.
pub(super) fn length(text: &str) -> Result<f64, ValueError> {
    let text = text.trim();
    let found = UNITS
        .iter()
        .find_map(|&(unit, factor, per_metre)| Some((text.strip_suffix(unit)?, factor, per_metre)));
    let (number, factor, per_metre) = found.unwrap_or((text, 1.0, 1.0));
    let number: Option<f64> = number.trim_end().parse().ok();
    let length = number.map(|number| number * factor / per_metre);
    length
        .filter(|length| length.is_finite())
        .ok_or(ValueError::Length)
}

/// A length above 0 [m].
pub(super) fn positive_length(text: &str) -> Result<f64, ValueError> {
    length(text).and_then(|length| match length > 0.0 {
        true => Ok(length),
        false => Err(ValueError::PositiveLength),
    })
}

/// A point [m]: two lengths, `30mm,160mm`. A unit after the second only holds for both.
pub(super) fn place(text: &str) -> Result<[f64; 2], ValueError> {
    let (x, y) = text.split_once(',').ok_or(ValueError::Place)?;
    let unit = y
        .trim()
        .trim_start_matches(|c: char| !c.is_alphabetic() && c != '"');
    let has_none = x.trim().parse::<f64>().is_ok();
    let x = if has_none {
        format!("{x}{unit}")
    } else {
        x.into()
    };
    match (length(&x), length(y)) {
        (Ok(x), Ok(y)) => Ok([x, y]),
        _ => Err(ValueError::Place),
    }
}

/// An angle in degrees, as radians.
pub(super) fn degrees(text: &str) -> Result<f64, ValueError> {
    let text = text.trim().trim_end_matches('°');
    let angle: Option<f64> = text.parse().ok();
    let angle = angle.filter(|angle| angle.is_finite());
    angle.map(f64::to_radians).ok_or(ValueError::Degrees)
}

#[cfg(test)]
mod tests {
    use super::{degrees, length, place, positive_length};

    #[test]
    fn lengths_have_a_unit_or_are_metres() {
        for (text, metres) in [
            ("0.03", 0.03),
            ("30mm", 0.03),
            (" 30 mm ", 0.03),
            ("-2.5cm", -0.025),
            ("1e-3m", 1e-3),
            ("50um", 5e-5),
            ("20um", 20e-6),
            ("70um", 70e-6),
            ("50µm", 5e-5),
        ] {
            let found = length(text).unwrap();
            assert_eq!(found, metres, "{text}");
        }
        assert!((length("1.5in").unwrap() - 0.0381).abs() < 1e-17);
        for wrong in ["", "mm", "3 miles", "1,5mm", "nan", "inf", "3mmm"] {
            assert!(length(wrong).is_err(), "{wrong}");
        }
        assert!(positive_length("0mm").is_err() && positive_length("-1mm").is_err());
    }

    #[test]
    fn places_are_two_lengths_and_a_unit_at_the_end_holds_for_both() {
        assert_eq!(place("30mm,160mm"), Ok([0.03, 0.16]));
        assert_eq!(place("30,160mm"), Ok([0.03, 0.16]));
        assert_eq!(place("0.02, 0.14"), Ok([0.02, 0.14]));
        assert_eq!(place("3cm,160mm"), Ok([0.03, 0.16]));
        for wrong in ["0.1", "nan,0", "1,2,3", "a,b"] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
        assert_eq!(degrees("90"), Ok(std::f64::consts::FRAC_PI_2));
        assert!(degrees("right").is_err());
    }
}
