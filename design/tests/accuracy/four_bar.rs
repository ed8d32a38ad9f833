//! Shi 2005's four-bar with clearance in two joints: the scatter of its motion and forces, by the
//! analytic matrices and by dual numbers, and the errors caused by the terms that the paper omits.

use fivebar_design::accuracy::loops::{LoopQuantity, Term, TimeDerivatives, VectorLoops};
use fivebar_design::accuracy::{DifferentiableModel, Primitive, Scatter, sensitivities};
use fivebar_design::linkage::PointMotion;
use fivebar_design::linkage::dyad::{DyadError, Rrr};
use fivebar_kinematics::five_bar::Side;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;
use nalgebra::{DMatrix, DVector};

const DENSITY: f64 = 7800.0;
/// Values and standard deviations: V, V̇, V̈, L1…L4, rB, rC, aB, aC, S1…S3.
const MEANS: [f64; 14] = [
    0.9, 20.0, 0.0, 0.1, 0.3, 0.25, 0.35, 1e-4, 1.5e-4, 0.7, -0.4, 2e-4, 1.5e-4, 1.8e-4,
];
const DEVIATIONS: [f64; 14] = [
    1e-3, 0.4, 4.0, 1e-4, 1e-4, 1e-4, 1e-4, 2e-5, 2e-5, 0.3, 0.3, 2e-6, 2e-6, 2e-6,
];
/// The primitives of the motion come first; the section areas affect forces only.
const KINEMATIC: usize = 11;

/// U, U̇ and Ü of coupler and rocker.
#[derive(Clone, Copy)]
struct State<S> {
    angle: [S; 2],
    rate: [S; 2],
    acceleration: [S; 2],
}

/// L1 e^{iV} + rB e^{iaB} + L2 e^{iU1} + rC e^{iaC} = L4 + L3 e^{iU2}.
fn loops() -> VectorLoops {
    let term = |sign, length, angle| Term {
        sign,
        length,
        angle,
        angle_offset: 0.0,
    };
    let (unknown, parameter) = (LoopQuantity::Unknown, LoopQuantity::Parameter);
    VectorLoops {
        loops: vec![vec![
            term(1.0, parameter(0), LoopQuantity::Input(0)),
            term(1.0, parameter(4), parameter(6)),
            term(1.0, parameter(1), unknown(0)),
            term(1.0, parameter(5), parameter(7)),
            term(-1.0, parameter(2), unknown(1)),
            term(-1.0, parameter(3), LoopQuantity::Constant(0.0)),
        ]],
        inputs: 1,
        parameters: MEANS[3..KINEMATIC].to_vec(),
    }
}

fn inputs() -> TimeDerivatives {
    TimeDerivatives {
        value: DVector::from_element(1, MEANS[0]),
        rate: DVector::from_element(1, MEANS[1]),
        acceleration: DVector::from_element(1, MEANS[2]),
    }
}

/// The same motion by the RRR dyad, whose ends the clearances shift.
fn motion<S: Scalar>(p: &[S]) -> Result<State<S>, DyadError> {
    let crank = Vector2::unit(p[0]) * p[3];
    let end1 = PointMotion {
        position: crank + Vector2::unit(p[9]) * p[7] + Vector2::unit(p[10]) * p[8],
        velocity: crank.perpendicular() * p[1],
        acceleration: crank.perpendicular() * p[2] - crank * (p[1] * p[1]),
    };
    let still = PointMotion {
        position: Vector2::new(p[6], S::ZERO),
        velocity: Vector2::zeros(),
        acceleration: Vector2::zeros(),
    };
    let dyad = Rrr {
        lengths: [p[4], p[5]],
        side: Side::Left,
    };
    let links = dyad.motion(&end1, &still)?.links;
    Ok(State {
        angle: links.map(|link| link.axis.polar_angle()),
        rate: links.map(|link| link.omega),
        acceleration: links.map(|link| link.alpha),
    })
}

/// Π solved for R: the forces A (ground on crank), B (crank on coupler), C (coupler on
/// rocker), D (ground on rocker) and the torque, clearances left out of the arms.
fn forces<S: Scalar>(p: &[S], state: &State<S>) -> Vec<S> {
    let number = S::from_f64;
    let u = [
        Vector2::unit(p[0]),
        Vector2::unit(state.angle[0]),
        Vector2::unit(state.angle[1]),
    ];
    let rate = [p[1], state.rate[0], state.rate[1]];
    let acceleration = [p[2], state.acceleration[0], state.acceleration[1]];
    let arm = [0, 1, 2].map(|i| u[i] * p[3 + i]);
    let mass = [0, 1, 2].map(|i| number(DENSITY) * p[11 + i] * p[3 + i]);
    let at =
        |r: Vector2<S>, i: usize| r.perpendicular() * acceleration[i] - r * (rate[i] * rate[i]);
    let half = |i: usize| arm[i] * S::HALF;
    let inertia = |i: usize| mass[i] * p[3 + i] * p[3 + i] / number(12.0) * acceleration[i];
    let f = [
        at(half(0), 0),
        at(arm[0], 0) + at(half(1), 1),
        at(half(2), 2),
    ];
    let f = [0, 1, 2].map(|i| f[i] * mass[i]);
    let moment = [0, 1, 2].map(|i| inertia(i) + half(i).cross_z(f[i]));
    // Coupler about B: arm2 × C = −moment2; rocker about D: arm3 × C = moment3.
    let determinant = arm[1].cross_z(arm[2]);
    let c = (arm[1] * moment[2] + arm[2] * moment[1]) * (-S::ONE / determinant);
    let b = f[1] + c;
    let a = f[0] + b;
    let d = f[2] - c;
    vec![
        a.x,
        a.y,
        b.x,
        b.y,
        c.x,
        c.y,
        d.x,
        d.y,
        moment[0] + arm[0].cross_z(b),
    ]
}

struct FourBar;

impl DifferentiableModel for FourBar {
    type Error = DyadError;

    fn evaluate<S: Scalar>(&self, p: &[S]) -> Result<Vec<S>, DyadError> {
        let state = motion(p)?;
        let mut results = [state.angle, state.rate, state.acceleration].concat();
        results.extend(forces(p, &state));
        Ok(results)
    }
}

/// Π alone: U, U̇ and Ü as arguments after the primitives.
struct Forces;

impl DifferentiableModel for Forces {
    type Error = std::convert::Infallible;

    fn evaluate<S: Scalar>(&self, p: &[S]) -> Result<Vec<S>, Self::Error> {
        let state = State {
            angle: [p[14], p[15]],
            rate: [p[16], p[17]],
            acceleration: [p[18], p[19]],
        };
        Ok(forces(p, &state))
    }
}

fn primitives() -> Vec<Primitive> {
    let values = MEANS.into_iter().zip(DEVIATIONS);
    let primitive = |(mean, deviation)| Primitive {
        name: String::new(),
        mean,
        deviation,
    };
    values.map(primitive).collect()
}

#[track_caller]
fn assert_close(actual: f64, expected: f64, relative: f64) {
    let error = (actual - expected).abs() / expected.abs();
    assert!(error <= relative, "{actual} for {expected}: {error:e}");
}

/// δ(U, U̇, Ü) by the primitives from the analytic matrices, and by δR = ∂R/∂p δp +
/// ∂R/∂(U, U̇, Ü) δ(U, U̇, Ü) the forces'.
struct Analytic {
    motion: DMatrix<f64>,
    direct: DMatrix<f64>,
    through: DMatrix<f64>,
}

fn analytic() -> Analytic {
    let loops = loops();
    let unknowns = loops.solve(&[0.6, 1.7], &inputs()).unwrap();
    let found = loops.sensitivities(&unknowns, &inputs()).unwrap();
    let mut motion = DMatrix::zeros(6, MEANS.len());
    motion
        .view_mut((0, 0), (2, KINEMATIC))
        .copy_from(&found.value);
    motion
        .view_mut((2, 0), (2, KINEMATIC))
        .copy_from(&found.rate);
    motion
        .view_mut((4, 0), (2, KINEMATIC))
        .copy_from(&found.acceleration);
    let mut point = MEANS.to_vec();
    point.extend(
        unknowns
            .value
            .iter()
            .chain(&unknowns.rate)
            .chain(&unknowns.acceleration),
    );
    let partial = sensitivities(&Forces, &point).unwrap();
    Analytic {
        motion,
        direct: partial.columns(0, MEANS.len()).into_owned(),
        through: partial.columns(MEANS.len(), 6).into_owned(),
    }
}

#[test]
fn nominal_motion_and_forces() {
    let results = FourBar.evaluate(&MEANS).unwrap();
    let expected = [
        0.596_524_7,
        1.729_203_9,
        -5.428_687_54,
        2.640_055_85,
        106.8475,
        204.4018,
        -20.284_93,
        -15.170_60,
        -18.345_51,
        -12.726_62,
        -5.174_20,
        -5.511_00,
        -3.633_41,
        3.794_34,
        0.645_954,
    ];
    for (actual, expected) in results.iter().zip(expected) {
        assert_close(*actual, expected, 1e-6);
    }
    let unknowns = loops().solve(&[0.6, 1.7], &inputs()).unwrap();
    let by_loops = unknowns
        .value
        .iter()
        .chain(&unknowns.rate)
        .chain(&unknowns.acceleration);
    for (by_loops, by_dyad) in by_loops.zip(&results) {
        assert_close(*by_loops, *by_dyad, 1e-12);
    }
}

#[test]
fn analytic_matrices_equal_automatic_differentiation() {
    let by_dual_numbers = sensitivities(&FourBar, &MEANS).unwrap();
    let Analytic {
        motion,
        direct,
        through,
    } = analytic();
    let scale = |m: &DMatrix<f64>| m.amax();
    let difference = (by_dual_numbers.rows(0, 6) - &motion).amax();
    assert!(difference < 1e-12 * scale(&motion), "{difference:e}");
    let torque_and_forces = direct + through * motion;
    let difference = (by_dual_numbers.rows(6, 9) - &torque_and_forces).amax();
    assert!(
        difference < 1e-10 * scale(&torque_and_forces),
        "{difference:e}"
    );
}

#[test]
fn first_order_standard_deviations() {
    let t = sensitivities(&FourBar, &MEANS).unwrap();
    let scatter = Scatter::propagate(&t, &primitives());
    let deviations = scatter.deviations();
    assert_close(deviations[0], 5.7481e-4, 1e-4);
    assert_close(deviations[1], 7.7263e-4, 1e-4);
    assert_close(deviations[14], 0.028_125, 1e-4);
    assert_close(deviations[6], 0.839_95, 1e-4);
    let shares: f64 = scatter.shares(14).iter().sum();
    assert_close(shares, 1.0, 1e-12);
}

#[test]
fn independent_motions_give_the_wrong_torque() {
    // The paper's warning: δU, δU̇, δÜ taken as independent of each other and of δV….
    let Analytic {
        motion,
        direct,
        through,
    } = analytic();
    let scatter = Scatter::propagate(&motion, &primitives());
    let independent: f64 = (0..6)
        .map(|i| through[(8, i)].powi(2) * scatter.covariance[(i, i)])
        .sum();
    let direct = Scatter::propagate(&direct, &primitives()).covariance[(8, 8)];
    let wrong = (independent + direct).sqrt();
    assert_close(wrong, 0.0190, 5e-3);
}

#[test]
fn without_the_terms_that_the_paper_omits_forces_err_by_55_percent() {
    let Analytic {
        motion,
        direct,
        through,
    } = analytic();
    let whole = &direct + &through * &motion;
    // Π_V̇ δV̇ and Π_V̈ δV̈: the columns of V̇ and V̈ in the direct part.
    let mut omitting = direct;
    omitting.columns_mut(1, 2).fill(0.0);
    let omitting = omitting + through * motion;
    let by_speed = |m: &DMatrix<f64>| m.column(1).into_owned();
    let error = (by_speed(&omitting) - by_speed(&whole)).amax() / by_speed(&whole).amax();
    assert_close(error, 0.55, 1e-3);
    let torque = |t: &DMatrix<f64>| Scatter::propagate(t, &primitives()).deviations()[8];
    assert_close(torque(&whole), 0.028_125, 1e-4);
    assert_close(torque(&omitting), 0.020_252, 1e-4);
}
