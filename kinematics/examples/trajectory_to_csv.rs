//! A jerk-limited trajectory, sampled to CSV: a rectangle with rounded corners.
//!
//! `cargo run --example trajectory_to_csv rectangle.csv`; without a name, to the terminal.

use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
use fivebar_kinematics::nalgebra::Vector2;
use fivebar_kinematics::trajectory::{
    Envelope, LookaheadPlanner, MotionLimits, PathSegment, Reference,
};
use std::error::Error;
use std::fmt::Write as _;

const PERIOD: f64 = 1e-3; // s
/// 0.2 m/s, 4 m/s² and 200 m/s³ for the tool.
const TOOL: MotionLimits<f64> = MotionLimits {
    speed: 0.2,
    acceleration: 4.0,
    jerk: 200.0,
};

/// Position [m], velocity [m/s] and acceleration [m/s²] of the tool.
type Sample = [Vector2<f64>; 3];

fn samples() -> Result<Vec<Sample>, Box<dyn Error>> {
    let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08])?;
    let envelope = Envelope {
        workspace: Workspace {
            tool: Tool::new(geometry, Vector2::zeros())?,
            mode: WorkingMode::new(Side::Right, Side::Left),
            limits: None,
            margin: 0.15,
        },
        joint_speed: [20.0; 2],
        joint_acceleration: [1000.0; 2],
        torque: None,
        tool_motion: TOOL,
        corner_tolerance: 0.2e-3,
    };
    let mut planner = LookaheadPlanner::<f64, 16>::new();
    let mut from = Vector2::new(0.01, 0.16);
    let corners = [[0.07, 0.16], [0.07, 0.20], [0.01, 0.20], [0.01, 0.16]];
    for (side, to) in (1..).zip(corners.map(Vector2::from)) {
        let line = PathSegment::line(from, to)?;
        let limits = envelope.check(&line, TOOL.speed)?;
        planner.push(&line, limits, side, &envelope)?;
        from = to;
    }

    let (mut samples, mut into) = (Vec::new(), 0.0);
    while let Some(segment) = planner.next_segment() {
        while into < segment.duration() {
            if let Reference::Tool {
                position,
                velocity,
                acceleration,
            } = segment.evaluate(into)
            {
                samples.push([position, velocity, acceleration]);
            }
            into += PERIOD;
        }
        into -= segment.duration();
    }
    Ok(samples)
}

fn csv(samples: &[Sample]) -> Result<String, std::fmt::Error> {
    let mut text = String::from("time_s,x_m,y_m,vx_m_s,vy_m_s,ax_m_s2,ay_m_s2\n");
    for (tick, [p, v, a]) in samples.iter().enumerate() {
        write!(text, "{:.4},{},{},", PERIOD * tick as f64, p.x, p.y)?;
        writeln!(text, "{},{},{},{}", v.x, v.y, a.x, a.y)?;
    }
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    let text = csv(&samples()?)?;
    match std::env::args().nth(1) {
        Some(file) => std::fs::write(file, text)?,
        None => print!("{text}"),
    }
    Ok(())
}

#[test]
fn every_limit_of_the_tool_is_kept() -> Result<(), Box<dyn Error>> {
    let samples = samples()?;
    assert_eq!(csv(&samples)?.lines().count(), samples.len() + 1);
    assert!((samples[0][0] - samples[samples.len() - 1][0]).norm() < 1e-5);
    for pair in samples.windows(2) {
        let [[p0, v0, a0], [p1, v1, a1]] = [pair[0], pair[1]];
        assert!(v1.norm() <= TOOL.speed * 1.0001 && a1.norm() <= TOOL.acceleration * 1.0001);
        assert!((a1 - a0).norm() <= TOOL.jerk * PERIOD * 1.0001);
        // The mean of two samples' velocities leads from one position to the next.
        assert!((p1 - p0 - (v0 + v1) * (0.5 * PERIOD)).norm() < 0.1 * TOOL.jerk * PERIOD.powi(3));
    }
    Ok(())
}
