//! Codes that change nothing here, codes that are refused because they would change the drawing,
//! and the words of the tool.

use crate::placed::{AS_WRITTEN, job, refusal};
use fivebar_files::job::{
    self, Action, Dialect, GcodeError, Job, JobOptions, Placement, ToolLevels, ToolWords,
    WarningKind,
};

fn with(options: JobOptions, text: &str) -> Job {
    Job::parse_with(text, &AS_WRITTEN, &options).unwrap_or_else(|refusal| panic!("{refusal}"))
}

fn levels(job: &Job) -> Vec<f64> {
    job.steps.iter().map(|step| step.tool).collect()
}

const SQUARE: &str = "G0 X5 Y5\nG1 X15 F900\nG3 X10 Y10 I-5\nG1 Y5";

#[test]
fn codes_that_change_nothing_here_are_accepted() {
    for codes in [
        "G15 G17 G40 G49 G50 G54 G61 G69 G80 G94 G97 G98",
        "G61.1",
        "G64 P0.01 Q0.01",
        "G29",
        "N7 G29 P1 A",
        "G10\nG11",
        "START_PRINT BED_TEMP=60 EXTRUDER_TEMP=210",
        "_HOME_IF_NEEDED",
        "TIMELAPSE HYPERLAPSE=1",
        "G91.1",
        "G55",
        "M7\nM8\nM9",
        "%\nO1001 (PLATE)",
        "\u{FEFF}; a mark",
        "G43 H1",
        "G92 E0",
        "G0 Z5",
        "M5",
    ] {
        let steps = job(&format!("{codes}\n\n{SQUARE}")).steps;
        let plain = job(&format!("{}\n{SQUARE}", "\n".repeat(codes.lines().count()))).steps;
        assert_eq!(steps, plain, "{codes}");
    }
    // On the line of a motion, too.
    let plain = job(SQUARE).steps;
    assert_eq!(
        job(&SQUARE.replace("G1 X15", "G17 G1 G94 X15")).steps,
        plain
    );
    assert_eq!(job(&SQUARE.replace("G1 X15", "G1 G43 H1 X15")).steps, plain);
    assert_eq!(job(&SQUARE.replace("I-5", "I-5 K0 Z0")).steps, plain);
}

#[test]
fn settings_and_commands_of_grbl_are_skipped_and_jogs_refused() {
    let text = "$H\n$32=1\nG21G90G0X1.Y.5\ng1x2.f60";
    let job = job(text);
    let notes: Vec<String> = job.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(notes[1], "line 1: $H is not supported and is skipped");
    assert_eq!(notes[2], "line 2: $32=1 is not supported and is skipped");
    assert_eq!(job.steps.len(), 2);
    assert_eq!(refusal("G0 X1\n$J=G91 X10 F100").0, 2);
}

#[test]
fn lines_end_with_a_carriage_return_a_line_feed_or_both() {
    let plain = job(SQUARE).steps;
    for end in ["\r", "\r\n"] {
        assert_eq!(job(&SQUARE.replace('\n', end)).steps, plain, "{end:?}");
    }
}

#[test]
fn marks_and_utf_16_are_read_and_utf_16_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let read = |bytes: &[u8]| {
        let path = folder.path().join("job.gcode");
        std::fs::write(&path, bytes).unwrap();
        job(&job::read(&path).unwrap())
    };
    let plain = job(SQUARE);
    assert_eq!(read(format!("\u{FEFF}{SQUARE}").as_bytes()), plain);
    let units = || {
        format!("\u{FEFF}{SQUARE}")
            .encode_utf16()
            .collect::<Vec<_>>()
    };
    let little: Vec<u8> = units().iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = units().iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [little, big] {
        let wide = read(&bytes);
        assert_eq!(wide.steps, plain.steps);
        assert!(wide.warnings[0].to_string().contains("UTF-16"));
    }
}

#[test]
fn codes_that_would_change_the_drawing_are_refused() {
    for code in [
        "G18", "G19", "G41 D1", "G42", "G81", "G93", "G95", "G5", "G10 L2",
    ] {
        let (line, reason) = refusal(&format!("G0 X1\n{code} X2 Y2\nG0 X3"));
        assert_eq!(line, 2, "{code}");
        assert!(matches!(reason, GcodeError::ChangesDrawing(..)), "{reason}");
    }
    let second = GcodeError::SecondSystem("G55".into(), "G54".into());
    assert_eq!(refusal("G54\nG0 X1\nG55\nG0 X1"), (3, second));
    let subprogram = GcodeError::Subprogram("M98".into());
    assert_eq!(refusal("G0 X1\nM98 P100"), (2, subprogram));
    assert_eq!(refusal("F9\nG2 X2 I1 K1"), (2, GcodeError::StrayWord('K')));
}

#[test]
fn an_arc_on_which_the_tool_touches_down_is_refused_and_others_may_be_helices() {
    let helix = |from: f64, to: f64| {
        format!("F900\nG0 Z5\nG0 X0 Y0\nG1 Z-1\nG1 Z{from}\nG2 X10 I5 Z{to}\nG0 Z5")
    };
    assert_eq!(refusal(&helix(1.0, -1.0)), (6, GcodeError::Helix));
    assert_eq!(refusal(&helix(0.0, 0.5)), (6, GcodeError::Helix));
    assert_eq!(levels(&job(&helix(-0.5, -3.0))), [0.0, 1.0]);
    assert_eq!(levels(&job(&helix(4.0, 1.0))), [0.0, 0.0]);
}

#[test]
fn exponents_are_refused_and_the_extruder_is_not() {
    for number in ["1e-5", "1E-5", "1.5e3", "1.e3", "2E3"] {
        let text = format!("G0 X3\nG0 X{number} Y1");
        assert_eq!(refusal(&text), (2, GcodeError::Exponent), "{number}");
    }
    let ends = job("G1 F9 X1.5E0.25\nG1 X2 E5\nG1X3E.5");
    assert_eq!(ends.steps.len(), 4);
}

#[test]
fn words_after_an_unknown_m_code_move_nothing() {
    let text = "G0 X1\nM201 X500 Y500 Z10\nM92 X80 E93\nM204 P9 R9 T9\nG0 X3";
    assert_eq!(job(text).steps.len(), 2);
    let notes: Vec<_> = job(text).warnings.iter().map(|note| note.line).collect();
    assert_eq!(notes[1..], [2, 3, 4]);
}

#[test]
fn machine_coordinates_count_from_home() {
    let placement = Placement {
        origin: [0.1, 0.2],
        scale: 2.0,
        turn: 0.3,
        home: [0.05, 0.25],
    };
    let job = Job::parse("G0 X7 Y9\nG53 G0 X-10\nG91\nG53 G0 X0 Y0\nG28", &placement).unwrap();
    let ends: Vec<_> = job
        .steps
        .iter()
        .map(|step| step.action.end().unwrap())
        .collect();
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
    assert!(near(ends[1], [0.04, ends[0][1]]), "{ends:?}");
    assert!(near(ends[2], [0.05, 0.25]) && ends.len() == 3, "{ends:?}");
}

#[test]
fn a_turned_job_is_turned_about_its_origin() {
    let placement = Placement {
        origin: [0.1, 0.2],
        scale: 2.0,
        turn: std::f64::consts::FRAC_PI_2,
        home: [0.0; 2],
    };
    let job = Job::parse("G0 X10\nG3 X20 I5 F60", &placement).unwrap();
    let Action::Arc { to, center, .. } = job.steps[1].action else {
        panic!("{job:?}");
    };
    for (found, expected) in [(to, [0.1, 0.24]), (center, [0.1, 0.23])] {
        assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-12);
    }
}

#[test]
fn absolute_centres_of_arcs_equal_relative_ones() {
    let relative = job("G92 X3 Y4\nF60\nG0 X10 Y5\nG2 X20 Y5 I5 J0\nG3 X20 Y15 J5");
    let absolute = job("G92 X3 Y4\nG90.1 F60\nG0 X10 Y5\nG2 X20 Y5 I15 J5\nG3 X20 Y15 J10");
    assert_eq!(absolute.steps.len(), relative.steps.len());
    for (a, b) in absolute.steps.iter().zip(&relative.steps) {
        if let (Action::Arc { center: a, .. }, Action::Arc { center: b, .. }) = (a.action, b.action)
        {
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12);
        }
    }
}

#[test]
fn dwells_are_in_the_dialects_unit() {
    let dwell = |options: JobOptions, text: &str| {
        let found = with(options, text);
        let durations = found.steps.iter().filter_map(|step| match step.action {
            Action::Dwell { duration } => Some(duration),
            _ => None,
        });
        durations.sum::<f64>()
    };
    let found = JobOptions::default();
    let stated = |dialect| JobOptions {
        dialect: Some(dialect),
        ..found
    };
    let grbl = "G0 X1\nG4 P1.5";
    assert_eq!(dwell(found, grbl), 1.5);
    assert_eq!(dwell(stated(Dialect::RepRap), grbl), 1.5e-3);
    for sign in ["M18", "M106", "M82", "G92 E0", "N3 M5*55"] {
        let sign = if sign.contains('*') {
            let sum = "N3 M5".bytes().fold(0, |sum, byte| sum ^ byte);
            format!("N3 M5*{sum}")
        } else {
            sign.into()
        };
        let text = format!("G0 X1\nG4 P160\n{sign}");
        assert_eq!(dwell(found, &text), 0.16, "{sign}");
        assert_eq!(dwell(stated(Dialect::Grbl), &text), 160.0, "{sign}");
    }
    assert_eq!(dwell(found, "G0 X1\nG4 S3600.5"), 3600.5);
    for bad in ["G4", "G4 P-1", "G4 S86401", "G4 P86401", "G4 X1"] {
        let text = format!("G0 X1\n{bad}");
        assert_eq!(
            refusal(&text),
            (2, GcodeError::Dwell(Dialect::Grbl)),
            "{bad}"
        );
    }
    let note = |text| job(&format!("M3\n{text}")).warnings[0].to_string();
    assert!(note(grbl).contains("P of G4 is in seconds"));
    assert!(note("G0 X1\nG4 P9\nM82").contains("milliseconds, as RepRap has it, because of M82"));
}

#[test]
fn the_spindle_has_the_share_of_its_full_power() {
    let text = "G0 X1\nM3\nG1 X2 F60\nM3 S250\nG1 X3\nM5\nG1 X4\nM4\nG1 X5\nG0 X6\nS5000\nG1 X7";
    let plain = [0.0, 1.0, 0.25, 0.0, 0.25, 0.0, 1.0];
    assert_eq!(levels(&job(text)), plain);
    let halved = JobOptions {
        full_power: 500.0,
        ..JobOptions::default()
    };
    assert_eq!(levels(&with(halved, text))[2], 0.5);
    // A pen on M3 stays down on G0; a laser, whose motions have S, is off.
    assert_eq!(
        levels(&job("G0 X0\nM3 S500\nG0 X1\nG1 X2 F60")),
        [0.0, 0.5, 0.5]
    );
    assert_eq!(
        levels(&job("G0 X0\nM3 S500\nG0 X1\nG1 X2 F60 S500")),
        [0.0, 0.0, 0.5]
    );
}

#[test]
fn the_servo_of_m300_is_down_up_to_40() {
    let text =
        "G0 X1\nM300 S30.00 (down)\nG0 X2\nM300 S50\nG0 X3\nM300 S5\nG0 X4\nM300 S255\nG0 X5";
    let job = job(text);
    assert_eq!(levels(&job), [0.0, 1.0, 0.0, 1.0, 0.0]);
    assert!(job.draws(3) && !job.draws(5) && !job.draws(99));
}

#[test]
fn one_kind_of_words_moves_the_tool() {
    let text = "M3 S500\nG0 Z5\nG0 X1\nG1 Z-1 F60\nG1 X2 E1\nM107";
    let level = |tool| {
        let options = JobOptions {
            tool,
            ..JobOptions::default()
        };
        *levels(&with(options, text)).last().unwrap()
    };
    assert_eq!(level(None), 1.0, "E comes first");
    assert_eq!(level(Some(ToolWords::Spindle)), 0.5);
    assert_eq!(level(Some(ToolWords::Fan)), 0.0);
    assert_eq!(levels(&job(&text.replace(" E1", ""))), [0.0, 1.0], "then Z");
    let spindle = "G0 X0\nM3 S500\nG0 Z5\nG0 X1\nG1 X2 F60";
    assert_eq!(levels(&job(spindle)), [0.0, 0.5, 0.5], "then the spindle");
}

#[test]
fn z_at_or_below_the_height_is_down() {
    let text = "F600\nG0 X0 Y0 Z5\nG1 Z0\nG1 X10\nG1 Z0.1\nG1 X20\nG91\nG1 Z-0.5\nG1 X10";
    assert_eq!(levels(&job(text)), [0.0, 1.0, 0.0, 1.0]);
    let higher = JobOptions {
        pen_height: Some(2e-4),
        ..JobOptions::default()
    };
    assert_eq!(levels(&with(higher, text)), [0.0, 1.0, 1.0, 1.0]);
    // Heights on one side of 0: the middle between them.
    let deep = job("F600\nG0 Z0\nG0 X5\nG1 Z-2\nG1 X10");
    assert_eq!(levels(&deep), [0.0, 1.0]);
    let note = &deep.warnings[0];
    assert_eq!((note.line, &note.kind), (2, &WarningKind::PenHeight(-1e-3)));
}

#[test]
fn a_motion_on_which_the_tool_touches_down_is_divided_there() {
    let job = job("F600\nG0 X0 Y0 Z3\nG1 X8 Y4 Z-1\nG1 X12 Z1");
    let mm = |point: [f64; 2]| point.map(|metres| (1e6 * metres).round() / 1e3);
    let ends = job.steps.iter().map(|step| mm(step.action.end().unwrap()));
    assert!(ends.eq([[0.0, 0.0], [6.0, 3.0], [8.0, 4.0], [10.0, 4.0], [12.0, 4.0]]));
    assert_eq!(levels(&job), [0.0, 0.0, 1.0, 1.0, 0.0]);
}

#[test]
fn stops_are_kept_with_their_place_and_noted() {
    let job = job("G0 X1\nM0 (paper)\nG0 X2\nM01\nM6 T2\nT1\nG0 X3\nG0 X4 M1\nG0 X5 M6 T4\nM300");
    let stops: Vec<_> = job
        .stops
        .iter()
        .map(|it| (it.line, it.before, it.code.as_str()))
        .collect();
    assert_eq!(
        stops,
        [
            (2, 1, "M0"),
            (4, 2, "M1"),
            (5, 2, "M6 T2"),
            (6, 2, "T1"),
            (8, 4, "M1"),
            (9, 4, "M6 T4")
        ]
    );
    let noted: Vec<_> = job.warnings.iter().map(|note| note.line).collect();
    assert_eq!(noted, [0, 2, 4, 5, 6, 9, 10]);
}

#[test]
fn m780_changes_the_working_mode_where_the_tool_is_and_needs_both_elbows() {
    use fivebar_kinematics::five_bar::{Side, WorkingMode};
    let text = "G1 X1 Y0 F600\nm780 i-1 j1 ; to the right\nG4 P1\nG1 X2 M780 I1 J1\n";
    let job = job(text);
    let changes = job.steps.iter().filter_map(|step| match step.action {
        Action::ChangeMode(mode) => Some((step.line, step.tool, mode)),
        _ => None,
    });
    let left = WorkingMode::new(Side::Left, Side::Left);
    let expected = [
        (2, 0.0, WorkingMode::new(Side::Right, Side::Left)),
        (4, 0.0, left),
    ];
    assert_eq!(changes.collect::<Vec<_>>(), expected);
    // It is no sign of RepRap: P is in seconds.
    assert!(
        job.steps
            .iter()
            .any(|step| step.action == Action::Dwell { duration: 1.0 })
    );
    for (line, reason) in [
        ("M780", GcodeError::Elbows),
        ("M780 I1", GcodeError::Elbows),
        ("M780 I1 J2", GcodeError::Elbows),
        ("M780 I0 J1", GcodeError::Elbows),
        ("M780 I1 J1 X5", GcodeError::StrayWord('X')),
        ("M780 I1 I-1 J1", GcodeError::Repeated('I')),
    ] {
        let text = format!("G1 X1 Y0 F600\n{line}\n");
        assert_eq!(refusal(&text), (2, reason), "{line}");
    }
}

/// The levels on a tool of two states, and the notes.
fn pen(speeds: Option<[f64; 2]>, text: &str) -> (Vec<f64>, Vec<WarningKind>) {
    let options = JobOptions {
        levels: ToolLevels::TwoStates(speeds),
        ..JobOptions::default()
    };
    let job = with(options, text);
    let notes = job.warnings.iter().map(|note| note.kind.clone());
    (levels(&job), notes.collect())
}

#[test]
fn a_pen_is_down_at_any_speed_above_zero() {
    let down = vec![WarningKind::PenDown];
    let lightburn = "M4\nG0 X5 Y5\nG1 X10 F1200 S300\nG1 X15 S0\nG1 X20 S600\nM5";
    assert_eq!(
        pen(None, lightburn),
        (vec![0.0, 1.0, 0.0, 1.0], down.clone())
    );
    let switched = "G0 X5 Y5\nM3 S90\nG1 X10 F1200\nM5\nG0 X20\nM3 S40\nG1 Y9\nM5\nG0 X0";
    let drawn = vec![0.0, 1.0, 0.0, 1.0, 0.0];
    assert_eq!(pen(None, switched), (drawn, down));
    let fan = "G0 X5\nM106 S80\nG1 X10 F60\nM107\nG0 X2";
    assert_eq!(pen(None, fan).0, [0.0, 1.0, 0.0]);
}

#[test]
fn of_two_speeds_of_a_pen_that_of_travel_is_up() {
    let servo = "M3 S30\nG0 X5 Y5\nM3 S90\nG1 X10 F1200\nM3 S30\nG0 X20\nM3 S90\nG1 X9 Y9\n\
                 M3 S30\nG0 X0 Y0\nM5";
    let drawn = vec![0.0, 1.0, 0.0, 1.0, 0.0];
    let found = |down, up| vec![WarningKind::PenSpeeds { down, up }];
    assert_eq!(pen(None, servo), (drawn.clone(), found(90.0, 30.0)));
    let swapped = servo
        .replace("S30", "S9")
        .replace("S90", "S30")
        .replace("S9\n", "S90\n");
    assert_eq!(pen(None, &swapped), (drawn.clone(), found(30.0, 90.0)));
    // Travel by G1: more lines are drawn.
    let slow = servo
        .replace("G0", "G1 F900")
        .replace("G1 X9 Y9", "G1 X9 Y9\nX10\nX11\nX12");
    let drawn_slowly = vec![0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0];
    assert_eq!(pen(None, &slow), (drawn_slowly, found(90.0, 30.0)));
    // The robot file decides.
    assert_eq!(pen(Some([90.0, 30.0]), servo), (drawn, vec![]));
    let other = vec![0.0, 1.0, 0.0, 1.0, 0.0, 1.0];
    assert_eq!(pen(Some([30.0, 90.0]), servo), (other, vec![]));
    // As a laser, S is a share.
    assert_eq!(levels(&job(servo)), [0.0, 0.03, 0.09, 0.03, 0.09, 0.03]);
}
