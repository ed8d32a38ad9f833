//! A calibration as text.

use super::quantity;
use crate::study::calibration::ProposalStudy;
use fivebar_design::calibration::{PARAMETER_NAMES, Parameters, TipError};
use fivebar_files::robot::Robot;
use nalgebra::SMatrix;
use std::fmt::Write as _;

/// What a calibration of any kind of measurement found.
pub struct Calibrated<'a> {
    /// The robot as in its file.
    pub robot: &'a Robot,
    /// The arm as found.
    pub parameters: &'a Parameters,
    /// The covariance of its ten unknowns; zero for those that are held.
    pub covariance: &'a SMatrix<f64, 10, 10>,
    /// Whether the placement is known.
    pub placed: bool,
    /// Name, rows, those of them that are named as wrong, and residuals' root mean square [m] of
    /// each kind of measurement.
    pub kinds: Vec<(&'a str, usize, usize, f64)>,
    /// The error of the nominal arm over the workspace.
    pub before: Option<&'a TipError>,
    /// The expected error over the workspace.
    pub after: Option<&'a TipError>,
}

/// Proposed holes, and what to expect of them.
pub fn proposal(name: &str, study: &ProposalStudy) -> String {
    let mut text = format!("{name}: holes to touch, in the arm's own frame\n");
    for (index, place) in study.proposal.points.iter().enumerate() {
        let _ = writeln!(
            text,
            "  {:>3}  x {:>8.1} mm  y {:>8.1} mm",
            index + 1,
            1e3 * place.x,
            1e3 * place.y
        );
    }
    let _ = writeln!(
        text,
        "  observability O1 {:.4}",
        study.proposal.observability
    );
    if let Some(error) = &study.tip_error {
        let _ = writeln!(
            text,
            "  tip error to expect with holes of {}: {} RMS, {} at the worst place",
            quantity(study.sigma, "m"),
            quantity(error.rms, "m"),
            quantity(error.worst, "m")
        );
    }
    text
}

/// The unknowns with their deviations, the residuals, and the tip's error.
pub fn calibration(found: &Calibrated<'_>) -> String {
    let (p, robot) = (found.parameters, found.robot);
    let mut text = format!(
        "{}\n          found           ±            in the file\n",
        robot.name
    );
    let ([x, y], [d1, d4]) = (p.origin, p.offsets);
    let [l1, l2, l3, l4, l5] = p.lengths;
    let values = [l1, l2, l3, l4, l5, d1, d4, x, y, p.turn];
    let nominal = robot.geometry.lengths();
    let shown = if found.placed { 10 } else { 7 };
    for (index, name) in PARAMETER_NAMES.iter().enumerate().take(shown) {
        let sd = found.covariance[(index, index)].sqrt();
        let (unit, base) = match index {
            5 | 6 | 9 => ("mrad", "rad"),
            _ => ("mm", "m"),
        };
        let nominal = nominal.get(index);
        let nominal = nominal.map_or(String::new(), |l| format!("{:.4} mm", 1e3 * l));
        let line = format!(
            "  {name:<3} {:>10.4} {unit:<4}  {:>10}  {nominal:>14}",
            1e3 * values[index],
            match sd {
                0.0 => "held".into(),
                sd => quantity(sd, base),
            },
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    for (kind, count, far, rms) in &found.kinds {
        let rms = quantity(*rms, "m");
        let _ = match far {
            0 => writeln!(text, "  residuals of {count} rows ({kind}): {rms} RMS"),
            far => writeln!(
                text,
                "  residuals of {count} rows ({kind}), {far} of them named as wrong: {rms} RMS"
            ),
        };
    }
    let errors = [
        ("the arm of the file", found.before),
        ("expected now", found.after),
    ];
    for (when, error) in errors {
        if let Some(error) = error {
            let _ = writeln!(
                text,
                "  tip error over the workspace, {when}: {} RMS, {} at the worst place",
                quantity(error.rms, "m"),
                quantity(error.worst, "m")
            );
        }
    }
    text
}
