//! Whether the simulated arm drew its job within a tolerance, and why not.
//!
//! Only the simulation can tell: it knows where the tip truly is. A motor without an encoder reports no fault when it
//! loses steps.

use super::{Record, ServoLimits, WorstError};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::safety::Fault;
use serde::Serialize;

/// Greatest tip error of a job that is drawn, unless another tolerance is given [m].
pub const TOLERANCE: f64 = 1e-3;

/// Whether the simulated arm drew its job.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Verdict {
    /// The job was finished without a fault, and the tip stayed within the tolerance while it drew.
    pub drawn: bool,
    /// Why it is not drawn, in a sentence; none if it is.
    pub why: Option<String>,
    /// Greatest tip error while the tool was down, and where an unfinished job ended [m]. Of a job that never puts the
    /// tool down: of its whole motion.
    pub worst_m: f64,
    /// The tolerance [m].
    pub tolerance_m: f64,
}

impl Verdict {
    /// The verdict on a run of this scenario.
    pub(super) fn new(scenario: &Scenario, record: &Record, servos: Option<ServoLimits>) -> Self {
        let drawing = &record.drawing;
        let finished = record.finished && record.faults.is_empty();
        let mut worst = drawing.down.unwrap_or(drawing.whole);
        if !finished {
            worst = worst.or(drawing.end);
        }
        let tolerance = scenario
            .tolerance
            .unwrap_or_else(|| tolerance_of(servos, drawing.speed));
        let why = ended_by(record)
            .or_else(|| (!finished).then(|| "the run was stopped before the job was done".into()))
            .or_else(|| (worst.error > tolerance).then(|| off(scenario, record, worst, tolerance)));
        Self {
            drawn: why.is_none(),
            why,
            worst_m: worst.error,
            tolerance_m: tolerance,
        }
    }
}

/// The tolerance of drives that state none, and of hobby servos, which state theirs: the dead band, and the path that is
/// drawn at `speed` [m/s] in the time by which they are late.
fn tolerance_of(servos: Option<ServoLimits>, speed: f64) -> f64 {
    let stated = servos.map_or(0.0, |servos| servos.dead_band_m + servos.late_s * speed);
    stated.max(TOLERANCE)
}

/// Which fault stopped the arm, and when; none without a fault.
pub fn ended_by(record: &Record) -> Option<String> {
    let (time, fault) = record.faults.first()?;
    let when = match record.begun {
        Some(begun) => format!("{:.4} s into the job", time - begun),
        None => format!("{time:.4} s after power-up, while homing"),
    };
    let (number, name) = (fault.number(), fault_name(*fault));
    Some(format!(
        "the arm stopped {when} with fault {number}, {name}"
    ))
}

/// A fault's name in words: "encoder jump".
pub fn fault_name(fault: Fault) -> String {
    let mut name = String::new();
    for letter in format!("{fault:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push(' ');
        }
        name.extend(letter.to_lowercase());
    }
    name
}

fn off(scenario: &Scenario, record: &Record, worst: WorstError, tolerance: f64) -> String {
    let lost = match record.lost_steps {
        Some([lost1, lost4]) if [lost1, lost4] != [0, 0] => {
            format!("; the motors lost {lost1} and {lost4} full steps")
        }
        _ => String::new(),
    };
    let reason = format!(
        "the tip was {} from its place {:.3} s into the job, and the tolerance is {}{lost}",
        millimetres(worst.error),
        worst.time,
        millimetres(tolerance)
    );
    scenario.named(worst.line, &reason)
}

/// A length in words, to a thousandth of a millimetre.
fn millimetres(length: f64) -> String {
    match length.is_finite() {
        true => format!("{:.3} mm", 1e3 * length),
        false => "at an unknown distance".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::{TOLERANCE, Verdict};
    use crate::simulation::{Drawing, Record, ServoLimits, WorstError};
    use fivebar_files::robot::Robot;
    use fivebar_files::scenario::Scenario;
    use fivebar_firmware::safety::Fault;

    fn worst(error: f64) -> WorstError {
        WorstError {
            error,
            time: 1.5,
            line: 7,
        }
    }

    /// The verdict on a finished run with these worst errors with the tool down, of the whole job and at its end [m].
    fn record([down, whole, end]: [f64; 3]) -> Record {
        Record {
            finished: true,
            begun: Some(1.0),
            drawing: Drawing {
                down: Some(worst(down)),
                whole: worst(whole),
                end: worst(end),
                speed: 0.02,
            },
            ..Record::default()
        }
    }

    fn verdict(
        change: impl Fn(&mut Scenario, &mut Record),
        servos: Option<ServoLimits>,
    ) -> Verdict {
        let mut scenario = Scenario::demonstration(Robot::load("benchtop").unwrap());
        let mut record = record([0.5e-3, 20e-3, 20e-3]);
        change(&mut scenario, &mut record);
        Verdict::new(&scenario, &record, servos)
    }

    #[test]
    fn only_errors_of_what_is_drawn_count_in_a_finished_job() {
        let found = verdict(|_, _| (), None);
        assert_eq!((found.drawn, found.why.as_deref()), (true, None));
        assert_eq!((found.worst_m, found.tolerance_m), (0.5e-3, TOLERANCE));
        let found = verdict(|scenario, _| scenario.tolerance = Some(0.4e-3), None);
        let why = found.why.unwrap();
        assert!(
            !found.drawn && why.contains("line 7: the tip was 0.500 mm"),
            "{why}"
        );
        // A job that never puts the tool down is judged as a whole.
        let found = verdict(|_, record| record.drawing.down = None, None);
        assert!(!found.drawn && found.worst_m == 20e-3);
    }

    #[test]
    fn an_unfinished_job_is_not_drawn_and_its_end_counts() {
        let found = verdict(|_, record| record.finished = false, None);
        assert!(!found.drawn && found.worst_m == 20e-3);
        assert!(
            found
                .why
                .unwrap()
                .contains("stopped before the job was done")
        );
        let fault = |_: &mut Scenario, record: &mut Record| {
            record.finished = false;
            record.faults.push((1.25, Fault::EmergencyStop));
        };
        let why = verdict(fault, None).why.unwrap();
        assert_eq!(
            why,
            "the arm stopped 0.2500 s into the job with fault 10, emergency stop"
        );
    }

    #[test]
    fn a_position_that_is_not_a_number_is_no_drawing() {
        let nan = |_: &mut Scenario, record: &mut Record| {
            let drawing = &mut record.drawing;
            let down = drawing.down.unwrap().or(worst(f64::NAN)).or(worst(1.0));
            drawing.down = Some(down);
        };
        let found = verdict(nan, None);
        assert!(!found.drawn && found.worst_m.is_infinite());
        let why = found.why.unwrap();
        assert!(!why.contains("inf") && !why.contains("NaN"), "{why}");
    }

    #[test]
    fn hobby_servos_have_the_tolerance_that_they_state() {
        let servos = ServoLimits {
            dead_band_m: 1.5e-3,
            late_s: 0.04,
        };
        let found = verdict(|_, _| (), Some(servos));
        assert!((found.tolerance_m - (1.5e-3 + 0.04 * 0.02)).abs() < 1e-12);
        let own = verdict(|scenario, _| scenario.tolerance = Some(2e-3), Some(servos));
        assert_eq!(own.tolerance_m, 2e-3);
    }

    #[test]
    fn lost_steps_are_in_the_reason() {
        let lost = |_: &mut Scenario, record: &mut Record| {
            record.drawing.down = Some(worst(5e-3));
            record.lost_steps = Some([12, -16]);
        };
        let why = verdict(lost, None).why.unwrap();
        assert!(
            why.ends_with("; the motors lost 12 and -16 full steps"),
            "{why}"
        );
    }
}
