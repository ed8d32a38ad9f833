//! The torques as a linear function of the masses.
//!
//! For link j with its proximal joint P, f = aP − g, partial angular velocities ωjr and partial
//! velocities vP,r of r ∈ {1, 4}; e = u(θj) for hx and n(θj) for hy, e⊥ is e turned by 90°:
//!
//! column(m) = f·vP,r, column(J) = αj ωjr,
//! column(h) = ωjr f·e⊥ + vP,r·(αj e⊥ − ωj² e).

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Geometry, Pose, PoseError, Side};
use nalgebra::{SMatrix, Vector2};

/// Columns of the base parameters among the 16 standard ones; the first 7 without gravity.
pub const BASE_COLUMNS: [usize; 11] = [3, 15, 7, 11, 5, 6, 10, 1, 2, 13, 14];

/// Names of the base parameters; the first 7 without gravity.
pub const BASE_NAMES: [&str; 11] = [
    "J1", "J4", "J2", "J3", "h2x", "h2y", "h3y", "h1x", "h1y", "h4x", "h4y",
];

/// Torques per standard parameter: of links 1 to 4 each m [kg], hx, hy [kg·m] and J [kg·m²], and
/// with them the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Regressor {
    /// One row for τ1 and one for τ4.
    pub standard: SMatrix<f64, 2, 16>,
    /// The pose.
    pub pose: Pose<f64>,
}

impl Regressor {
    /// At joint angles `q` [rad], velocities `omega` [rad/s] and accelerations `alpha` [rad/s²],
    /// with `gravity` [m/s²] in the plane.
    ///
    /// # Errors
    /// The arm has no pose there, or is at a singularity.
    pub fn at(
        geometry: &Geometry<f64>,
        assembly: Side,
        gravity: Vector2<f64>,
        [q, omega, alpha]: [[f64; 2]; 3],
    ) -> Result<Self, PoseError> {
        let pose = geometry.forward(q[0], q[1], assembly)?;
        let motion = geometry.forward_velocities(&pose, omega[0], omega[1])?;
        let rates = geometry.forward_accelerations(&pose, &motion, alpha[0], alpha[1])?;
        // ωjr: the angular velocities for a unit velocity of one driven joint.
        let partial = [
            geometry.forward_velocities(&pose, 1.0, 0.0)?.omega,
            geometry.forward_velocities(&pose, 0.0, 1.0)?.omega,
        ];
        let still = Vector2::zeros();
        let (n1, n4) = (pose.u1.perpendicular(), pose.u4.perpendicular());
        let (l1, l4) = (geometry.l1(), geometry.l4());
        let accelerated = |u: Vector2<f64>, l: f64, omega: f64, alpha: f64| {
            (u.perpendicular() * alpha - u * (omega * omega)) * l
        };
        let ab = accelerated(pose.u1, l1, omega[0], alpha[0]);
        let ad = accelerated(pose.u4, l4, omega[1], alpha[1]);
        // Of links 1 to 4: u(θj), aP, vP,1 and vP,4.
        let links = [
            (pose.u1, still, [still, still]),
            (pose.u2, ab, [n1 * l1, still]),
            (pose.u3, ad, [still, n4 * l4]),
            (pose.u4, still, [still, still]),
        ];
        let mut standard = SMatrix::<f64, 2, 16>::zeros();
        for (j, (u, a, v)) in links.into_iter().enumerate() {
            let f = a - gravity;
            let (omega, alpha) = (motion.omega[j], rates.alpha[j]);
            let n = u.perpendicular();
            for r in 0..2 {
                let omega_r = partial[r][j];
                let moment = |e: Vector2<f64>, turned: Vector2<f64>| {
                    omega_r * f.dot(&turned) + v[r].dot(&(turned * alpha - e * (omega * omega)))
                };
                standard[(r, 4 * j)] = f.dot(&v[r]);
                standard[(r, 4 * j + 1)] = moment(u, n);
                standard[(r, 4 * j + 2)] = moment(n, -u);
                standard[(r, 4 * j + 3)] = alpha * omega_r;
            }
        }
        Ok(Self { standard, pose })
    }

    /// The torques' derivatives by base parameter `index`.
    pub fn base(&self, index: usize) -> [f64; 2] {
        let column = BASE_COLUMNS[index];
        [self.standard[(0, column)], self.standard[(1, column)]]
    }

    /// The torques of these base parameters [N·m].
    pub fn torque(&self, base: &[f64]) -> [f64; 2] {
        let mut torque = [0.0; 2];
        for (index, value) in base.iter().enumerate() {
            let [of1, of4] = self.base(index);
            torque[0] += of1 * value;
            torque[1] += of4 * value;
        }
        torque
    }
}
