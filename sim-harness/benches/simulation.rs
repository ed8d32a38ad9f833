//! How fast the simulated arm is, at ticks of 10 kHz on one core.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fivebar::plant::{Mismatch, Plant};
use fivebar::robot::Robot;
use fivebar_firmware::Command;
use std::hint::black_box;

const TICK: f64 = 1e-4;
const TICKS: u64 = 1000;

fn plant(c: &mut Criterion) {
    let robot = Robot::load("benchtop").unwrap();
    let home = robot.home_pose().unwrap();
    let mut group = c.benchmark_group("simulation");
    // Elements are ticks: 10 000 of them are one simulated second.
    group.throughput(Throughput::Elements(TICKS));
    group.bench_function("plant", |b| {
        b.iter(|| {
            let mut plant = Plant::new(&robot, &Mismatch::default(), &home, 1).unwrap();
            for tick in 0..TICKS {
                let duty = if tick / 100 % 2 == 0 { -0.1 } else { 0.1 };
                black_box(plant.sense());
                let enable = [true; 2];
                plant.step(
                    &Command {
                        duty: [duty, -duty],
                        enable,
                        brake: false,
                    },
                    TICK,
                );
            }
            plant.tool()
        });
    });
    group.finish();
}

criterion_group!(benches, plant);
criterion_main!(benches);
