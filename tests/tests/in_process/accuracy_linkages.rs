//! Linkages with wrong numbers and loose pins: the analytic matrices against dual numbers
//! against differences, on every linkage that comes with the program.

use fivebar_design::accuracy::dyad_loops::{time_derivatives, unknowns};
use fivebar_design::accuracy::linkage::{LinkageAccuracyModel, ResultKind, clearance_equilibrium};
use fivebar_design::accuracy::loops::VectorLoops;
use fivebar_design::accuracy::slider::{self, sample_slider};
use fivebar_design::accuracy::{DifferentiableModel, Sampling, sensitivities};
use fivebar_design::linkage::{
    Clearance, Coordinate, DriveLaw, Linkage, ParameterKind, SolveError,
};
use fivebar_design::slider::{Geometry, WorkingMode};
use fivebar_files::linkage::{DrivenLinkage, EXAMPLES, Example};
use fivebar_files::robot::SliderRobot;
use fivebar_kinematics::Scalar;
use fivebar_report::study::accuracy::{analyse_slider, slider_answer};
use nalgebra::Vector2;
use serde_json::Value;

/// The example with every pin off its centre, each in another direction.
fn loose(driven: &DrivenLinkage) -> Linkage<f64> {
    let mut linkage = driven.linkage.clone();
    let pins: Vec<bool> = linkage.pins().collect();
    for (joint, _) in pins.iter().enumerate().filter(|(_, pin)| **pin) {
        let clearance = Clearance {
            radius: 1e-3 * (1.0 + 0.3 * joint as f64),
            angle: 0.7 - 1.1 * joint as f64,
        };
        linkage.set_clearance(joint, clearance).unwrap();
    }
    linkage
}

/// The driving coordinates at some instants of the sweep, away from special positions.
fn instants(driven: &DrivenLinkage) -> Vec<Vec<Coordinate<f64>>> {
    let at = |share: f64| {
        driven
            .laws
            .iter()
            .map(|law: &DriveLaw| law.at(share * driven.duration))
            .collect()
    };
    [0.03, 0.17, 0.41, 0.68, 0.93].map(at).into()
}

/// U, U̇ and Ü by the inputs and all parameters.
struct Unknowns<'a>(&'a Linkage<f64>);

impl DifferentiableModel for Unknowns<'_> {
    type Error = SolveError;

    fn evaluate<S: Scalar>(&self, primitives: &[S]) -> Result<Vec<S>, SolveError> {
        let n = self.0.degrees_of_freedom();
        let input = |i: usize| Coordinate {
            value: primitives[i],
            rate: primitives[n + i],
            acceleration: primitives[2 * n + i],
        };
        let inputs: Vec<_> = (0..n).map(input).collect();
        let mut parameters = primitives[3 * n..].iter();
        let linkage = self.0.map_parameters(|_, _| *parameters.next().unwrap());
        let found = unknowns(&linkage, &linkage.motion(&inputs)?);
        let parts: [fn(&Coordinate<S>) -> S; 3] = [|c| c.value, |c| c.rate, |c| c.acceleration];
        Ok(parts
            .iter()
            .flat_map(|part| found.iter().map(part))
            .collect())
    }
}

fn all_parameters(linkage: &Linkage<f64>) -> Vec<f64> {
    let mut values = Vec::new();
    linkage.map_parameters(|_, value: f64| {
        values.push(value);
        value
    });
    values
}

#[test]
fn analytic_matrices_equal_dual_numbers_on_every_example() {
    for example in EXAMPLES {
        let driven = example.linkage().unwrap();
        let linkage = loose(&driven);
        let loops = VectorLoops::from_linkage(&linkage).unwrap();
        assert_eq!(loops.parameters, all_parameters(&linkage));
        for inputs in instants(&driven) {
            let motion = linkage.motion(&inputs).unwrap();
            let guess = time_derivatives(&unknowns(&linkage, &motion));
            let driving = time_derivatives(&inputs);
            // The loops close where the dyads do, and move as they do.
            let solved = loops.solve(guess.value.as_slice(), &driving).unwrap();
            for (a, b, scale) in [
                (&solved.value, &guess.value, 1.0),
                (&solved.rate, &guess.rate, 1.0 + guess.rate.amax()),
                (
                    &solved.acceleration,
                    &guess.acceleration,
                    1.0 + guess.acceleration.amax(),
                ),
            ] {
                assert!((a - b).amax() < 1e-11 * scale, "{}", example.name);
            }

            let analytic = loops.sensitivities(&solved, &driving).unwrap();
            let model = Unknowns(&linkage);
            let mut primitives: Vec<f64> = driving.value.as_slice().to_vec();
            primitives.extend(&driving.rate);
            primitives.extend(&driving.acceleration);
            primitives.extend(&loops.parameters);
            let dual = sensitivities(&model, &primitives).unwrap();
            let n = solved.value.len();
            for (k, matrix) in [analytic.value, analytic.rate, analytic.acceleration]
                .iter()
                .enumerate()
            {
                let dual = dual.rows(k * n, n);
                let error = (matrix - dual).amax();
                assert!(matrix.amax() > 0.0);
                assert!(
                    error < 1e-10 * matrix.amax(),
                    "{} {k}: {error:e} of {}",
                    example.name,
                    matrix.amax()
                );
            }
        }
    }
}

#[test]
fn every_derivative_of_every_example_meets_its_difference() {
    for example in EXAMPLES {
        let driven = example.linkage().unwrap();
        let linkage = loose(&driven);
        let mut varied = Vec::new();
        let mut number = 0;
        linkage.map_parameters(|parameter, value: f64| {
            // With a mass of zero there is no inertia to scale, and a mass below zero is invalid.
            let nothing = parameter.kind == ParameterKind::Mass && value == 0.0;
            if !nothing && parameter.kind != ParameterKind::Inertia {
                varied.push(number);
            }
            number += 1;
            value
        });
        let model = LinkageAccuracyModel {
            linkage: &linkage,
            varied,
        };
        for inputs in instants(&driven).iter().step_by(2) {
            let nominal = model.primitives(inputs);
            let value = model.evaluate(&nominal).unwrap();
            assert_eq!(value.len(), model.result_kinds().len());
            let t = sensitivities(&model, &nominal).unwrap();
            let mut seen = vec![false; value.len()];
            for column in 0..nominal.len() {
                let step = 1e-6 * nominal[column].abs().max(0.05);
                let moved = |by: f64| {
                    let mut primitives = nominal.clone();
                    primitives[column] += by;
                    model.evaluate(&primitives).unwrap()
                };
                let (up, down) = (moved(step), moved(-step));
                for row in 0..value.len() {
                    let difference = (up[row] - down[row]) / (2.0 * step);
                    let rounding = 1e-9 * value[row].abs() / step * 1e-4;
                    let scale = t.column(column).amax().max(t.row(row).amax());
                    let bound = 2e-5 * scale + rounding + 1e-6;
                    let derivative = t[(row, column)];
                    assert!(
                        (difference - derivative).abs() < bound,
                        "{}: result {row} by {column}: {derivative} for {difference}",
                        example.name
                    );
                    seen[row] |= derivative != 0.0;
                }
            }
            for ((result, seen), value) in model.result_kinds().iter().zip(seen).zip(value) {
                let force = matches!(result, ResultKind::Drive(_) | ResultKind::Force(..));
                assert!(
                    seen || !force || value.abs() < 1e-9,
                    "{}: {result:?} answers to nothing",
                    example.name
                );
            }
        }
    }
}

#[test]
fn forces_in_loose_pins_balance_the_power_of_the_drive() {
    // Without inertia and with one load, the work of the load and the work of the drive differ
    // only by the moments of the pins' offsets, which are left out: second order in r.
    let driven = EXAMPLES[0].linkage().unwrap();
    let inputs = &instants(&driven)[1];
    let drive = |scale: f64| {
        let mut linkage = driven.linkage.clone();
        for joint in 0..4 {
            let clearance = Clearance {
                radius: scale * 1e-4,
                angle: 0.4 + joint as f64,
            };
            linkage.set_clearance(joint, clearance).unwrap();
        }
        let motion = linkage.motion(inputs).unwrap();
        linkage.forces(&motion).unwrap().driving[0]
    };
    let (ideal, one, two) = (drive(0.0), drive(1.0), drive(2.0));
    assert_eq!(
        ideal,
        driven
            .linkage
            .forces(&driven.linkage.motion(inputs).unwrap())
            .unwrap()
            .driving[0]
    );
    assert!((one - ideal).abs() > 1e-6 * ideal.abs());
    assert!(((two - ideal) / (one - ideal) - 2.0).abs() < 0.02);
}

#[test]
fn tension_lengthens_and_compression_shortens_a_limb_by_its_clearances() {
    let driven = Example::find("prrrp").unwrap().linkage().unwrap();
    let mut massless = driven
        .linkage
        .map_parameters(|parameter, value| match parameter.kind {
            ParameterKind::Mass | ParameterKind::Inertia | ParameterKind::Gravity(_) => 0.0,
            _ => value,
        });
    let inputs = &instants(&driven)[0];
    let points = massless.points().iter();
    let name = |wanted: &str| {
        points
            .clone()
            .position(|point| point.name == wanted)
            .unwrap()
    };
    let (left, right, tip) = (name("L"), name("R"), name("P"));
    let id = massless.elements()[2].inner_pin().unwrap();
    // Left pin, middle pin, right pin: the middle one counts for the right bar, as P is the
    // left bar's.
    let radii = [0.0, 0.0, 1e-5, 2e-5, 4e-5];
    for sign in [1.0, -1.0] {
        let force = Vector2::new(0.0, 10.0 * sign);
        massless.set_load(id, 0.0, force).unwrap();
        let equilibrium = clearance_equilibrium(&massless, inputs, &radii).unwrap();
        assert!(equilibrium.converged);
        let at = |point: usize| equilibrium.motion.points[point].position;
        let longer_left = (at(tip) - at(left)).norm() - 1.2;
        let longer_right = (at(tip) - at(right)).norm() - 1.1;
        assert!((longer_left - sign * 1e-5).abs() < 1e-9, "{longer_left:e}");
        assert!(
            (longer_right - sign * 6e-5).abs() < 1e-9,
            "{longer_right:e}"
        );
    }
}

/// l3 1.2, l7 1.1, l5 .6 m.
const SLIDER: &str = include_str!("../../../host/files/robots/slider.toml");

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap().iter();
    list.map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn the_slider_driven_test_case_by_its_corrected_coefficients_and_by_samples() {
    let robot = SliderRobot::parse("slider.toml", SLIDER).unwrap();
    let at = Vector2::new(0.1, 0.66);
    let analysis = analyse_slider(&robot, at, Vector2::new(3.0, -10.0)).unwrap();
    // Tu's coefficients, corrected: with the sliders as inputs ∂P/∂l3 = (sin α7, −cos α7)/S.
    let [alpha3, alpha7] = analysis.pose.angles();
    let s = (alpha7 - alpha3).sin();
    let by_l3 = Vector2::new(alpha7.sin() / s, -alpha7.cos() / s);
    assert!((analysis.transfer.l3 - by_l3).norm() < 1e-12);
    assert!(
        (analysis.transfer.l3.x - alpha3.cos()).abs() > 0.05,
        "not as printed"
    );

    let sampling = Sampling {
        samples: 40_000,
        seed: 3,
    };
    let sampled = sample_slider(&robot.toleranced(), &analysis, sampling, &|_| ());
    let found = slider_answer(&robot, &analysis, &sampled);
    let twins = &found["monte_carlo"];
    let error = 4.0 * twins["relative_error_of_sd"].as_f64().unwrap();
    for (a, s) in numbers(&found["position_sd_m"])
        .into_iter()
        .zip(numbers(&twins["position_sd_m"]))
    {
        assert!(a > 1e-6 && (a - s).abs() < error * a, "{a} and {s}");
    }
    let pair = |key: &str| (found[key].as_f64().unwrap(), twins[key].as_f64().unwrap());
    let (rms, twin) = pair("clearance_rms_m");
    assert!((rms - twin).abs() < error * rms);
    for key in ["input_worst_m", "clearance_worst_m"] {
        let (worst, largest) = pair(key);
        assert!(
            largest <= worst * (1.0 + 1e-9) && largest > 0.8 * worst,
            "{key}"
        );
    }
    let seated = analysis.equilibrium.displacement.norm();
    assert!(analysis.equilibrium.converged && seated <= analysis.clearance.worst * (1.0 + 1e-9));
}

#[test]
fn tension_lengthens_the_sliders_limbs_as_it_does_the_linkages() {
    // PRRRP in two ways: by its transfer coefficients, and as a linkage of massless bars.
    let driven = Example::find("prrrp").unwrap().linkage().unwrap();
    let mut massless = driven
        .linkage
        .map_parameters(|parameter, value| match parameter.kind {
            ParameterKind::Mass | ParameterKind::Inertia | ParameterKind::Gravity(_) => 0.0,
            _ => value,
        });
    let tip = massless.elements()[2].inner_pin().unwrap();
    let radii = [1e-5, 0.0, 2e-5, 4e-5];
    let geometry = Geometry::new(1.2, 1.1, 0.0).unwrap();
    for inputs in instants(&driven) {
        let pose = geometry
            .forward(
                inputs[0].value,
                inputs[1].value,
                fivebar_kinematics::five_bar::Side::Left,
            )
            .unwrap();
        assert_eq!(pose.working_mode(), WorkingMode::APART);
        for force in [[0.0, 10.0], [0.0, -10.0], [10.0, 0.0], [-10.0, 1.0]] {
            let force = Vector2::new(force[0], force[1]);
            let by_slider = slider::clearance_equilibrium(&geometry, &pose, force, radii).unwrap();
            let signs = by_slider.tension.map(f64::signum);
            for (longer, expected) in by_slider
                .longer
                .into_iter()
                .zip([signs[0] * 1e-5, signs[1] * 6e-5])
            {
                assert!((longer - expected).abs() < 1e-18);
            }
            massless.set_load(tip, 0.0, force).unwrap();
            // P is the left bar's point: the middle pin counts for the right limb.
            let equilibrium =
                clearance_equilibrium(&massless, &inputs, &[0.0, 0.0, 1e-5, 4e-5, 2e-5]).unwrap();
            assert!(by_slider.converged && equilibrium.converged);
            let displaced = equilibrium.motion.points[tip.index()].position - pose.p;
            // The linkage keeps the ideal arms, so its directions are those of a bar turned
            // by 1e-4: a difference of second order.
            let difference = (displaced - by_slider.displacement).norm();
            assert!(
                difference < 1e-3 * by_slider.displacement.norm(),
                "{difference:e}"
            );
        }
    }
}
