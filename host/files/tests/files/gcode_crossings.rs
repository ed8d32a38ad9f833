//! M781: crossings in jobs.

use crate::placed::{job, refusal};
use fivebar_files::job::{Action, GcodeError, WarningKind};

#[test]
fn m781_crosses_to_a_point_in_the_modes_of_its_line_and_needs_its_time() {
    let text = "G1 X1 Y0 F600\nM781 X30 Y12 P0.3\nG91\nG20\nm781 p1 x1 y-1\n";
    let job = job(text);
    let crossings = job.steps.iter().filter_map(|step| match step.action {
        Action::Cross { to, time } => Some((step.line, step.tool, to, time)),
        _ => None,
    });
    let [first, second]: [_; 2] = crossings.collect::<Vec<_>>().try_into().unwrap();
    assert_eq!(first, (2, 0.0, [0.03, 0.012], 0.3));
    let (line, tool, [x, y], time) = second;
    assert_eq!((line, tool, time), (5, 0.0, 1.0));
    assert!((x - 0.0554).abs() < 1e-12 && (y + 0.0134).abs() < 1e-12);
    for (line, reason) in [
        ("M781", GcodeError::Crossing),
        ("M781 X1 Y2", GcodeError::Crossing),
        ("M781 X1 P0.3", GcodeError::Crossing),
        ("M781 X1 Y2 P0", GcodeError::Crossing),
        ("M781 X1 Y2 P0.3 F600", GcodeError::StrayWord('F')),
        ("F600 M781 X1 Y2 P0.3", GcodeError::StrayWord('F')),
        ("M781 X3000 X30 Y2 P0.3", GcodeError::Repeated('X')),
        ("M781 X1 Y2 P9 P0.3", GcodeError::Repeated('P')),
        ("G1 M781 X1 Y2 P0.3", with_crossing("G1")),
        ("M781 X1 Y2 P0.3 M5", with_crossing("M5")),
        ("M780 I1 J1 M781 X1 Y2 P0.3", with_crossing("M780")),
        ("M781 X1 Y2 P0.3 M781 X1 Y2 P0.3", with_crossing("M781")),
    ] {
        let text = format!("G1 X1 Y0 F600\n{line}\n");
        assert_eq!(refusal(&text), (2, reason), "{line}");
    }
}

fn with_crossing(code: &str) -> GcodeError {
    GcodeError::Conflict(code.into(), "M781".into())
}

#[test]
fn a_job_that_ends_in_the_other_assembly_mode_is_noted() {
    let there = "G1 X1 Y0 F600\nM781 X30 Y12 P0.3\n";
    let noted = |text: &str| {
        let warnings = job(text).warnings;
        let mut of_kind = warnings
            .iter()
            .filter(|warning| warning.kind == WarningKind::OtherAssembly);
        of_kind.next().map(|warning| warning.line)
    };
    assert_eq!(noted(there), Some(2));
    assert_eq!(noted(&format!("{there}M781 X1 Y0 P0.3\n")), None);
}
