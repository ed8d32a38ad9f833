//! What the controller knows of the joints' place once the drives have had no power.

use fivebar_firmware::controller::{ArmController, Request, RequestError, Status};
use fivebar_firmware::drives::{
    DriveHealth, Drives, Resolution, StepDrives, StepSample, TorqueDrives, TorqueSample,
    UnpoweredPlace,
};
use fivebar_firmware::safety::{DriveKind, Fault, State};
use fivebar_firmware::settings::{BrakeSettings, HomingMethod};
use fivebar_firmware::{ArmCommand, ArmSample, Settings};

/// Where the arm stands [rad].
const START: [f32; 2] = [2.2, 0.9];
/// As many micro-steps in a turn as the encoder has counts.
const ENCODER: Resolution = Resolution {
    full_steps: 256,
    microsteps: 64,
};

/// An arm on steppers that follow each micro-step, whose home switches close where its settings have them.
struct Bench {
    controller: ArmController<StepDrives>,
    settings: Settings,
    made: [i32; 2],
    /// How far the motors without power have been turned by hand [counts].
    turned: [i32; 2],
    resolution: Resolution,
    emergency_stop: bool,
}

impl Bench {
    fn new(resolution: Resolution, change: impl FnOnce(&mut Settings)) -> Self {
        let mut settings = Settings::BENCHTOP;
        change(&mut settings);
        let checked = settings.check().expect("valid settings");
        let mut bench = Self {
            controller: ArmController::new(&checked),
            settings,
            made: [0; 2],
            turned: [0; 2],
            resolution,
            emergency_stop: false,
        };
        bench.tick();
        bench
    }

    fn tick(&mut self) -> ArmCommand<fivebar_firmware::drives::StepCommand> {
        self.controller.feed_host_timeout();
        self.tick_alone()
    }

    fn tick_alone(&mut self) -> ArmCommand<fivebar_firmware::drives::StepCommand> {
        let counts = [0, 1].map(|j| self.made[j] + self.turned[j]);
        let home = [0, 1].map(|j: usize| {
            let axis = &self.settings.axes[j];
            let per_count = core::f32::consts::TAU / (axis.encoder_counts as f32 * axis.gear_ratio);
            let angle = START[j] + per_count * counts[j] as f32;
            (angle > axis.home_angle) == axis.home_forward
        });
        let command = self.controller.tick(&ArmSample {
            counts,
            drives: StepSample {
                steps: self.made,
                resolution: [self.resolution; 2],
            },
            home,
            emergency_stop: self.emergency_stop,
            ..ArmSample::default()
        });
        for (made, steps) in self.made.iter_mut().zip(command.drives.steps) {
            *made += steps;
        }
        command
    }

    fn run_until(&mut self, state: State) -> Status {
        for _ in 0..200_000 {
            self.tick();
            if self.controller.state() == state {
                return self.controller.status();
            }
        }
        panic!("{:?}", self.controller.status());
    }

    fn request(&mut self, request: Request) {
        self.controller.request(request).expect("accepted");
    }

    /// Ended homing, with power or without.
    fn homed(resolution: Resolution, method: HomingMethod) -> Self {
        let mut bench = Self::new(resolution, |settings| {
            settings.home_reference.method = method;
            for (axis, angle) in settings.axes.iter_mut().zip(START) {
                if method != HomingMethod::Switch {
                    axis.home_angle = angle;
                }
            }
        });
        bench.request(Request::Home);
        while bench.controller.state() == State::Homing {
            bench.tick();
        }
        assert!(bench.controller.status().homed, "{method:?}");
        bench
    }
}

const OPEN_LOOP: Resolution = Resolution {
    full_steps: 0,
    microsteps: 0,
};

#[test]
fn an_open_loop_arm_is_held_where_it_is_homed_and_may_be_armed_again() {
    for method in [HomingMethod::Switch, HomingMethod::Given] {
        let mut bench = Bench::homed(OPEN_LOOP, method);
        assert_eq!(bench.controller.state(), State::Armed);
        let before = bench.made;
        for _ in 0..2000 {
            let command = bench.tick();
            assert_eq!((command.enable, command.brake), ([true; 2], false));
        }
        bench.request(Request::Arm);
        assert_eq!(bench.run_until(State::Armed).fault, None);
        for (made, before) in bench.made.into_iter().zip(before) {
            assert!((made - before).abs() < 200, "{made}, {before} before");
        }
    }
}

#[test]
fn an_open_loop_arm_is_not_homed_after_a_tick_without_power() {
    type End = fn(&mut Bench);
    let ends: [(&str, End); 4] = [
        ("disarmed", |bench| bench.request(Request::Disarm)),
        ("emergency stop", |bench| {
            bench.request(Request::EmergencyStop);
        }),
        ("emergency stop's pin", |bench| {
            bench.emergency_stop = true;
            bench.tick();
            bench.emergency_stop = false;
        }),
        ("a fault", |bench| {
            bench.controller.latch_fault(Fault::DriverFault);
        }),
    ];
    for (name, end) in ends {
        let mut bench = Bench::homed(OPEN_LOOP, HomingMethod::Given);
        end(&mut bench);
        assert_eq!(bench.tick().enable, [false; 2], "{name}");
        assert!(!bench.controller.status().homed, "{name}");
        let _ = bench.controller.request(Request::ClearFault);
        let refused = bench.controller.request(Request::Arm);
        assert_eq!(refused, Err(RequestError::NotHomed), "{name}");
        bench.request(Request::Home);
        assert!(bench.run_until(State::Armed).homed, "{name}");
    }
}

#[test]
fn an_open_loop_arm_that_its_host_has_left_for_a_minute_is_to_be_homed_again() {
    let mut bench = Bench::homed(OPEN_LOOP, HomingMethod::Given);
    let off = (0..610_000).any(|_| bench.tick_alone().enable == [false; 2]);
    assert!(off && !bench.controller.status().homed);
}

#[test]
fn angles_that_are_declared_of_an_open_loop_arm_take_power_with_them() {
    let mut bench = Bench::new(OPEN_LOOP, |_| ());
    bench.request(Request::SetAngles(START));
    assert_eq!(bench.tick().enable, [true; 2]);
    let status = bench.run_until(State::Armed);
    assert!(status.homed && status.angle == START, "{:?}", status.angle);
    // A second declaration would be of an arm that no hand can turn.
    let refused = bench.controller.request(Request::SetAngles([2.3, 0.9]));
    assert_eq!(refused, Err(RequestError::State(State::Armed)));
}

#[test]
fn steppers_with_encoders_and_servos_keep_their_place_without_power() {
    for (resolution, method) in [
        (ENCODER, HomingMethod::Given),
        (OPEN_LOOP, HomingMethod::Absolute),
    ] {
        let mut bench = Bench::homed(resolution, method);
        assert_eq!(bench.controller.state(), State::Stopped);
        bench.request(Request::Arm);
        bench.tick();
        bench.request(Request::EmergencyStop);
        for _ in 0..1000 {
            assert_eq!(bench.tick().enable, [false; 2]);
            assert!(bench.controller.status().homed, "{method:?}");
        }
        bench.request(Request::ClearFault);
        bench.request(Request::Arm);
    }
}

/// The brakes hold, or the arm falls by ten counts in a tick without power.
fn disarmed_on_brakes(resolution: Resolution, falls: bool) -> (Bench, u32, u32) {
    let mut bench = Bench::new(resolution, |settings| {
        settings.brake = BrakeSettings {
            engage_time: 0.04,
            release_time: 0.05,
        };
        for (axis, angle) in settings.axes.iter_mut().zip(START) {
            axis.home_angle = angle;
        }
        settings.home_reference.method = HomingMethod::Given;
    });
    bench.request(Request::Home);
    while bench.controller.state() == State::Homing {
        bench.tick();
    }
    bench.request(Request::Arm);
    for _ in 0..10_000 {
        bench.tick();
    }
    bench.request(Request::Disarm);
    let (mut powered, mut unpowered) = (0, 0);
    for _ in 0..3000 {
        let command = bench.tick();
        let is_off = command.enable == [false; 2];
        if bench.controller.state() != State::Armed {
            break;
        }
        assert!(!is_off || command.brake);
        powered += u32::from(command.brake && !is_off);
        unpowered += u32::from(is_off);
        if is_off && falls {
            bench.turned[1] += 10;
        }
    }
    (bench, powered, unpowered)
}

#[test]
fn brakes_of_steppers_with_encoders_are_tested_without_power() {
    let (bench, powered, unpowered) = disarmed_on_brakes(ENCODER, false);
    assert_eq!(bench.controller.state(), State::Stopped);
    // 40 ms until they are engaged, 30 ms until the test; 50 ms of it.
    assert!((600..900).contains(&powered), "{powered}");
    assert!((450..650).contains(&unpowered), "{unpowered}");
    assert!(bench.controller.status().homed);
}

#[test]
fn brakes_of_steppers_that_do_not_hold_are_found_and_the_motors_hold_the_arm() {
    let (mut bench, _, unpowered) = disarmed_on_brakes(ENCODER, true);
    assert_eq!(bench.controller.status().fault, Some(Fault::BrakeFailed));
    let seen = DriveKind::StepperWithEncoder.sees(Fault::BrakeFailed);
    assert_eq!(seen, Ok(()));
    // 0.01 rad are so many counts.
    let axis = &bench.settings.axes[1];
    let play = 0.01 * axis.encoder_counts as f32 * axis.gear_ratio.abs() / core::f32::consts::TAU;
    let ticks = (play / 10.0) as u32;
    assert!(
        (ticks..ticks + 20).contains(&unpowered),
        "{unpowered} of {ticks}"
    );
    let before = bench.made;
    for _ in 0..5000 {
        let command = bench.tick();
        assert_eq!((command.enable, command.brake), ([true; 2], true));
    }
    assert_eq!(bench.controller.status().fault, Some(Fault::BrakeFailed));
    for (made, before) in bench.made.into_iter().zip(before) {
        assert!((made - before).abs() < 64, "{made}, {before} before");
    }
    bench.request(Request::EmergencyStop);
    assert_eq!(bench.tick().enable, [false; 2]);
}

#[test]
fn brakes_that_nothing_shows_to_hold_are_not_tested() {
    let (bench, _, unpowered) = disarmed_on_brakes(OPEN_LOOP, true);
    let Status {
        state,
        fault,
        homed,
        ..
    } = bench.controller.status();
    assert_eq!((state, fault, homed), (State::Stopped, None, false));
    assert_eq!(unpowered, 0);
}

/// Drives on a bus that answer, at these counts, this old.
fn answers(counts: [i32; 2], age: u16) -> ArmSample<TorqueSample> {
    ArmSample {
        counts,
        drives: TorqueSample {
            age: [0, age],
            health: [DriveHealth::Drives; 2],
            ..TorqueSample::default()
        },
        ..ArmSample::default()
    }
}

#[test]
fn a_drive_on_a_bus_that_was_silent_is_homed_again_unless_it_knows_its_angle() {
    let silent = |tick: u16| answers([0; 2], tick);
    is_homed_again_unless_it_knows_its_angle(silent);
    // The controller has left the bus, and hears no silence.
    is_homed_again_unless_it_knows_its_angle(|_| {
        let mut sample = answers([0; 2], 0);
        sample.drives.bus_off = true;
        sample
    });
}

#[track_caller]
fn is_homed_again_unless_it_knows_its_angle(lost: impl Fn(u16) -> ArmSample<TorqueSample>) {
    for (method, keeps) in [(HomingMethod::Given, false), (HomingMethod::Absolute, true)] {
        let mut settings = Settings::BENCHTOP;
        settings.home_reference.method = method;
        let settings = settings.check().expect("valid settings");
        for powered in [false, true] {
            let mut controller = ArmController::<TorqueDrives>::new(&settings);
            controller.tick(&answers([0; 2], 0));
            controller
                .request(Request::SetAngles(START))
                .expect("accepted");
            if powered {
                controller.request(Request::Arm).expect("accepted");
            }
            for _ in 0..600 {
                controller.feed_host_timeout();
                controller.tick(&answers([0; 2], 0));
            }
            assert!(controller.status().homed);
            // It restarts within a second, 0.05 rad from its zero, which a joint can turn meanwhile.
            for tick in 0..10_000 {
                controller.tick(&lost(tick));
            }
            for counts in 0..200 {
                controller.tick(&answers([0, counts], 0));
            }
            let _ = controller.request(Request::ClearFault);
            let expected = match keeps {
                true => Ok(()),
                false => Err(RequestError::NotHomed),
            };
            let armed = controller.request(Request::Arm);
            assert_eq!(armed, expected, "{method:?}, powered: {powered}");
        }
    }
}

#[test]
fn one_encoder_does_not_keep_the_place_of_both_joints() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let mut drives = StepDrives::new(&settings);
    for (resolution, place) in [
        ([ENCODER, ENCODER], UnpoweredPlace::Kept),
        ([ENCODER, OPEN_LOOP], UnpoweredPlace::Lost),
        ([OPEN_LOOP, ENCODER], UnpoweredPlace::Lost),
    ] {
        let steps = [0; 2];
        drives.sense(&StepSample { steps, resolution });
        assert_eq!(drives.unpowered_place(), place);
    }
}

/// The contract needs no power to state it.
#[test]
fn only_open_loop_drives_take_power_for_declared_angles() {
    fn powers<D: Drives>() -> bool {
        let settings = Settings::BENCHTOP.check().expect("valid settings");
        ArmController::<D>::new(&settings).powers(Request::SetAngles(START))
    }
    assert!(powers::<StepDrives>());
    assert!(!powers::<TorqueDrives>());
    assert!(!powers::<fivebar_firmware::drives::BrushedDrives>());
}
