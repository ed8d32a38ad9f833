//! The accuracy of a five-bar at a point: the effect of the tolerances of its lengths on C, to
//! first order and by Monte Carlo.
//!
//! `cargo run --example point_accuracy`

use fivebar_design::accuracy::five_bar::tool_sensitivities;
use fivebar_design::accuracy::{Primitive, Scatter};
use fivebar_kinematics::five_bar::{Geometry, Pose, Side, WorkingMode};
use nalgebra::{DMatrix, Vector2};
use std::error::Error;
use std::f64::consts::TAU;

/// Standard deviation of each length [m].
const DEVIATION: f64 = 20e-6;
const SAMPLES: u32 = 20_000;

/// A normally distributed number of mean 0 and variance 1 (Box and Muller).
fn normal(random: &mut oorandom::Rand64) -> f64 {
    let radius = (-2.0 * (1.0 - random.rand_float()).ln()).sqrt();
    radius * (TAU * random.rand_float()).cos()
}

/// C from the middle of the base [m], which is how the arm is mounted.
fn from_middle(geometry: &Geometry<f64>, pose: &Pose<f64>) -> Vector2<f64> {
    pose.c - geometry.e() * 0.5
}

fn main() -> Result<(), Box<dyn Error>> {
    let geometry = Geometry::new([0.23_f64, 0.23, 0.23, 0.23, 0.275])?;
    let outwards = WorkingMode::new(Side::Right, Side::Left);
    let pose = geometry.inverse(Vector2::new(0.1375, 0.25), outwards)?;

    // To first order: T over l1 … l4 and the base, and Cov = T Cov(lengths) Tᵀ.
    let by_lengths = tool_sensitivities(&geometry, &pose)?.lengths;
    let t = DMatrix::from_fn(2, 5, |row, column| by_lengths[column][row]);
    let names = ["l1", "l2", "l3", "l4", "base"];
    let primitive = |(name, mean): (&str, f64)| Primitive {
        name: name.into(),
        mean,
        deviation: DEVIATION,
    };
    let primitives: Vec<_> = names
        .into_iter()
        .zip(geometry.lengths())
        .map(primitive)
        .collect();
    let scatter = Scatter::propagate(&t, &primitives);
    let linear = scatter.deviations();

    // By sampling: arms with random lengths, their driven joints at the nominal angles.
    let [theta1, _, _, theta4] = pose.angles();
    let nominal = from_middle(&geometry, &pose);
    let mut random = oorandom::Rand64::new(1);
    let mut squares = Vector2::zeros();
    for _ in 0..SAMPLES {
        let lengths = geometry
            .lengths()
            .map(|length| length + DEVIATION * normal(&mut random));
        let made = Geometry::new(lengths)?;
        let error = from_middle(&made, &made.forward(theta1, theta4, Side::Left)?) - nominal;
        squares += error.component_mul(&error);
    }
    let sampled = (squares / f64::from(SAMPLES)).map(f64::sqrt);

    println!("standard deviation [µm]    x        y");
    println!(
        "first order         {:8.2} {:8.2}",
        1e6 * linear[0],
        1e6 * linear[1]
    );
    println!(
        "{SAMPLES} samples       {:8.2} {:8.2}",
        1e6 * sampled.x,
        1e6 * sampled.y
    );
    println!("shares of the variance in y:");
    for (name, share) in names.iter().zip(scatter.shares(1)) {
        println!("  {name:4} {:4.1} %", 100.0 * share);
    }
    assert!((1e6 * linear[0] - 14.72).abs() < 0.005 && (1e6 * linear[1] - 106.05).abs() < 0.005);
    // The standard deviation of n samples scatters by 1/√(2n): 0.5 % here.
    assert!((sampled.x / linear[0] - 1.0).abs() < 0.02);
    assert!((sampled.y / linear[1] - 1.0).abs() < 0.02);
    Ok(())
}

#[test]
fn sampling_confirms_the_first_order() -> Result<(), Box<dyn Error>> {
    main()
}
