//! Jobs on an arm whose drives are on a CAN bus.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_sim::simulation::{Record, Simulate, Summary};

fn leg(change: impl Fn(&str) -> String) -> Robot {
    let text = BuiltIn::find("leg").expect("built in").text;
    Robot::parse("leg.toml", &change(text)).unwrap_or_else(|error| panic!("{error}"))
}

fn run(scenario: &Scenario) -> (Summary, Record) {
    let job = scenario.job().unwrap();
    scenario.simulate(&job, &mut |_| ()).unwrap()
}

fn demonstration() -> Scenario {
    let mut scenario = Scenario::demonstration(leg(str::to_owned));
    scenario.fit().unwrap();
    scenario
}

#[test]
fn the_demonstration_is_drawn_within_25_micrometres() {
    let (summary, record) = run(&demonstration());
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    let error = summary.tip_error;
    assert!(error.rms_m < 25e-6, "{error:?}");
}
