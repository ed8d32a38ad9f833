//! Time of time-optimal planning: a path of the page, and the whole demonstration. To be compared with
//! the motion, 0.29 s and 2.7 s.

use criterion::{Criterion, criterion_group, criterion_main};
use fivebar::input::path_case::PathCase;
use fivebar::input::robot::Robot;
use fivebar::input::scenario::Scenario;
use fivebar::study::plan::PlanStudy;
use std::path::Path;

fn planning(c: &mut Criterion) {
    let robot = Robot::load("benchtop").unwrap();
    let mut group = c.benchmark_group("planning");
    group.sample_size(10);
    let paths = concat!(env!("CARGO_MANIFEST_DIR"), "/../sim-harness/paths");
    for name in ["square", "eight"] {
        let case = PathCase::read(&Path::new(paths).join(format!("{name}.json"))).unwrap();
        group.bench_function(name, |b| {
            b.iter(|| PlanStudy::new(&robot, &case, 1.0, None).unwrap());
        });
    }
    let mut scenario = Scenario::demonstration(robot.clone());
    scenario.time_optimal = Some(0.7);
    let job = scenario.job().unwrap();
    group.bench_function("demonstration", |b| {
        b.iter(|| scenario.run_moves(&job).unwrap());
    });
    group.finish();
}

criterion_group!(benches, planning);
criterion_main!(benches);
