//! Time of time-optimal planning: the paths of the reference, without and with limits of jerk, and the whole
//! demonstration. To be compared with the motions, which take 0.11 to 0.32 s and 2.4 to 2.7 s. On one core:
//! `RAYON_NUM_THREADS=1 cargo bench -p fivebar-benches --bench planning`.

use criterion::{Criterion, criterion_group, criterion_main};
use fivebar_files::path_case::PathCase;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_report::study::plan::PlanStudy;
use fivebar_sim::simulation::Simulate;
use serde_json::Value;

fn planning(c: &mut Criterion) {
    let mut group = c.benchmark_group("planning");
    group.sample_size(20);
    let text = include_str!("../../../tests/data/topp_public.json");
    let data: Value = serde_json::from_str(text).unwrap();
    for case in data["cases"].as_array().unwrap() {
        let case = PathCase::parse("case.json", &case.to_string()).unwrap();
        let robot = Robot::load(case.robot.as_deref().unwrap()).unwrap();
        let name = case.name.as_deref().unwrap();
        group.bench_function(name, |b| {
            b.iter(|| PlanStudy::new(&robot, &case, 1.0, None).unwrap());
        });
        // The curvature of this path jumps, so no limit of jerk can be kept on it.
        if name == "square_rounded" {
            continue;
        }
        for jerk in [1e5, 3e5, 1e6] {
            group.bench_function(format!("{name}, jerk {jerk:.0e}"), |b| {
                b.iter(|| PlanStudy::new(&robot, &case, 1.0, Some(jerk)).unwrap());
            });
        }
    }
    let mut scenario = Scenario::demonstration(Robot::load("benchtop").unwrap());
    for share in [0.7, 0.9] {
        scenario.time_optimal = Some(share);
        let job = scenario.job().unwrap();
        group.bench_function(format!("demonstration, share {share}"), |b| {
            b.iter(|| scenario.run_moves(&job).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, planning);
criterion_main!(benches);
