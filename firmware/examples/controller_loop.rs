//! A controller loop with fake hardware: what a new board has to provide.
//!
//! [`Board`] is the interface to the hardware. The loop above it needs neither `std` nor an
//! allocator, and is the same on a microcontroller. The fake board simulates each joint as a
//! motor with a constant inertia.
//!
//! `cargo run --example controller_loop`

use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{
    ActuatorCommand, Controller, Move, MoveKind, Planner, SensorSample, Settings,
};
use std::error::Error;
use std::f32::consts::TAU;

/// The interface to the hardware.
trait Board {
    /// Samples the sensors, in the timer's interrupt.
    fn sample(&mut self) -> SensorSample;
    /// Sets the bridges until the next tick.
    fn apply(&mut self, command: &ActuatorCommand);
}

/// One period: the timer's interrupt, then the tasks below it.
fn period(controller: &mut Controller, planner: &mut Planner, board: &mut impl Board) {
    let sample = board.sample();
    let command = controller.tick(&sample);
    board.apply(&command);
    // A session would do this for each frame of the host.
    controller.feed_host_timeout();
    planner.run(controller);
}

/// A joint with its motor: angle [rad], velocity [rad/s], current [A].
#[derive(Clone, Copy)]
struct Joint {
    angle: f32,
    velocity: f32,
    current: f32,
}

struct FakeBoard {
    settings: CheckedSettings,
    joints: [Joint; 2],
}

const BUS_VOLTAGE: f32 = 24.0;

impl Board for FakeBoard {
    fn sample(&mut self) -> SensorSample {
        let mut sample = SensorSample {
            bus_voltage: (BUS_VOLTAGE / self.settings.protection.bus_voltage_per_code) as u16,
            ..SensorSample::default()
        };
        for (index, (joint, axis)) in self.joints.iter().zip(&self.settings.axes).enumerate() {
            let turns = joint.angle / TAU * axis.gear_ratio;
            sample.counts[index] = (turns * axis.encoder_counts as f32).round() as i32;
            let code = joint.current / axis.current_per_code + f32::from(axis.current_zero_code);
            sample.current[index] = code.round() as u16;
        }
        sample
    }

    fn apply(&mut self, command: &ActuatorCommand) {
        let period = 1.0 / self.settings.control.tick_rate;
        let inertia = self.settings.nominal_inertia();
        for (index, (joint, axis)) in self.joints.iter_mut().zip(&self.settings.axes).enumerate() {
            let constant = axis.torque_constant * axis.gear_ratio;
            let voltage = command.duty[index] * BUS_VOLTAGE - constant * joint.velocity;
            let decay = (-axis.resistance * period / axis.inductance).exp();
            joint.current = match command.enable[index] {
                true => decay * joint.current + (1.0 - decay) * voltage / axis.resistance,
                false => 0.0,
            };
            joint.velocity += period * constant * joint.current / inertia[index];
            joint.angle += period * joint.velocity;
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let settings = Settings::BENCHTOP.check()?;
    let start = [2.2, 0.9]; // rad
    let joints = start.map(|angle| Joint {
        angle,
        velocity: 0.0,
        current: 0.0,
    });
    let mut board = FakeBoard { settings, joints };
    let mut controller = Controller::new(&settings);
    let mut planner = Planner::new(&settings);
    period(&mut controller, &mut planner, &mut board);

    // The joints' angles are known, so that no homing is needed.
    controller.request(Request::SetAngles(start))?;
    controller.request(Request::Arm)?;
    let to = [0.06, 0.19]; // m
    let kind = MoveKind::Line { to, feed: 0.1 }; // m/s
    planner.push(&mut controller, &Move { tag: 1, kind })?;

    let mut ticks = 0;
    while !planner.is_empty() || controller.state() != State::Armed {
        period(&mut controller, &mut planner, &mut board);
        assert!(
            controller.fault().is_none(),
            "{:?}",
            controller.fault().map(|at| at.fault)
        );
        ticks += 1;
        assert!(ticks < 20_000, "the move takes less than 2 s");
    }
    let [x, y] = controller
        .status()
        .tool
        .ok_or("the tool's position is unknown")?;
    let seconds = ticks as f32 / settings.control.tick_rate;
    println!(
        "after {seconds:.2} s the tool is at ({:.3}, {:.3}) mm",
        1e3 * x,
        1e3 * y
    );
    assert!((x - to[0]).hypot(y - to[1]) < 0.2e-3);
    Ok(())
}

#[test]
fn the_loop_moves_the_tool_to_its_target() -> Result<(), Box<dyn Error>> {
    main()
}
