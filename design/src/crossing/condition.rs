//! The condition of a type 2 singularity.
//!
//! At θ3 − θ2 = 0 or π, u3 = σ u2, the cranks can be still and C can move along n2. No torque acts
//! on this motion, (ω2, ω3) ∝ (1/l2, σ/l3), so whatever passes through must satisfy
//!
//! f = (1/l2)[J2 α2 + h2×(r̈B − g)] + (σ/l3)[J3 α3 + h3×(r̈D − g)] = 0
//!
//! (Briot & Arakelian 2008; no force acts on the tip). It is affine in the tip's acceleration,
//! f = N·r̈C + f0: with (k, j) = (1, 2), w = 1/l2 and (4, 3), w = σ/l3, s = sin(θj−θk),
//! c = cos(θj−θk), cc = lk (hx c − hy s), xx = lk (hx s + hy c),
//!
//! N = Σ w [−J uk/(lj s) + cc uj/(lk s)],
//! f0 = Σ w [−J (lk ωk² + lj ωj² c)/(lj s) + cc (lj ωj² + lk ωk² c)/(lk s) + xx ωk² − h×g].
//!
//! h = m c and J are the first and second moments of link j about B or D; the payload is part of
//! link 2.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Pose, Velocities};
use nalgebra::Vector2;

/// f = N·r̈C + f0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingCondition {
    /// N [kg].
    pub n: Vector2<f64>,
    /// f0 [N].
    pub f0: f64,
}

impl CrossingCondition {
    /// The condition at a pose in, or next to, a singularity of type 2.
    pub fn new(arm: &Arm<f64>, pose: &Pose<f64>, velocities: &Velocities<f64>) -> Self {
        let geometry = arm.geometry();
        let [omega1, omega2, omega3, omega4] = velocities.omega;
        let [_, link2, link3, _] = arm.links();
        let (l2, l3, payload) = (geometry.l2(), geometry.l3(), arm.payload());
        let sigma = pose.u2.dot(&pose.u3).signum();
        let moments = |link: &fivebar_kinematics::dynamics::Link<f64>| {
            let h = link.com * link.mass;
            (h, link.inertia + link.mass * link.com.length_squared())
        };
        let ((h2, j2), (h3, j3)) = (moments(link2), moments(link3));
        let tip = Vector2::new(payload * l2, 0.0);
        let legs = [
            Leg {
                w: 1.0 / l2,
                lk: geometry.l1(),
                lj: l2,
                uk: pose.u1,
                uj: pose.u2,
                omega_k: omega1,
                omega_j: omega2,
                h: h2 + tip,
                inertia: j2 + payload * l2 * l2,
            },
            Leg {
                w: sigma / l3,
                lk: geometry.l4(),
                lj: l3,
                uk: pose.u4,
                uj: pose.u3,
                omega_k: omega4,
                omega_j: omega3,
                h: h3,
                inertia: j3,
            },
        ];
        let [one, other] = legs.map(|leg| leg.part(arm.gravity()));
        Self {
            n: one.n + other.n,
            f0: one.f0 + other.f0,
        }
    }

    /// f for an acceleration of C [m/s²].
    pub fn value(&self, acceleration: Vector2<f64>) -> f64 {
        self.n.dot(&acceleration) + self.f0
    }
}

/// Crank k and coupler j.
struct Leg {
    w: f64,
    lk: f64,
    lj: f64,
    uk: Vector2<f64>,
    uj: Vector2<f64>,
    omega_k: f64,
    omega_j: f64,
    h: Vector2<f64>,
    inertia: f64,
}

impl Leg {
    fn part(&self, gravity: Vector2<f64>) -> CrossingCondition {
        let Self { w, lk, lj, .. } = *self;
        let (s, c) = (self.uk.cross_z(self.uj), self.uk.dot(&self.uj));
        let (hx, hy) = (self.h.x, self.h.y);
        let (cc, xx) = (lk * (hx * c - hy * s), lk * (hx * s + hy * c));
        let (square_k, square_j) = (self.omega_k * self.omega_k, self.omega_j * self.omega_j);
        let n = self.uj * (cc / (lk * s)) - self.uk * (self.inertia / (lj * s));
        let f0 = -self.inertia * (lk * square_k + lj * square_j * c) / (lj * s)
            + cc * (lj * square_j + lk * square_k * c) / (lk * s)
            + xx * square_k
            - self.h.to_base_frame(self.uj).cross_z(gravity);
        CrossingCondition {
            n: n * w,
            f0: f0 * w,
        }
    }
}
