//! Numbers with SI prefixes and units.

/// `value` [`unit`] to three significant digits with an SI prefix: `quantity(4.21e-5, "m")`
/// is "42.1 µm".
///
/// Use it for units that take a prefix, such as "m" or "m/s²", but not for "kg".
pub fn quantity(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 6] = [
        (1e6, "M"),
        (1e3, "k"),
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "µ"),
        (1e-9, "n"),
    ];
    if !value.is_finite() {
        return format!("{value} {unit}");
    }
    // Rounded up by half a digit, so that 999.96 gives "1.00 k" and not "1000".
    let magnitude = value.abs() * 1.0005;
    let (scale, prefix) = PREFIXES
        .into_iter()
        .find(|&(scale, _)| magnitude >= scale)
        .unwrap_or((1e-9, "n"));
    let scaled = value / scale;
    let decimals = match scaled.abs() {
        below if below < 9.995 => 2,
        below if below < 99.95 => 1,
        _ => 0,
    };
    // A value below a hundredth of the least prefix is rounding.
    if scaled.abs() < 0.005 {
        format!("0 {unit}")
    } else {
        format!("{scaled:.decimals$} {prefix}{unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::quantity;

    #[test]
    fn picks_the_usual_prefix() {
        for (value, unit, text) in [
            (4.21e-5, "m", "42.1 µm"),
            (0.0, "m", "0 m"),
            (4e-11, "m", "0.04 nm"),
            (-0.25, "N·m", "-250 mN·m"),
            (12.0, "V", "12.0 V"),
            (999.96, "Hz", "1.00 kHz"),
            (9.999e-3, "s", "10.0 ms"),
            (123_456.0, "Hz", "123 kHz"),
            (-1e-12, "m", "0 m"),
        ] {
            assert_eq!(quantity(value, unit), text);
        }
    }
}
