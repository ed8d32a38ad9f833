//! Travel after the last stroke decides no place.

use fivebar_files::job::{Job, WarningKind};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{Kept, Scenario};
use fivebar_firmware::Planner;

/// A corner with a parking move at this height, which is out of reach.
fn parked(y: u32) -> Scenario {
    let text = format!("G21 G90\nG0 X10 Y10\nG1 X40 F1200\nG1 Y30\nG0 X0 Y{y}\nM2\n");
    let robot = Robot::load("benchtop_pen").unwrap();
    Scenario::new("parked", robot, "parked.gcode", text)
}

fn is_drawn(scenario: &Scenario, job: &Job) -> bool {
    let settings = scenario.robot.settings().unwrap().check().unwrap();
    scenario.verify(&mut Planner::new(&settings), job).is_ok()
}

#[test]
fn parking_out_of_reach_is_left_out_and_noted() {
    for (fit, y) in [(false, 900), (true, 200)] {
        let mut scenario = parked(y);
        if fit {
            let free = Kept {
                scale: false,
                turn: true,
            };
            scenario.fit_to_reach(free).unwrap();
            assert!(scenario.scale > 1.5, "{}", scenario.scale);
        }
        let job = scenario.job().unwrap();
        assert!(is_drawn(&scenario, &job));
        let drawn = job.steps.iter().filter(|step| step.draws()).count();
        assert_eq!(drawn, 2);
        let parking = job
            .warnings
            .iter()
            .find(|note| note.kind == WarningKind::Parking);
        assert_eq!(parking.map(|note| note.line), Some(5), "{:?}", job.warnings);
    }
}

#[test]
fn parking_within_reach_stays() {
    let scenario = parked(31);
    let job = scenario.job().unwrap();
    assert!(is_drawn(&scenario, &job) && !job.steps.last().unwrap().draws());
    assert!(
        !job.warnings
            .iter()
            .any(|note| note.kind == WarningKind::Parking)
    );
}
