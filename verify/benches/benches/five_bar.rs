//! Time of the position solutions and of inverse dynamics, in both precisions:
//! `cargo bench -p fivebar-benches --bench five_bar`.

use criterion::{Criterion, criterion_group, criterion_main};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::Vector2;
use std::hint::black_box;

fn arm<S: Scalar>() -> Arm<S> {
    let number = S::from_f64;
    let geometry = Geometry::new([0.1, 0.16, 0.16, 0.1, 0.08].map(number)).expect("it closes");
    let link = Link {
        mass: number(0.1),
        com: Vector2::new(number(0.05), number(0.002)),
        inertia: number(1e-4),
    };
    let gravity = Vector2::new(number(0.0), number(-9.81));
    Arm::new(
        geometry,
        [link; 4],
        number(0.05),
        gravity,
        [number(1e-5); 2],
    )
    .expect("it has mass")
}

fn solutions<S: Scalar>(criterion: &mut Criterion, precision: &str) {
    let arm = arm::<S>();
    let geometry = *arm.geometry();
    let number = S::from_f64;
    let mut group = criterion.benchmark_group(precision);

    let (theta1, theta4) = (number(2.1), number(1.0));
    group.bench_function("forward position", |bencher| {
        bencher.iter(|| geometry.forward(black_box(theta1), black_box(theta4), Side::Left));
    });

    let c = Vector2::new(number(0.05), number(0.2));
    let mode = WorkingMode::new(Side::Right, Side::Left);
    group.bench_function("inverse position, both angles", |bencher| {
        bencher.iter(|| {
            let pose = geometry.inverse(black_box(c), mode)?;
            Ok::<_, fivebar_kinematics::five_bar::PoseError>([
                pose.u1.polar_angle(),
                pose.u4.polar_angle(),
            ])
        });
    });

    let pose = geometry.inverse(c, mode).expect("within reach");
    let rates = geometry.forward_velocities(&pose, number(2.0), number(-1.0));
    let rates = rates.expect("not singular");
    let accelerations = geometry.forward_accelerations(&pose, &rates, number(30.0), number(20.0));
    let accelerations = accelerations.expect("not singular");
    group.bench_function("inverse dynamics", |bencher| {
        bencher.iter(|| {
            arm.inverse_dynamics(
                black_box(&pose),
                black_box(&rates),
                black_box(&accelerations),
                Vector2::zeros(),
            )
        });
    });
    group.finish();
}

fn five_bar(criterion: &mut Criterion) {
    solutions::<f32>(criterion, "f32");
    solutions::<f64>(criterion, "f64");
}

criterion_group!(benches, five_bar);
criterion_main!(benches);
