//! The step that works out what the drivers of steppers are to be set to.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::record::Value;
use super::Outcome;
use fivebar_kinematics::five_bar::Joint;

/// How a driver's current follows from the voltage at VREF.
struct Module {
    /// The driver and its sense resistor.
    name: &'static str,
    /// The current at the peak of a winding with 1 V at VREF [A/V].
    per_volt: f64,
    /// The greatest current at the peak of a winding [A].
    greatest: f64,
}

/// The internal resistance that a TMC22xx adds to its sense resistor [Ω], the voltage over both at full scale [V], and
/// that of VREF then [V] (data sheet, chapter 9).
const TMC: [f64; 3] = [0.02, 0.325, 2.5];

/// Of a TMC22xx with this sense resistor [Ω].
const fn tmc(name: &'static str, sense: f64) -> Module {
    let [inside, full_scale, vref] = TMC;
    let greatest = full_scale / (sense + inside);
    Module {
        name,
        per_volt: greatest / vref,
        greatest,
    }
}

/// Modules as they are sold. The current of an A4988 is VREF/(8 R), 2 A at most, that of a DRV8825 VREF/(5 R), 2.5 A at most.
const MODULES: [Module; 5] = [
    tmc("TMC2208 or TMC2209 with R110 (0.11 Ω)", 0.11),
    tmc("TMC2208 or TMC2209 with R150 (0.15 Ω)", 0.15),
    Module {
        name: "A4988 with R100 (0.1 Ω)",
        per_volt: 1.0 / (8.0 * 0.1),
        greatest: 2.0,
    },
    Module {
        name: "A4988 with R068 (0.068 Ω)",
        per_volt: 1.0 / (8.0 * 0.068),
        greatest: 2.0,
    },
    Module {
        name: "DRV8825 with R100 (0.1 Ω)",
        per_volt: 1.0 / (5.0 * 0.1),
        greatest: 2.5,
    },
];

/// Current scales of a TMC22xx in its registers.
const SCALES: f64 = 32.0;

impl Module {
    /// What to do for a peak of this current [A].
    fn setting(&self, peak: f64) -> String {
        match peak <= self.greatest {
            true => format!("{}: {:.2} V at VREF", self.name, peak / self.per_volt),
            false => format!(
                "{}: not possible, it gives {:.2} A at most",
                self.name, self.greatest
            ),
        }
    }
}

/// IRUN of a TMC22xx with a sense resistor of 0.11 Ω for a peak of this current [A], and the current that it gives [A].
fn irun(peak: f64) -> (f64, f64) {
    let [inside, full_scale, _] = TMC;
    let most = full_scale / (0.11 + inside);
    let scale = (SCALES * peak / most).floor().clamp(1.0, SCALES);
    (scale - 1.0, scale / SCALES * most)
}

/// What to set.
pub(in super::super) fn current(bench: &mut Bench) -> Result<Outcome, StepError> {
    let mut values = Vec::new();
    let mut found = Vec::new();
    for joint in Joint::ALL {
        let peak = bench.drive(joint)?.peak_current;
        bench.report(format_args!(
            "the motor of {joint} has {peak:.2} A at the peak of a winding, {:.2} A RMS:",
            peak / 2.0_f64.sqrt()
        ))?;
        for module in &MODULES {
            bench.report(format_args!("  {}", module.setting(peak)))?;
        }
        let (irun, gives) = irun(peak);
        bench.report(format_args!(
            "  TMC2209 over its UART, with 0.11 Ω: IRUN = {irun:.0} with vsense = 0, {gives:.2} A; IHOLD the same, because a \
             motor that is held weakly loses its place"
        ))?;
        let name = format!("peak_current{}_a", joint.number());
        values.push(Value::new(name, peak, "rated_current of the robot file"));
        found.push(format!("{joint}: {peak:.2} A"));
    }
    bench.report(
        "a data sheet that states the current RMS means 1.41 times as much at the peak; a TMC2209 belongs in SpreadCycle \
         (SPREAD high), because StealthChop gives a voltage and loses steps in motion",
    )?;
    if bench.robot.voltage_driver_warning().is_some() {
        bench.report(
            "the robot file says `driver = \"voltage\"`: tie SPREAD of each TMC2209 to VIO now, and then write \
             `driver = \"current\"`",
        )?;
    }
    bench.ask(Task::SetCurrent)?;
    Ok(Outcome::new(
        format!("set at the peak of a winding: {}", found.join(", ")),
        values,
    ))
}

#[cfg(test)]
mod tests {
    use super::{MODULES, irun};

    /// 2.5 V at VREF of a TMC2209 with 0.11 Ω are 1.77 A RMS, 2.5 A at the peak.
    #[test]
    fn settings_are_those_of_the_data_sheets() {
        let said: Vec<String> = MODULES.iter().map(|module| module.setting(1.7)).collect();
        assert_eq!(
            said,
            [
                "TMC2208 or TMC2209 with R110 (0.11 Ω): 1.70 V at VREF",
                "TMC2208 or TMC2209 with R150 (0.15 Ω): 2.22 V at VREF",
                "A4988 with R100 (0.1 Ω): 1.36 V at VREF",
                "A4988 with R068 (0.068 Ω): 0.92 V at VREF",
                "DRV8825 with R100 (0.1 Ω): 0.85 V at VREF",
            ]
        );
        let said = MODULES[1].setting(2.4);
        assert!(
            said.ends_with("not possible, it gives 1.91 A at most"),
            "{said}"
        );
        let (scale, gives) = irun(1.7);
        assert_eq!(scale, 20.0);
        assert!((gives - 1.640_625).abs() < 1e-9, "{gives}");
        assert_eq!(irun(9.0).0, 31.0);
    }
}
