//! The controller on steppers with encoders.

use fivebar_firmware::controller::{ArmController, Request};
use fivebar_firmware::drives::{Resolution, StepDrives, StepSample};
use fivebar_firmware::motion::{StreamConfig, StreamMode, StreamPoint, StreamPolicy};
use fivebar_firmware::planner::StreamReason;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{ArmCommand, ArmSample, Planner, Settings};

/// As many micro-steps in a turn as the encoder has counts.
const RESOLUTION: Resolution = Resolution {
    full_steps: 256,
    microsteps: 64,
};

/// Motors that have made these micro-steps, with joint 4 so many counts behind them.
fn sample(steps: [i32; 2], behind: i32) -> ArmSample<StepSample> {
    ArmSample {
        counts: [steps[0], steps[1] - behind],
        drives: StepSample {
            steps,
            resolution: [RESOLUTION; 2],
        },
        ..ArmSample::default()
    }
}

#[test]
fn steps_that_are_lost_switch_both_motors_off_in_their_tick() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    assert_eq!(settings.axes[1].encoder_counts, 256 * 64);
    let mut controller = ArmController::<StepDrives>::new(&settings);
    controller.tick(&sample([0; 2], 0));
    controller.request(Request::Home).expect("accepted");
    let mut made = [0_i32; 2];
    let mut tick = |controller: &mut ArmController<StepDrives>, behind: i32| {
        controller.feed_host_timeout();
        let command: ArmCommand<_> = controller.tick(&sample(made, behind));
        for (made, steps) in made.iter_mut().zip(command.drives.steps) {
            *made += steps;
        }
        command
    };
    for _ in 0..4000 {
        tick(&mut controller, 0);
    }
    assert_eq!(
        (controller.state(), controller.status().fault),
        (State::Homing, None)
    );
    // A step and a half is none too many.
    for behind in 0..=96 {
        assert_eq!(tick(&mut controller, behind).enable, [true; 2], "{behind}");
    }
    let command = tick(&mut controller, 97);
    assert_eq!(controller.status().fault, Some(Fault::StepsLost));
    assert_eq!((command.enable, command.drives.steps), ([false; 2], [0; 2]));
    assert!(command.brake);
    assert!(made[0] != 0 && made[1] != 0, "both searched");
}

#[test]
fn steppers_give_no_force_of_a_point() {
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let mut controller = ArmController::<StepDrives>::new(&settings);
    let mut made = [0_i32; 2];
    let mut run = |controller: &mut ArmController<StepDrives>, ticks| {
        for _ in 0..ticks {
            controller.feed_host_timeout();
            let command: ArmCommand<_> = controller.tick(&sample(made, 0));
            for (made, steps) in made.iter_mut().zip(command.drives.steps) {
                *made += steps;
            }
        }
    };
    run(&mut controller, 1);
    let angles = [2.6, 0.55];
    for request in [Request::SetAngles(angles), Request::Arm] {
        controller.request(request).expect("accepted");
        run(&mut controller, 20_000);
    }
    assert_eq!(controller.state(), State::Armed);
    let mut planner = Planner::new(&settings);
    let config = StreamConfig {
        id: 4,
        mode: StreamMode::Joint,
        period: 100,
        delay: 200,
        policy: StreamPolicy::Stop,
    };
    assert_eq!(planner.begin_stream(&mut controller, &config), Ok(()));
    for (n, torque, last) in [(1, 0.1, None), (2, 0.0, Some(2))] {
        let [theta1, theta4] = controller.status().angle;
        let point = StreamPoint {
            id: 4,
            due: controller.ticks() + 200,
            position: (theta1, theta4),
            velocity: (0.0, 0.0),
            force: (0.0, torque),
        };
        planner.take_point(&mut controller, n, &point);
        let progress = planner.stream().expect("a stream");
        assert_eq!(progress.last, last);
        assert_eq!(progress.reason, Some(StreamReason::Force));
    }
}
