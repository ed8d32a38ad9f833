//! How fast the simulated arm is, at ticks of 10 kHz on one core.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_plant::{Mismatch, Plant, TorquePlant};
use fivebar_sim::simulation::Simulate;
use std::hint::black_box;

const TICK: f64 = 1e-4;
const TICKS: u64 = 1000;
const ARMS: usize = 1000;

fn plant(c: &mut Criterion) {
    let robot = Robot::load("benchtop").unwrap();
    let home = robot.home_pose().unwrap();
    let mut group = c.benchmark_group("simulation");
    // Elements are ticks: 10 000 of them are one simulated second.
    group.throughput(Throughput::Elements(TICKS));
    let realistic = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../host/files/scenarios/realistic.toml"
    );
    let realistic = Scenario::load(realistic).unwrap().mismatch;
    for (name, mismatch) in [
        ("plant", Mismatch::default()),
        ("realistic plant", realistic),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| {
                let parameters = robot.plant_parameters().unwrap();
                let mut plant = Plant::new(&parameters, &mismatch, &home, 1);
                for tick in 0..TICKS {
                    let duty = if tick / 100 % 2 == 0 { -0.1 } else { 0.1 };
                    black_box(plant.sense());
                    let enable = [true; 2];
                    plant.step(
                        &ActuatorCommand {
                            drives: BrushedCommand {
                                duty: [duty, -duty],
                            },
                            enable,
                            brake: false,
                            tool: 0,
                        },
                        TICK,
                    );
                }
                plant.tool()
            });
        });
    }
    group.finish();
}

/// The whole loop: homing and a short job under the production controller, traced.
fn drawing(c: &mut Criterion) {
    let robot = Robot::load("benchtop").unwrap();
    let text = include_str!("../../../host/files/jobs/petal.gcode");
    let scenario = Scenario::new("petal", robot, "petal.gcode", text.into());
    let job = scenario.job().unwrap();
    let run = || scenario.simulate(&job, &mut |_| ()).unwrap();
    let (summary, _) = run();
    let mut group = c.benchmark_group("simulation");
    group.throughput(Throughput::Elements(summary.ticks));
    group.sample_size(20);
    group.bench_function("drawing", |b| b.iter(run));
    group.finish();
}

/// 1 ms of arms that make the torques that they are told, on one core: by themselves, and side by side.
fn many(c: &mut Criterion) {
    let robot = Robot::load("benchtop").unwrap();
    let parameters = robot.plant_parameters().unwrap();
    let home = robot.home_pose().unwrap();
    let arm = TorquePlant::new(&parameters, &Mismatch::NONE, &home);
    let (mut arms, torques) = (vec![arm; ARMS], vec![[1e-3, -1e-3]; ARMS]);
    let before = arms[0].state();
    let mut group = c.benchmark_group("torques");
    group.throughput(Throughput::Elements(ARMS as u64));
    group.bench_function("each by itself", |b| {
        b.iter(|| {
            for (arm, torque) in arms.iter_mut().zip(&torques) {
                arm.set_state(&before);
                arm.step(*torque, 1e-3).unwrap();
            }
        });
    });
    group.bench_function("side by side", |b| {
        b.iter(|| {
            for arm in &mut arms {
                arm.set_state(&before);
            }
            TorquePlant::step_many(&mut arms, &torques, &[[0.0; 2]; ARMS], 1e-3)
        });
    });
    group.finish();
}

criterion_group!(benches, plant, drawing, many);
criterion_main!(benches);
