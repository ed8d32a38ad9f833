//! Which faults are seen with which drives: the simulation agrees with the table of the code.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::safety::{DriveKind, Fault};
use fivebar_plant::{FaultKind, PlantFault};
use fivebar_sim::simulation::Simulate;

/// A line that takes longer than the protection needs, on a built-in robot.
fn line(robot: &str) -> Scenario {
    let text = "G21 G90 F600\nG0 X0 Y0\nM3\nG1 X10\nG4 P1\n";
    let robot = Robot::load(robot).expect("a robot");
    let mut scenario = Scenario::new("line", robot, "line.gcode", text.into());
    scenario.fit().expect("it fits");
    scenario
}

/// The faults of a line on an arm whose bus voltage becomes this.
fn faults_at(line: &Scenario, volts: f64) -> Vec<Fault> {
    let mut scenario = line.clone();
    let kind = FaultKind::BusVoltage { volts };
    scenario.faults.push(PlantFault { at: 0.3, kind });
    let job = scenario.job().expect("a job");
    let (_, record) = scenario.simulate(&job, &mut |_| ()).expect("it ends");
    record.faults.into_iter().map(|(_, fault)| fault).collect()
}

#[test]
fn a_bus_voltage_that_is_too_low_or_too_high_is_seen_with_those_drives_of_which_the_table_says_it()
{
    use DriveKind::{Brushed, CanTorque, HobbyServo, Stepper};
    let arms = [
        (Brushed, line("benchtop")),
        (Stepper, line("benchtop_stepper")),
        (CanTorque, line("leg")),
        (HobbyServo, line("classroom_servo")),
    ];
    for (volts, fault) in [
        (0.0, Fault::UnderVoltage),
        (4.0, Fault::UnderVoltage),
        (60.0, Fault::OverVoltage),
    ] {
        for (kind, line) in &arms {
            let faults = faults_at(line, volts);
            let seen = faults.contains(&fault);
            assert_eq!(
                seen,
                kind.sees(fault).is_ok(),
                "{kind:?} at {volts} V: {faults:?}"
            );
        }
    }
}
