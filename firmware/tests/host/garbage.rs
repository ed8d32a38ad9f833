//! For any samples, requests and moves: the controller does not panic, duties are within ±1 and
//! zero where the bridge is off, and bridges are on only in the states that allow it.

use crate::moves::move_kind;
use crate::rig::{Bench, START, settings};
use fivebar_firmware::controller::{Excitation, Excited, Request};
use fivebar_firmware::drives::BrushedSample;
use fivebar_firmware::safety::{Response, State};
use fivebar_firmware::{ActuatorCommand, Controller, Move, MoveKind, Planner, SensorSample};
use fivebar_testkit::Tally;
use proptest::prelude::*;
use std::cell::Cell;

#[derive(Clone, Copy, Debug)]
enum Step {
    /// The samples of a real arm.
    Sound,
    /// These samples instead.
    Garbage(SensorSample),
    Ask(Request),
    Move(MoveKind),
    Missed(u32),
}

fn number() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![
        any::<f32>(),
        -0.3..0.3_f32,
        0.0..4.0_f32,
        Just(f32::NAN),
        Just(f32::INFINITY),
    ]
}

fn pair() -> impl Strategy<Value = [f32; 2]> {
    prop::array::uniform2(number())
}

fn sensor_sample() -> impl Strategy<Value = SensorSample> {
    (
        any::<[i32; 2]>(),
        any::<[u16; 2]>(),
        any::<u16>(),
        any::<[bool; 2]>(),
        prop::bool::weighted(0.1),
    )
        .prop_map(
            |(counts, current, bus_voltage, home, emergency_stop)| SensorSample {
                counts,
                drives: BrushedSample {
                    current,
                    bus_voltage,
                },
                home,
                emergency_stop,
                ..SensorSample::default()
            },
        )
}

fn request() -> impl Strategy<Value = Request> {
    // Requests that lead to motion are more frequent than those that end it.
    prop_oneof![
        5 => Just(Request::Arm),
        1 => Just(Request::Disarm),
        1 => Just(Request::Home),
        5 => Just(Request::SetAngles(START)),
        1 => pair().prop_map(Request::SetAngles),
        3 => Just(Request::Stop),
        1 => Just(Request::EmergencyStop),
        5 => Just(Request::ClearFault),
        3 => excitation().prop_map(Request::Excite),
    ]
}

/// Excitations within their bounds.
fn excitation() -> impl Strategy<Value = Excitation> {
    let of = prop::sample::select(vec![Excited::Voltage, Excited::Current]);
    (0..2_u8, of, -0.5..0.5_f32, 1..900_u32).prop_map(|(joint, of, offset, ticks)| Excitation {
        joint,
        of,
        offset,
        amplitude: 0.1,
        hold: 3,
        ticks,
        current: 0.7,
        travel: 0.3,
    })
}

/// Moves with any numbers, and some that the arm can make from its start.
fn motion() -> impl Strategy<Value = MoveKind> {
    prop_oneof![
        move_kind(number()),
        (-0.01..0.01_f32, -0.01..0.01_f32, 0.01..0.2_f32).prop_map(|(x, y, feed)| {
            let [start_x, start_y] = tool_at_start();
            let to = [start_x + x, start_y + y];
            MoveKind::Line { to, feed }
        }),
        (0.0..0.01_f32).prop_map(|duration| MoveKind::Dwell { duration }),
    ]
}

/// The tool where the bench arm starts [m].
fn tool_at_start() -> [f32; 2] {
    Bench::new(&settings()).tool().map(|it| it as f32)
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        10 => Just(Step::Sound),
        1 => sensor_sample().prop_map(Step::Garbage),
        8 => request().prop_map(Step::Ask),
        6 => motion().prop_map(Step::Move),
        1 => (0..8_u32).prop_map(Step::Missed),
    ]
}

/// One tick, checked against the rules that hold for every tick.
fn tick(controller: &mut Controller, sample: &SensorSample) -> ActuatorCommand {
    let command = controller.tick(sample);
    let powered = match controller.state() {
        State::Stopped => false,
        State::Homing
        | State::Exciting
        | State::Crossing
        | State::Compliant
        | State::Armed
        | State::Running
        | State::Stopping => true,
        State::Fault => controller.fault().unwrap().fault.response() == Response::ControlledStop,
    };
    for (duty, enable) in command.drives.duty.into_iter().zip(command.enable) {
        assert!(duty.abs() <= 1.0, "{duty} while {:?}", controller.state());
        assert!(enable || duty == 0.0);
        assert!(powered || !enable, "power while {:?}", controller.state());
        // The brake holds while the bridges do not drive: they are off or wake up.
        assert!(enable || command.brake);
        assert!(duty == 0.0 || !command.brake);
    }
    let status = controller.status();
    assert_eq!(status.fault.is_some(), status.state == State::Fault);
    command
}

/// What has occurred in all cases together.
#[derive(Default)]
struct Seen {
    requests: Tally,
    moves: Tally,
    /// Ticks that ended in each state, in the order of [`State::ALL`].
    ticks: [Cell<u32>; State::ALL.len()],
}

impl Seen {
    fn tick(&self, controller: &mut Controller, sample: &SensorSample) -> ActuatorCommand {
        let command = tick(controller, sample);
        for (count, state) in self.ticks.iter().zip(State::ALL) {
            count.set(count.get() + u32::from(state == controller.state()));
        }
        command
    }
}

#[test]
fn any_samples_requests_and_moves_keep_the_rules_of_the_tick() {
    let seen = Seen::default();
    let steps = prop::collection::vec(step(), 1..120);
    proptest!(ProptestConfig::with_cases(300), |(armed in any::<bool>(), steps in steps)| {
        let mut controller = Controller::new(&settings().check().unwrap());
        let mut planner = Planner::new(&settings().check().unwrap());
        let mut bench = Bench::new(&settings());
        seen.tick(&mut controller, &bench.sense());
        if armed {
            controller.request(Request::SetAngles(START)).unwrap();
            controller.request(Request::Arm).unwrap();
        }
        for step in steps {
            match step {
                Step::Sound => {
                    for _ in 0..20 {
                        planner.run(&mut controller);
                        let command = seen.tick(&mut controller, &bench.sense());
                        bench.step(&command);
                    }
                }
                Step::Garbage(sample) => {
                    seen.tick(&mut controller, &sample);
                }
                Step::Ask(request) => {
                    seen.requests.count(controller.request(request).is_ok());
                }
                Step::Move(kind) => {
                    let pushed = planner.push(&mut controller, &Move { tag: 0, tool: 0, kind });
                    seen.moves.count(pushed.is_ok());
                }
                Step::Missed(missed_ticks) => {
                    let sample = SensorSample {
                        missed_ticks,
                        ..bench.sense()
                    };
                    seen.tick(&mut controller, &sample);
                }
            }
        }
    });
    seen.requests.assert_accepted(0.3);
    seen.moves.assert_accepted(0.07);
    for (count, state) in seen.ticks.iter().zip(State::ALL) {
        // The settings of the bench allow no crossing, and no stream lets a hand lead the arm.
        let left_out = matches!(state, State::Crossing | State::Compliant);
        assert!(
            count.get() > 100 || left_out,
            "{} ticks {state:?}",
            count.get()
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn samples_alone_never_power_a_bridge(samples in prop::collection::vec(sensor_sample(), 1..200)) {
        let mut controller = Controller::new(&settings().check().unwrap());
        for sample in samples {
            let command = tick(&mut controller, &sample);
            prop_assert_eq!(command.enable, [false; 2]);
        }
    }
}
