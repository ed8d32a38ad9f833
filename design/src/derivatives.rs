//! First and second derivatives of an arm's motion and torques by its angles, rates, accelerations,
//! lengths and masses, exact to rounding: the models run on hyper-dual numbers.
//!
//! With x the [variables](VARIABLE_NAMES) and y the [quantities](QUANTITY_NAMES) of the forward solution and of the
//! inverse dynamics, Fike and Alonso's hyper-dual numbers (AIAA 2011-886) give ∂y/∂xi, ∂y/∂xj and ∂²y/∂xi∂xj
//! in one evaluation without a step size.

use crate::{Gradient, HyperDual};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, PoseError, Side};
use nalgebra::Vector2;

/// The number of variables.
pub const VARIABLES: usize = 15;
/// The number of quantities.
pub const QUANTITIES: usize = 8;

/// First derivatives that one evaluation gives: a divisor of [`VARIABLES`].
const TOGETHER: usize = 5;

/// The names of the variables: θ [rad], ω [rad/s], α [rad/s²] of joints 1 and 4, lengths [m], masses of
/// links 1 to 4 [kg]. A changed length or mass leaves the centres of mass and the moments of inertia about
/// them as they are.
pub const VARIABLE_NAMES: [&str; VARIABLES] = [
    "theta1", "theta4", "omega1", "omega4", "alpha1", "alpha4", "l1", "l2", "l3", "l4", "base",
    "m1", "m2", "m3", "m4",
];
/// The names of the quantities: C [m], its velocity [m/s] and acceleration [m/s²], and the torques on links 1
/// and 4 [N·m].
pub const QUANTITY_NAMES: [&str; QUANTITIES] =
    ["x", "y", "vx", "vy", "ax", "ay", "torque1", "torque4"];

/// A state of the driven joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// θ1, θ4 [rad].
    pub theta: [f64; 2],
    /// ω1, ω4 [rad/s].
    pub omega: [f64; 2],
    /// α1, α4 [rad/s²].
    pub alpha: [f64; 2],
    /// The side of C.
    pub assembly: Side,
}

/// Quantities with their derivatives, in the orders of [`QUANTITY_NAMES`] and [`VARIABLE_NAMES`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Derivatives {
    /// The quantities.
    pub value: [f64; QUANTITIES],
    /// ∂y/∂x.
    pub first: [[f64; VARIABLES]; QUANTITIES],
    /// ∂²y/∂xi∂xj, symmetric.
    pub second: [[[f64; VARIABLES]; VARIABLES]; QUANTITIES],
}

/// The derivatives of an arm in a state.
///
/// ```
/// use fivebar_design::derivatives::{State, derivatives};
/// use fivebar_kinematics::dynamics::{Arm, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Side};
/// use nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length));
/// let arm = Arm::new(geometry, rods, 0.03, Vector2::zeros(), [2e-5; 2])?;
/// let state = State { theta: [2.2, 0.9], omega: [1.0, -2.0], alpha: [0.0; 2], assembly: Side::Left };
/// let found = derivatives(&arm, &state)?;
/// // ∂τ1/∂α1 = M11, which does not depend on ω: its derivative by ω1 is 0.
/// assert!(found.first[6][4] > 0.0 && found.second[6][4][2] == 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The links do not reach, or the arm is at a singularity of type 2.
pub fn derivatives(arm: &Arm<f64>, state: &State) -> Result<Derivatives, PoseError> {
    let mut found = Derivatives {
        value: [0.0; QUANTITIES],
        first: [[0.0; VARIABLES]; QUANTITIES],
        second: [[[0.0; VARIABLES]; VARIABLES]; QUANTITIES],
    };
    for i in 0..VARIABLES {
        for j in i..VARIABLES {
            let unit = |index: usize| {
                [
                    f64::from(u8::from(index == i)),
                    f64::from(u8::from(index == j)),
                ]
            };
            let quantities = quantities(arm, state, |index, value| {
                HyperDual::new(value, unit(index))
            })?;
            for (k, quantity) in quantities.into_iter().enumerate() {
                found.value[k] = quantity.value();
                found.first[k][i] = quantity.first()[0];
                found.second[k][i][j] = quantity.second();
                found.second[k][j][i] = quantity.second();
            }
        }
    }
    Ok(found)
}

/// The quantities with their first derivatives alone: less than a tenth of the work of [`derivatives`].
///
/// # Errors
/// As [`derivatives`].
pub fn first_derivatives(
    arm: &Arm<f64>,
    state: &State,
) -> Result<([f64; QUANTITIES], [[f64; VARIABLES]; QUANTITIES]), PoseError> {
    let mut value = [0.0; QUANTITIES];
    let mut first = [[0.0; VARIABLES]; QUANTITIES];
    for from in (0..VARIABLES).step_by(TOGETHER) {
        let quantities = quantities(arm, state, |index, value| {
            Gradient::<TOGETHER>::variable(value, index.wrapping_sub(from))
        })?;
        let rows = value.iter_mut().zip(&mut first);
        for ((value, row), quantity) in rows.zip(quantities) {
            *value = quantity.value();
            row[from..from + TOGETHER].copy_from_slice(&quantity.derivatives());
        }
    }
    Ok((value, first))
}

/// The quantities as functions of the variables; `variable` makes a number of a variable's index and value.
fn quantities<S: Scalar>(
    arm: &Arm<f64>,
    state: &State,
    variable: impl Fn(usize, f64) -> S,
) -> Result<[S; QUANTITIES], PoseError> {
    let fixed = S::from_f64;
    let vector = |v: Vector2<f64>| Vector2::new(fixed(v.x), fixed(v.y));
    let from = |first: usize, [a, b]: [f64; 2]| [variable(first, a), variable(first + 1, b)];
    let [theta1, theta4] = from(0, state.theta);
    let [omega1, omega4] = from(2, state.omega);
    let [alpha1, alpha4] = from(4, state.alpha);
    let lengths = arm.geometry().lengths();
    let lengths = std::array::from_fn(|index| variable(6 + index, lengths[index]));
    let links = std::array::from_fn(|index| {
        let Link { mass, com, inertia } = arm.links()[index];
        Link {
            mass: variable(11 + index, mass),
            com: vector(com),
            inertia: fixed(inertia),
        }
    });
    // The values are those of an arm, which are valid.
    let geometry = Geometry::new(lengths).map_err(|_| PoseError::NotFinite)?;
    let gravity = vector(arm.gravity());
    let rotors = arm.rotor_inertia().map(fixed);
    let arm = Arm::new(geometry, links, fixed(arm.payload()), gravity, rotors)
        .map_err(|_| PoseError::NotFinite)?;
    let pose = geometry.forward(theta1, theta4, state.assembly)?;
    let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
    let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
    let [torque1, torque4] =
        arm.inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())?;
    let (c, v, a) = (pose.c, velocities.c, accelerations.c);
    Ok([c.x, c.y, v.x, v.y, a.x, a.y, torque1, torque4])
}
