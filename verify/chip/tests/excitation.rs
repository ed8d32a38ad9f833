//! Excitations of motors that are not homed, and the log at the tick rate, on the image that is
//! flashed: through its converters, counters and compare registers.

mod bench;

use bench::Driven;
use bench::raised::{TICK, at_the_end};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::Request;
use fivebar_firmware::controller::{Excitation, ExcitationEnd, Excited};
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::recorder::{LogConfig, LogState, Signals};
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::Joint;

/// 1 V on a motor, for a tenth of a second.
const GENTLE: Excitation = Excitation {
    joint: 0,
    of: Excited::Voltage,
    offset: 1.0,
    amplitude: 0.0,
    hold: 1,
    ticks: 1000,
    current: 1.0,
    travel: 1.0,
};

fn ready() -> Driven {
    at_the_end(Options::default()).ready_with(|_| ())
}

/// Runs an excitation to its end; what ended it, and how far both joints turned [rad].
#[track_caller]
fn excited(driven: &mut Driven, excitation: Excitation) -> (ExcitationEnd, [f64; 2]) {
    let before = Joint::ALL.map(|joint| driven.arm.get().plant().angle(joint));
    driven
        .request(Request::Excite(excitation))
        .expect("an excitation");
    assert_eq!(driven.status().state, State::Exciting);
    for _ in 0..200 {
        driven.run(10 * MILLISECOND);
        if driven.status().state == State::Stopped {
            assert!(driven.is_off());
            let Reply::ExcitationEnd(Some(end)) = driven
                .client
                .call(HostCommand::ExcitationEnd)
                .expect("an answer")
            else {
                panic!("no end");
            };
            let turned =
                Joint::ALL.map(|joint| driven.arm.get().plant().angle(joint) - before[joint]);
            return (end, turned);
        }
    }
    panic!("the excitation does not end");
}

#[test]
fn each_motor_turns_its_joint_in_the_sense_of_its_voltage_and_current() {
    let mut driven = ready();
    for (joint, of, offset) in [
        (0, Excited::Voltage, 1.0),
        (1, Excited::Voltage, -1.0),
        (0, Excited::Current, -0.3),
        (1, Excited::Current, 0.3),
    ] {
        let wanted = Excitation {
            joint,
            of,
            offset,
            ticks: 300,
            ..GENTLE
        };
        let (_, turned) = excited(&mut driven, wanted);
        let turned = turned[usize::from(joint)] * f64::from(offset);
        assert!(turned > 1e-4, "joint {joint}, {of:?}: {turned}");
    }
}

#[test]
fn travel_current_and_time_end_an_excitation() {
    let mut driven = ready();
    let far = Excitation {
        offset: 2.0,
        ticks: 10_000,
        travel: 0.1,
        ..GENTLE
    };
    assert_eq!(excited(&mut driven, far).0, ExcitationEnd::Travel);
    let weak = Excitation {
        offset: -2.2,
        current: 0.5,
        ..GENTLE
    };
    assert_eq!(excited(&mut driven, weak).0, ExcitationEnd::Current);
    let short = Excitation {
        amplitude: 0.5,
        hold: 4,
        offset: 0.0,
        ticks: 100,
        ..GENTLE
    };
    assert_eq!(excited(&mut driven, short).0, ExcitationEnd::Time);
}

#[test]
fn an_emergency_stop_ends_an_excitation_at_once() {
    let mut driven = ready();
    driven
        .request(Request::Excite(GENTLE))
        .expect("an excitation");
    driven.run(5 * MILLISECOND);
    assert!(!driven.is_off());
    driven.request(Request::EmergencyStop).expect("a stop");
    driven.run(2 * TICK);
    assert!(driven.is_off());
    assert_eq!(driven.status().fault, Some(Fault::EmergencyStop));
}

#[test]
fn a_log_shows_the_duty_and_the_current_of_an_excitation() {
    let mut driven = ready();
    let nothing = LogConfig {
        signals: 0,
        every: 1,
        powered: false,
    };
    let refused = driven
        .client
        .call(HostCommand::BeginLog(nothing))
        .expect("an answer");
    assert_eq!(refused, Reply::Refused(CommandError::Log));
    let log = LogConfig {
        signals: (Signals::SENSED_1 | Signals::TOLD_1).bits(),
        every: 2,
        powered: true,
    };
    assert_eq!(
        driven
            .client
            .call(HostCommand::BeginLog(log))
            .expect("an answer"),
        Reply::Done
    );
    let wanted = Excitation {
        ticks: 400,
        ..GENTLE
    };
    excited(&mut driven, wanted);
    let Reply::Log(page) = driven
        .client
        .call(HostCommand::ReadLog { from: 320 })
        .expect("an answer")
    else {
        panic!("no page");
    };
    assert_eq!(page.state, LogState::Recording);
    let words: Vec<u16> = page.page.iter().flatten().copied().collect();
    for row in words.chunks(2) {
        // 1 V of 24 V; 4096 codes are 33 A, and 1 V drives up to 0.8 A through the winding.
        let duty = f64::from(row[1] as i16) / 32767.0;
        assert!((duty * 24.0 - 1.0).abs() < 0.05, "{duty}");
        assert!(row[0] > 2048, "{} codes", row[0]);
    }
}
