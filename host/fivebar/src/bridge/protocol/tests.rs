//! Tests of both protocols: text in, orders and answers out.

use super::{Engine, Input, Line, MachineState, Order, Refusal, Response, Splitter, View};
use fivebar_files::job::{Dialect, JobOptions, Placement};
use fivebar_firmware::{FULL_TOOL, MoveKind, Settings};
use fivebar_sim::path_queue::Shares;
use proptest::prelude::*;

const HOME: [f64; 2] = [0.04, 0.2];

fn engine() -> Engine {
    let placement = Placement {
        origin: HOME,
        scale: 1.0,
        turn: 0.0,
        home: HOME,
    };
    let mut engine = Engine::new(&placement, JobOptions::default(), &Settings::BENCHTOP);
    engine.set_position(HOME);
    engine
}

fn view() -> View {
    View {
        state: MachineState::Idle,
        homed: true,
        armed: true,
        tool: Some([0.05, 0.18]),
        speed: 0.01,
        level: 0.5,
        shares: Shares {
            feed: 0.9,
            rapid: 0.25,
            power: 1.1,
        },
        free: 16,
        waiting: 28,
    }
}

/// The response to a text, as a connection would pass it on.
fn ask(engine: &mut Engine, text: &str, view: &View) -> Result<Response, Refusal> {
    let mut splitter = Splitter::new(None);
    let inputs: Vec<Input> = format!("{text}\n")
        .bytes()
        .flat_map(|byte| splitter.feed(byte).collect::<Vec<_>>())
        .collect();
    let [Input::Line(line)] = inputs.as_slice() else {
        panic!("{text} is no single line: {inputs:?}");
    };
    engine.line(line, view)
}

/// A line with its number and its checksum.
fn numbered(number: i64, text: &str) -> String {
    let summed = format!("N{number} {text}");
    let sum = summed.bytes().fold(0, |sum: u8, byte| sum ^ byte);
    format!("{summed}*{sum}")
}

#[test]
fn a_report_has_the_fields_of_grbl() {
    let mut engine = engine();
    let report = engine.report(&view());
    let expected = "<Idle|MPos:10.000,-20.000,0.000|Bf:16,100|FS:600,500|WCO:0.000,0.000,0.000|Ov:90,25,110>\n";
    assert_eq!(report, expected);
    engine.set_position([0.05, 0.18]);
    ask(&mut engine, "G92 X5 Y0", &view()).unwrap();
    let report = engine.report(&View {
        state: MachineState::Hold { rests: true },
        ..view()
    });
    assert!(report.starts_with("<Hold:0|"), "{report}");
    assert!(
        report.ends_with("|WCO:5.000,-20.000,0.000|Ov:90,25,110>\n"),
        "{report}"
    );
}

#[test]
fn grbl_counts_the_characters_of_lines_that_wait() {
    let report = engine().report(&View {
        waiting: 128,
        ..view()
    });
    assert!(report.contains("|Bf:16,0|"), "{report}");
}

#[test]
fn a_line_becomes_a_move_and_is_answered_ok() {
    let mut engine = engine();
    let response = ask(&mut engine, "G1 X10 F6000", &view()).unwrap();
    assert_eq!((response.text.as_str(), response.ok.as_str()), ("", "ok\n"));
    let [Order::Moves(moves)] = response.orders.as_slice() else {
        panic!("{response:?}");
    };
    let MoveKind::Line { to, feed } = moves[0].kind else {
        panic!("{moves:?}");
    };
    assert!(
        (to[0] - 0.05).abs() < 1e-7 && (to[1] - 0.2).abs() < 1e-7,
        "{to:?}"
    );
    assert!((feed - 0.1).abs() < 1e-8);
    assert_eq!(moves[0].tool, FULL_TOOL);
}

#[test]
fn a_refused_line_gets_its_number_and_says_why() {
    let mut engine = engine();
    let refusal = ask(&mut engine, "G1 X10", &view()).unwrap_err();
    let answer = engine.refuse(Dialect::Grbl, &refusal);
    assert!(answer.starts_with("[MSG:no feed rate yet"), "{answer}");
    assert!(answer.ends_with("\nerror:22\n"), "{answer}");
    let answer = engine.refuse(Dialect::RepRap, &refusal);
    assert!(answer.starts_with("Error:no feed rate yet"), "{answer}");
    assert!(answer.ends_with("\nok\n"), "{answer}");
    assert_eq!(ask(&mut engine, "G99999", &view()).unwrap_err().code, 20);
    assert_eq!(ask(&mut engine, "$13=1", &view()).unwrap_err().code, 3);
}

#[test]
fn a_move_that_the_machine_refuses_leaves_the_position() {
    let mut engine = engine();
    ask(&mut engine, "G91 G1 X900 F600", &view()).unwrap();
    engine.refuse(Dialect::Grbl, &Refusal::new(15, "out of reach"));
    // The mode of the refused line is forgotten too.
    let response = ask(&mut engine, "G1 X10 F6000", &view()).unwrap();
    let [Order::Moves(moves)] = response.orders.as_slice() else {
        panic!("{response:?}");
    };
    let MoveKind::Line { to, .. } = moves[0].kind else {
        panic!("{moves:?}");
    };
    assert!((to[0] - 0.05).abs() < 1e-7, "{to:?}");
}

#[test]
fn before_homing_only_homing_moves() {
    let mut engine = engine();
    let unhomed = View {
        homed: false,
        armed: false,
        state: MachineState::Alarm,
        ..view()
    };
    for line in ["G1 X1 F100", "G92 X3", "$J=X1 F100"] {
        assert_eq!(
            ask(&mut engine, line, &unhomed).unwrap_err().code,
            9,
            "{line}"
        );
    }
    for line in ["$H", "G28", "G28 X Y", "g28 X0"] {
        let response = ask(&mut engine, line, &unhomed).unwrap();
        assert_eq!(response.orders, [Order::Home], "{line}");
    }
    assert_eq!(ask(&mut engine, "G21 G90", &unhomed).unwrap().orders, []);
}

#[test]
fn a_jog_has_modes_of_its_own_and_a_tool_that_is_up() {
    let mut engine = engine();
    ask(&mut engine, "M3 S1000", &view()).unwrap();
    let response = ask(&mut engine, "$J=G91 G20 X0.1 F20", &view()).unwrap();
    let [Order::Jog(moves)] = response.orders.as_slice() else {
        panic!("{response:?}");
    };
    assert_eq!(moves[0].tool, 0);
    let MoveKind::Line { to, .. } = moves[0].kind else {
        panic!("{moves:?}");
    };
    assert!((to[0] - 0.04254).abs() < 1e-7, "{to:?}");
    let modes = ask(&mut engine, "$G", &view()).unwrap().text;
    assert!(modes.contains("G21 G90"), "{modes}");
    let running = View {
        state: MachineState::Run,
        ..view()
    };
    assert_eq!(ask(&mut engine, "$J=X0 F20", &running).unwrap_err().code, 8);
}

#[test]
fn a_tool_that_is_switched_at_rest_changes_at_once() {
    let mut engine = engine();
    ask(&mut engine, "M3 S1000", &view()).unwrap();
    ask(&mut engine, "G1 X10 F6000", &view()).unwrap();
    let response = ask(&mut engine, "M5", &view()).unwrap();
    let [Order::Moves(moves)] = response.orders.as_slice() else {
        panic!("{response:?}");
    };
    assert!(matches!(moves[0].kind, MoveKind::Dwell { .. }));
    assert_eq!(moves[0].tool, 0);
    assert_eq!(ask(&mut engine, "M5", &view()).unwrap().orders, []);
}

#[test]
fn unknown_m_codes_are_noted_and_stops_wait() {
    let mut engine = engine();
    let response = ask(&mut engine, "M42 P1", &view()).unwrap();
    assert!(response.text.starts_with("[MSG:M42 "), "{response:?}");
    assert_eq!((response.orders.len(), response.ok.as_str()), (0, "ok\n"));
    for line in ["M0", "M1", "M6 T2"] {
        assert_eq!(
            ask(&mut engine, line, &view()).unwrap().orders,
            [Order::Pause]
        );
    }
}

#[test]
fn a_wrong_checksum_is_asked_for_again() {
    let mut engine = engine();
    let numbers = |engine: &mut Engine, line: &str| ask(engine, line, &view()).unwrap();
    assert_eq!(numbers(&mut engine, "N0 M110 N0*125").ok, "ok\n");
    assert_eq!(numbers(&mut engine, &numbered(1, "G91")).text, "");
    let response = numbers(&mut engine, "N2 G1 X10 F600*1");
    let expected = "Error:checksum mismatch, Last Line: 1\nResend: 2\n";
    assert_eq!(
        (response.text.as_str(), response.ok.as_str()),
        (expected, "ok\n")
    );
    assert_eq!(response.orders, []);
    // A line that was left out.
    let response = numbers(&mut engine, &numbered(3, "G1 X10 F600"));
    assert!(response.text.ends_with("Resend: 2\n"), "{response:?}");
    assert_eq!(response.orders, []);
    let response = numbers(&mut engine, &numbered(2, "G1 X10 F600"));
    assert!(matches!(response.orders[..], [Order::Moves(_)]));
}

#[test]
fn a_feed_rate_of_zero_changes_nothing_in_reprap() {
    let mut engine = engine();
    ask(&mut engine, &numbered(1, "G1 X1 F600"), &view()).unwrap();
    ask(&mut engine, &numbered(2, "G1 F0.0"), &view()).unwrap();
    let response = ask(&mut engine, &numbered(3, "G1 X2 F0"), &view()).unwrap();
    let [Order::Moves(moves)] = response.orders.as_slice() else {
        panic!("{response:?}");
    };
    assert!(
        matches!(moves[0].kind, MoveKind::Line { feed: 0.01, .. }),
        "{moves:?}"
    );
    assert_eq!(ask(&mut engine, "G1 X3 F0", &view()).unwrap_err().code, 22);
}

#[test]
fn reprap_reports() {
    let mut engine = engine();
    let mut said = |line: &str| {
        let response = ask(&mut engine, line, &view()).unwrap();
        response.text + &response.ok
    };
    assert_eq!(said("M105"), "ok T:0.0 /0.0 B:0.0 /0.0\n");
    assert!(said("M115").starts_with("FIRMWARE_NAME:Fivebar "));
    let place = "X:10.00 Y:-20.00 Z:0.00 E:0.00 Count X:10.00 Y:-20.00 Z:0\nok\n";
    assert_eq!(said(&numbered(1, "M114")), place);
    let wait = ask(&mut engine, &numbered(2, "M400"), &view()).unwrap();
    assert_eq!(wait.orders, [Order::Finish]);
}

#[test]
fn an_answer_is_one_line_whatever_the_sender_wrote() {
    let mut engine = engine();
    let line = Line {
        dialect: Dialect::Grbl,
        text: "G1 [X]".into(),
        length: 7,
    };
    let refusal = engine.line(&line, &view()).unwrap_err();
    let answer = engine.refuse(Dialect::Grbl, &refusal);
    assert_eq!(answer.matches(['[', ']', '\n']).count(), 4, "{answer}");
}

proptest! {
    #[test]
    fn any_bytes_are_answered_in_whole_lines(
        bytes in prop::collection::vec(any::<u8>(), 0..80),
        text in "[NnMmGgXYFSJ$=*0-9 .;()-]{0,40}",
    ) {
        let mut engine = engine();
        let mut splitter = Splitter::new(None);
        let text = [&bytes[..], b"\n", text.as_bytes(), b"\n"].concat();
        for byte in text {
            for input in splitter.feed(byte).collect::<Vec<_>>() {
                let Input::Line(line) = input else { continue };
                let answer = match engine.line(&line, &view()) {
                    Ok(response) => response.text + &response.ok,
                    Err(refusal) => engine.refuse(line.dialect, &refusal),
                };
                prop_assert!(answer.ends_with('\n'), "{answer}");
                let ends = answer.lines().filter(|line| line.starts_with("ok") || line.starts_with("error:"));
                prop_assert_eq!(ends.count(), 1, "{}", answer);
            }
        }
    }
}

#[test]
fn a_line_that_is_too_long_is_refused_as_a_whole() {
    let mut engine = engine();
    let long = format!("G1 X1{}0 F100", " ".repeat(2000));
    let refusal = ask(&mut engine, &long, &view()).unwrap_err();
    assert_eq!(refusal.code, 11);
    let commented = format!("G1 X41 F100 ;{}", "-".repeat(900));
    assert!(ask(&mut engine, &commented, &view()).is_ok());
}

#[test]
fn every_line_number_has_a_next_one() {
    let mut engine = engine();
    for number in [i64::MAX, i64::from(i32::MAX)] {
        let _ = ask(&mut engine, &numbered(number, "M110"), &view());
        let response = ask(&mut engine, &numbered(number, "G91"), &view()).unwrap();
        assert!(response.text.contains("Resend"), "{response:?}");
    }
}

#[test]
fn what_is_done_at_once_is_answered_without_a_note() {
    for line in ["M112", "M108", "M220 S50"] {
        let line = Line {
            dialect: Dialect::Grbl,
            text: line.into(),
            length: 9,
        };
        assert_eq!(engine().line(&line, &view()).unwrap().text, "");
    }
}

#[test]
fn m0_waits_behind_the_motion_of_its_line_and_a_tool_change_before_it() {
    let mut engine = engine();
    let orders = ask(&mut engine, "G91 G1 X1 F600 M3 M0", &view())
        .unwrap()
        .orders;
    assert!(
        matches!(orders.as_slice(), [Order::Moves(_), Order::Pause]),
        "{orders:?}"
    );
    // The tool lifts before the pause.
    let orders = ask(&mut engine, "M5 M0", &view()).unwrap().orders;
    assert!(
        matches!(orders.as_slice(), [Order::Moves(_), Order::Pause]),
        "{orders:?}"
    );
    let orders = ask(&mut engine, "G1 X1 M6 T2", &view()).unwrap().orders;
    assert!(
        matches!(orders.as_slice(), [Order::Pause, Order::Moves(_)]),
        "{orders:?}"
    );
}

#[test]
fn the_settings_have_the_reach() {
    let response = ask(&mut engine(), "$$", &view()).unwrap();
    // Legs of 260 mm, 80 mm apart: 260 + 180 wide, and √(260² − 40²) high.
    assert!(
        response.text.contains("$130=440.000\n"),
        "{}",
        response.text
    );
    assert!(
        response.text.contains("$131=256.905\n"),
        "{}",
        response.text
    );
}
