//! The contactor in the bridges' supply: with the emergency stop pressed, the bus must fall, whatever
//! the controller does. That also shows that the bus voltage's sensor follows.

use super::super::bench::Bench;
use super::super::finding::StepError;

/// Share of its voltage to which the bus must fall: after 1.05 s with the wiring's C1 and R1.
const FALLEN: f64 = 0.8;
/// Share of its voltage to which it must come back.
const BACK: f64 = 0.95;
/// How long each is waited for [s]: C1 and R1 may have twice their values.
const TIMEOUT_S: f64 = 2.5;

/// The bus voltage [V].
pub(super) fn bus(bench: &mut Bench) -> Result<f64, StepError> {
    let per_code = f64::from(bench.settings.protection.bus_voltage_per_code);
    Ok(f64::from(bench.sample()?.drives.both) * per_code)
}

/// Waits until the bus, which had so many volts, has fallen; the time that it took [s].
pub(super) fn opens(bench: &mut Bench, volts: f64) -> Result<f64, StepError> {
    wait(bench, |bus| bus <= FALLEN * volts)?.ok_or_else(|| {
        StepError::wrong(
            format_args!("the bus stays at {volts:.1} V although the emergency stop is pressed"),
            "measure the bus: if it has fallen, check the divider at PC2; if not, check S1b and its wire \
             to the coil of K1, and whether the contact of K1 is welded; do not go on before it falls",
        )
    })
}

/// Waits until the bus, which had so many volts, is back.
pub(super) fn closes(bench: &mut Bench, volts: f64) -> Result<(), StepError> {
    let back = wait(bench, |bus| bus >= BACK * volts)?;
    back.map(|_| ()).ok_or_else(|| {
        StepError::wrong(
            "the bus does not come back although the emergency stop is released",
            "check S1b, K1 and its coil, F1 and the NTC",
        )
    })
}

/// Waits until the bus voltage is as wanted; the time that it took [s], none if it never is.
fn wait(bench: &mut Bench, is_so: impl Fn(f64) -> bool) -> Result<Option<f64>, StepError> {
    for step in 0..(TIMEOUT_S / 0.05) as u32 {
        if is_so(bus(bench)?) {
            return Ok(Some(0.05 * f64::from(step)));
        }
        bench.pause(0.05)?;
    }
    Ok(None)
}
