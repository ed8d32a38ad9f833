//! Monte Carlo throughput on all cores: positions and full force samples a second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fivebar_design::accuracy::Sampling;
use fivebar_design::accuracy::five_bar::{ToolState, analyse, sample_forces, sample_positions};
use fivebar_files::robot::Robot;
use nalgebra::Vector2;

fn throughput(criterion: &mut Criterion) {
    let robot = Robot::load("benchtop").unwrap();
    let state = ToolState {
        velocity: Vector2::new(0.1, 0.0),
        acceleration: Vector2::new(0.0, 1.0),
        ..ToolState::at_rest(Vector2::new(0.04, 0.2))
    };
    let arm = robot.toleranced();
    let analysis = analyse(&arm, &state).unwrap();
    let sampling = Sampling {
        samples: 100_000,
        seed: 1,
    };
    let mut group = criterion.benchmark_group("monte_carlo");
    group.sample_size(10);
    group.throughput(Throughput::Elements(sampling.samples as u64));
    group.bench_function("positions", |bencher| {
        bencher.iter(|| sample_positions(&arm, &state, &analysis, sampling, &|_| ()));
    });
    group.bench_function("forces", |bencher| {
        bencher.iter(|| sample_forces(&arm, &state, &analysis, sampling, &|_| ()));
    });
    group.finish();
}

criterion_group!(benches, throughput);
criterion_main!(benches);
