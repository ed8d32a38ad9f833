//! Random arms on belts, and how they differ from their models.

use fivebar_files::robot::Robot;
use fivebar_plant::Mismatch;
use oorandom::Rand64;
use std::fmt::Write as _;

/// An arm, and how it differs from its model.
pub(crate) struct RandomArm {
    pub(crate) robot: Robot,
    pub(crate) mismatch: Mismatch,
    /// Of both belts [N·m/rad].
    pub(crate) stiffness: [f64; 2],
}

/// Numbers of one seed.
struct Draw(Rand64);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.rand_float()
    }

    /// Evenly in its logarithm.
    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.0.rand_float())
    }

    fn pair(&mut self, low: f64, high: f64) -> [f64; 2] {
        [self.between(low, high), self.between(low, high)]
    }
}

impl RandomArm {
    /// The arm of this seed: about the benchtop's size, its belts of 300 to 5000 N·m/rad, in every second arm two
    /// different ones.
    pub(crate) fn new(seed: u64) -> Self {
        let draw = &mut Draw(Rand64::new(seed.into()));
        let stiffness = draw.scaled(300.0, 5000.0);
        let other = if seed.is_multiple_of(2) {
            draw.scaled(0.6, 1.6)
        } else {
            1.0
        };
        let stiffness = [stiffness, (stiffness * other).clamp(300.0, 5000.0)];
        let text = text(draw, stiffness);
        let robot = Robot::parse("random.toml", &text);
        let robot = robot.unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
        Self {
            robot,
            mismatch: mismatch(draw, stiffness),
            stiffness,
        }
    }
}

/// As large as the demonstration's in either direction, and the stiffness within 5 %.
fn mismatch(draw: &mut Draw, stiffness: [f64; 2]) -> Mismatch {
    let off = draw.pair(0.95, 1.05);
    Mismatch {
        link_mass: draw.between(-0.1, 0.1),
        friction: draw.between(-0.3, 0.3),
        payload: draw.between(0.0, 0.02),
        stiffness: Some([stiffness[0] * off[0], stiffness[1] * off[1]]),
        ..Mismatch::default()
    }
}

/// Its file.
fn text(draw: &mut Draw, stiffness: [f64; 2]) -> String {
    let size = draw.between(0.8, 1.25);
    let base = 0.08 * size * draw.between(0.6, 1.3);
    let payload = draw.between(0.01, 0.05);
    let mut text = format!(
        "name = \"random\"\ngravity = [0.0, 0.0]\nbase = {base:?}\npayload = {payload:?}\n\
         working_mode = [\"right\", \"left\"]\n"
    );
    for crank in [true, false, false, true] {
        let length = size * draw.between(0.9, 1.1) * if crank { 0.10 } else { 0.16 };
        let mass = size * draw.between(0.7, 1.4) * if crank { 0.07 } else { 0.045 };
        let along = length * draw.between(0.3, 0.55);
        // A rod has 1/12.
        let inertia = mass * length * length / 12.0 * draw.between(1.5, 2.8);
        let _ = writeln!(
            text,
            "[[link]]\nlength = {length:?}\nmass = {mass:?}\ncom = [{along:?}, 0.0]\n\
             inertia = {inertia:?}"
        );
    }
    let rotor = draw.scaled(0.6e-6, 2e-6);
    let damping_ratio = draw.scaled(0.002, 0.05);
    let counts = 4096 << draw.0.rand_range(0..3);
    let latency = if draw.0.rand_float() < 0.5 {
        0.0
    } else {
        draw.between(0.0, 2e-4)
    };
    let friction = draw.between(3e-3, 15e-3);
    for stiffness in stiffness {
        let damping = 2.0 * damping_ratio * (stiffness * 64.0 * rotor).sqrt();
        let _ = writeln!(
            text,
            "[[actuator]]\ngear_ratio = 8.0\nrotor_inertia = {rotor:?}\ntorque_constant = 0.0234\n\
             resistance = 2.3\ninductance = 0.24e-3\ncoulomb_friction = {friction:?}\n\
             viscous_friction = 1.5e-3\nencoder_counts = {counts}\nstiffness = {stiffness:?}\n\
             drive_damping = {damping:?}\nencoder_latency = {latency:?}\npeak_current = 4.0\n\
             continuous_current = 1.3\nthermal_time_constant = 12.0"
        );
    }
    text + "[limits]\nangle = [[-6.28, 6.28], [-6.28, 6.28]]\nmax_speed = [35.0, 35.0]\n\
            max_acceleration = [1000.0, 1000.0]\nsingularity_margin = 0.15\n[motion]\n\
            max_speed = 0.3\nmax_acceleration = 4.0\nmax_jerk = 200.0\ncorner_tolerance = 5e-5\n\
            [protection]\nfollowing_error = 0.02\n[supply]\nvoltage = 24.0\n"
}
