//! A controller loop with fake hardware: what a new board has to provide.
//!
//! [`Board`] is the interface to the hardware; the loop above it needs neither `std` nor an
//! allocator. The fake board simulates a motor with a constant inertia at each joint.
//!
//! `cargo run --example controller_loop`

use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{ActuatorCommand, Controller, SensorSample, Settings};
use fivebar_firmware::{Move, MoveKind, Planner};
use std::error::Error;
use std::f32::consts::TAU;

const BUS_VOLTAGE: f32 = 24.0; // V

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

/// Two motors without inductance, each with a constant inertia.
struct FakeBoard {
    settings: CheckedSettings,
    /// Angle [rad], velocity [rad/s] and current [A] of each joint.
    joints: [[f32; 3]; 2],
}

impl Board for FakeBoard {
    fn sample(&mut self) -> SensorSample {
        let mut sample = SensorSample::default();
        for (i, axis) in self.settings.axes.iter().enumerate() {
            let [angle, _, current] = self.joints[i];
            let turns = angle / TAU * axis.gear_ratio;
            sample.counts[i] = (turns * axis.encoder_counts as f32).round() as i32;
            let code = current / axis.current_per_code + f32::from(axis.current_zero_code);
            sample.drives.current[i] = code.round() as u16;
        }
        sample.drives.bus_voltage =
            (BUS_VOLTAGE / self.settings.protection.bus_voltage_per_code) as u16;
        sample
    }

    fn apply(&mut self, command: &ActuatorCommand) {
        let rate = self.settings.control.tick_rate;
        let inertia = self.settings.nominal_inertia();
        for (i, axis) in self.settings.axes.iter().enumerate() {
            let [angle, velocity, current] = &mut self.joints[i];
            let constant = axis.torque_constant * axis.gear_ratio;
            let voltage = command.drives.duty[i] * BUS_VOLTAGE - constant * *velocity;
            *current = f32::from(command.enable[i]) * voltage / axis.resistance;
            *velocity += constant * *current / inertia[i] / rate;
            *angle += *velocity / rate;
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let settings = Settings::BENCHTOP.check()?;
    let start = [2.2, 0.9]; // rad
    let joints = start.map(|angle| [angle, 0.0, 0.0]);
    let mut board = FakeBoard { settings, joints };
    let (mut controller, mut planner) = (Controller::new(&settings), Planner::new(&settings));
    period(&mut controller, &mut planner, &mut board);

    // The joints' angles are known, so that no homing is needed.
    controller.request(Request::SetAngles(start))?;
    controller.request(Request::Arm)?;
    let to = [0.06, 0.19]; // m
    let kind = MoveKind::Line { to, feed: 0.1 }; // m/s
    planner.push(
        &mut controller,
        &Move {
            tag: 1,
            tool: 0,
            kind,
        },
    )?;
    let mut ticks = 0;
    while !planner.is_empty() || controller.state() != State::Armed {
        period(&mut controller, &mut planner, &mut board);
        ticks += 1;
        assert!(ticks < 20_000, "no end: {:?}", controller.status().fault);
    }
    let [x, y] = controller.status().tool.ok_or("no position")?;
    println!("after {ticks} ticks of 0.1 ms the tool is at ({x:.6}, {y:.6}) m");
    assert!((x - to[0]).hypot(y - to[1]) < 0.2e-3);
    Ok(())
}

#[test]
fn the_loop_moves_the_tool_to_its_target() -> Result<(), Box<dyn Error>> {
    main()
}
