//! Synthesis against known optima, and proofs against what samples miss.

use fivebar_design::Noise;
use fivebar_design::accuracy::five_bar::{ArmTolerance, TolerancedArm, ToolState, analyse};
use fivebar_design::synthesis::{
    Area, Design, Measure, Objective, Proof, Specification, Stock, Synthesis, Tolerance, prove,
    synthesise,
};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use nalgebra::Vector2;

/// A symmetric coaxial arm with links of 1 m in all.
fn leg(area: Area, dexterity: f64) -> Specification {
    Specification {
        symmetric: true,
        base: [0.0, 0.0],
        link_sum: 1.0,
        area,
        dexterity,
        sine: 0.0,
        cranks: None,
        stock: Stock::default(),
        payload: None,
        tolerance: Tolerance::default(),
        objective: Objective::Size,
        front: 1,
        starts: 1,
    }
}

fn solve(specification: &Specification) -> Synthesis {
    synthesise(specification, 1, &|_| {}).unwrap()
}

#[track_caller]
fn assert_near(what: &str, found: f64, known: f64, share: f64) {
    let bound = share * known.abs();
    assert!(
        (found - known).abs() <= bound,
        "{what}: {found} for {known}"
    );
}

#[test]
fn the_widest_ring_of_a_coaxial_arm_is_that_of_the_closed_form() {
    for (k, crank, coupler, width) in [
        (0.35, 0.4856, 0.5144, 0.9097),
        (0.5, 0.4721, 0.5279, 0.8178),
    ] {
        let answer = solve(&leg(Area::Annulus, k));
        let best = answer.best;
        assert_near("width", best.size, width, 1e-3);
        assert_near("crank", best.lengths[0], crank, 1e-2);
        assert_near("coupler", best.lengths[1], coupler, 1e-2);
        assert_near("dexterity", best.dexterity, k, 1e-6);
        assert_near("sum", best.link_sum(), 1.0, 1e-9);
        let angle = k.atan();
        let inner = coupler * (angle.cos() - (2.0 * angle).cos().sqrt());
        assert_near("inner radius", best.place[1], inner, 2e-2);
        assert_eq!(answer.proof, Proof::Proved);
    }
}

#[test]
fn the_largest_square_of_a_coaxial_arm_is_known_and_a_base_does_not_enlarge_it() {
    let square = Area::Rectangle { aspect: 1.0 };
    let coaxial = solve(&leg(square.clone(), 0.4));
    assert_near("side", coaxial.best.size, 0.793, 1e-3);
    assert_eq!(coaxial.proof, Proof::Proved);
    let free = Specification {
        base: [0.0, 0.6],
        ..leg(square, 0.4)
    };
    let free = solve(&free).best;
    assert_near("side", free.size, 0.793, 3e-3);
    assert!(free.lengths[4] < 1e-3, "{free:?}");
}

/// Dexterity, and of the shortest known arm for a rectangle sum, crank, coupler and height of the place [m].
const SHORTEST: [(f64, f64, f64, f64, f64); 2] = [
    (0.3, 184.24e-3, 69.58e-3, 94.66e-3, 30.11e-3),
    (0.7, 263.08e-3, 96.07e-3, 147.01e-3, 74.24e-3),
];

#[test]
fn the_shortest_arm_for_a_rectangle_is_as_short_as_the_best_known() {
    are_as_short(&SHORTEST[1..]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_rectangles_with_the_shortest_known_arms() {
    are_as_short(&SHORTEST);
}

fn are_as_short(arms: &[(f64, f64, f64, f64, f64)]) {
    for &(k, known, crank, coupler, y0) in arms {
        let specification = Specification {
            base: [0.04, 0.3],
            link_sum: f64::INFINITY,
            objective: Objective::LinkSum(0.15),
            ..leg(Area::Rectangle { aspect: 1.5 }, k)
        };
        let answer = solve(&specification);
        let best = answer.best;
        assert_near("sum", best.link_sum(), known, 2e-3);
        assert_near("crank", best.lengths[0], crank, 2e-2);
        assert_near("coupler", best.lengths[1], coupler, 2e-2);
        assert_near("y0", best.place[1], y0, 4e-2);
        assert_eq!(best.lengths[4], 0.04);
        assert_eq!(answer.proof, Proof::Proved);
        // Whole millimetres cost 3 mm at most.
        let whole = answer.stock;
        for length in whole.lengths {
            assert!(
                (1e3 * length - (1e3 * length).round()).abs() < 1e-9,
                "{whole:?}"
            );
        }
        assert!(
            whole.link_sum() < known + 3e-3 && whole.dexterity >= k,
            "{whole:?}"
        );
        assert_eq!(answer.stock_proof, Proof::Proved);
        assert!(answer.sensitivity.iter().all(|loss| *loss > 0.0));
    }
}

#[test]
fn whole_millimetres_meet_the_requirements_too() {
    meet_in_whole_millimetres(&[0.5]);
}

#[test]
#[ignore = "ten seconds: ./ci.sh tables"]
fn whole_table_of_requirements_that_whole_millimetres_meet() {
    meet_in_whole_millimetres(&[0.35, 0.5, 0.65]);
}

fn meet_in_whole_millimetres(dexterities: &[f64]) {
    for &k in dexterities {
        let answer = solve(&Specification {
            base: [0.04, 0.1],
            link_sum: f64::INFINITY,
            objective: Objective::LinkSum(0.05),
            ..leg(Area::Rectangle { aspect: 1.0 }, k)
        });
        let (best, whole) = (answer.best, answer.stock);
        assert!(whole.dexterity >= k, "{whole:?}");
        assert!(whole.link_sum() < best.link_sum() + 5e-3, "{whole:?}");
    }
}

#[test]
fn an_arm_with_unlike_legs_is_not_worse_than_a_symmetric_one() {
    let square = Area::Rectangle { aspect: 1.0 };
    let specification = Specification {
        symmetric: false,
        ..leg(square, 0.4)
    };
    let best = solve(&specification).best;
    assert!(best.size > 0.99 * 0.793, "{best:?}");
    assert!(best.link_sum() < 1.0 + 1e-9 && best.dexterity >= 0.4 - 1e-9);
}

#[test]
fn points_are_all_reached_with_the_wanted_condition() {
    let corners = vec![
        vec![[0.0, 0.0]],
        vec![[2.0, 0.0]],
        vec![[2.0, 2.0]],
        vec![[0.0, 2.0]],
    ];
    let points = Area::paths(&corners).unwrap();
    let best = solve(&leg(points, 0.4)).best;
    // Its corners alone ask less than the square.
    assert!(best.size >= 0.79, "{best:?}");
    assert_near("dexterity", best.dexterity, 0.4, 1e-6);
}

#[test]
fn what_no_arm_can_do_is_refused() {
    let specification = Specification {
        link_sum: 0.1,
        objective: Objective::LinkSum(0.15),
        ..leg(Area::Rectangle { aspect: 1.0 }, 0.3)
    };
    assert!(synthesise(&specification, 1, &|_| {}).is_err());
}

#[test]
fn the_answer_is_that_of_the_seed() {
    let specification = leg(Area::Annulus, 0.5);
    assert_eq!(solve(&specification), solve(&specification));
}

/// Whether 1e5 random points of a rectangle show no singularity of the arm, elbows out.
fn samples_see_nothing(lengths: [f64; 5], [x, y]: [f64; 2], [width, height]: [f64; 2]) -> bool {
    let geometry = Geometry::new(lengths).unwrap();
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let mut noise = Noise::new(5);
    let mut assembly = None;
    (0..100_000).all(|_| {
        let c = Vector2::new(
            0.5 * lengths[4] + x + width * (noise.uniform() - 0.5),
            y + height * noise.uniform(),
        );
        let Ok(pose) = geometry.inverse(c, mode) else {
            return false;
        };
        *assembly.get_or_insert(pose.assembly()) == pose.assembly()
    })
}

#[test]
fn singularities_that_a_hundred_thousand_samples_miss_are_refuted() {
    // A corner 1 µm beyond a straight leg, on the axis of a coaxial arm's square.
    let leg = [0.1, 0.16, 0.16, 0.1, 0.0];
    let side = 0.08;
    let rim: f64 = 0.26;
    let beyond = (rim + 1e-6).powi(2) - 0.25 * side * side;
    // A hole of 10 µm about the hip, into which a leg does not fold.
    let folded = [0.1, 0.10001, 0.10001, 0.1, 0.0];
    // The arm changes its assembly mode within 10 nm of the lower side, where links 2 and 3 are in line.
    let flat = [0.1, 0.16, 0.16, 0.1, 0.3];
    let line = y_of_links_in_line(flat);
    for (what, lengths, place, size) in [
        ("straight", leg, [0.0, beyond.sqrt() - side], [side, side]),
        ("folded", folded, [0.0131, -0.0217], [0.05, 0.05]),
        ("in line", flat, [0.0, line - 1e-8], [0.02, 0.02]),
    ] {
        assert!(samples_see_nothing(lengths, place, size), "{what}");
        let proof = prove(
            lengths,
            &Area::Rectangle {
                aspect: size[0] / size[1],
            },
            size[0],
            place,
        );
        assert!(matches!(proof, Proof::Refuted(_)), "{what}: {proof:?}");
    }
}

/// The height at which links 2 and 3 of a symmetric arm are in line, C being on its axis [m].
fn y_of_links_in_line([l1, l2, _, _, base]: [f64; 5]) -> f64 {
    (l1 * l1 - (0.5 * base - l2).powi(2)).sqrt()
}

#[test]
fn a_regular_area_is_proved_and_a_touching_one_is_not() {
    let arm = [0.1, 0.16, 0.16, 0.1, 0.08];
    let square = Area::Rectangle { aspect: 1.0 };
    assert_eq!(prove(arm, &square, 0.05, [0.0, 0.14]), Proof::Proved);
    // The upper corners of this one are on the rim itself, in part beyond it by rounding.
    let leg = [0.1, 0.16, 0.16, 0.1, 0.0];
    let touching = prove(
        leg,
        &square,
        0.1,
        [0.0, (0.26_f64.powi(2) - 0.0025).sqrt() - 0.1],
    );
    assert_ne!(touching, Proof::Proved);
}

/// Tolerances of a good workshop.
const TOLERANCE: Tolerance = Tolerance {
    length: 5e-5,
    angle: 2e-4,
};

/// The best worst point over a ring, of coaxial arms on a grid of cranks, sums and inner radii, with the
/// Jacobian of the kinematics. A ring about coaxial cranks is the same in all directions.
fn best_on_a_grid(
    k: f64,
    width: f64,
    most: f64,
    merit: impl Fn(Vector2<f64>, &Geometry<f64>) -> Option<[f64; 2]>,
) -> f64 {
    let mut best = f64::NEG_INFINITY;
    for sum in (20..=100).map(|i| most * f64::from(i) / 100.0) {
        for crank in (30..=70).map(|i| sum * f64::from(i) / 100.0) {
            let geometry = Geometry::new([crank, sum - crank, sum - crank, crank, 0.0]).unwrap();
            let along: Vec<_> = (0..200)
                .map(|i| merit(Vector2::new(0.0, sum * f64::from(i) / 200.0), &geometry))
                .collect();
            let span = (width / sum * 200.0).ceil() as usize;
            for ring in along.windows(span + 1) {
                let worst = ring.iter().try_fold(f64::INFINITY, |worst, at| {
                    at.filter(|[dexterity, _]| *dexterity >= k)
                        .map(|[_, merit]| worst.min(merit))
                });
                best = best.max(worst.unwrap_or(f64::NEG_INFINITY));
            }
        }
    }
    best
}

#[test]
fn the_best_arms_by_torque_speed_and_stiffness_are_not_beaten_by_a_grid() {
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let values = |c: Vector2<f64>, geometry: &Geometry<f64>| {
        let pose = geometry.inverse(c, mode).ok()?;
        let jacobian = geometry.jacobian(&pose).ok()?;
        let matrix = jacobian.matrix();
        let inverse = matrix.try_inverse()?;
        let torque = matrix.column(0).norm().max(matrix.column(1).norm());
        let speed = 1.0 / inverse.row(0).norm().max(inverse.row(1).norm());
        let stiffness = jacobian.singular_values().map(|s| s.powi(-2));
        Some((
            jacobian.inverse_condition(),
            [-torque, speed, stiffness[0].min(stiffness[1])],
        ))
    };
    for (index, measure) in [Measure::Torque, Measure::Speed, Measure::Stiffness]
        .into_iter()
        .enumerate()
    {
        let answer = solve(&Specification {
            objective: Objective::Measure(measure, 0.2),
            ..leg(Area::Annulus, 0.4)
        });
        let best = answer.best;
        let found = [
            -best.measures.torque,
            best.measures.speed,
            best.measures.stiffness,
        ][index];
        let grid = best_on_a_grid(0.4, 0.2, 1.0, |c, geometry| {
            let (dexterity, values) = values(c, geometry)?;
            Some([dexterity, values[index]])
        });
        println!("{measure:?} {found} {grid} {best:?}");
        // The grid's rings are wider by less than one of its steps, and some of its points are at the optimum.
        assert!(
            found >= grid - 1e-9 && found <= grid + 0.05 * grid.abs(),
            "{measure:?}: {found}, {grid}"
        );
        assert!(
            best.dexterity >= 0.4 && answer.stock.dexterity >= 0.4,
            "{answer:?}"
        );
        assert_eq!(answer.proof, Proof::Proved);
    }
}

/// 1/κ, torque, speed, stiffness and error of an arm, elbows out, with C at a point from A, by the kinematics and by
/// the analysis of accuracy.
fn by_the_analyses(lengths: [f64; 5], c: Vector2<f64>) -> Option<[f64; 5]> {
    let geometry = Geometry::new(lengths).ok()?;
    let working_mode = WorkingMode::new(Side::Right, Side::Left);
    let pose = geometry.inverse(c, working_mode).ok()?;
    let jacobian = geometry.jacobian(&pose).ok()?;
    let matrix = jacobian.matrix();
    let inverse = matrix.try_inverse()?;
    let arm = TolerancedArm {
        geometry: &geometry,
        arm: None,
        working_mode,
        tolerance: &ArmTolerance {
            length_sd: [TOLERANCE.length; 5],
            input_sd: [TOLERANCE.angle; 2],
            ..ArmTolerance::default()
        },
    };
    let [one, other] = jacobian.singular_values();
    Some([
        jacobian.inverse_condition(),
        matrix.column(0).norm().max(matrix.column(1).norm()),
        1.0 / inverse.row(0).norm().max(inverse.row(1).norm()),
        one.max(other).powi(-2),
        analyse(&arm, &ToolState::at_rest(c))
            .ok()?
            .radial_deviation(),
    ])
}

/// Each figure of a design, where it is, and +1 where the least is the worst.
fn figures(design: &Design) -> [(f64, [f64; 2], f64); 5] {
    let (measures, worst) = (design.measures, design.worst_points);
    [
        (design.dexterity, worst.dexterity, 1.0),
        (measures.torque, worst.torque, -1.0),
        (measures.speed, worst.speed, 1.0),
        (measures.stiffness, worst.stiffness, 1.0),
        (measures.error, worst.error, -1.0),
    ]
}

/// An arm with unlike legs for a rectangle, one for a drawing whose worst points lie between its corners, and a ring.
fn designs() -> Vec<(Synthesis, Area)> {
    let rectangle = Area::Rectangle { aspect: 1.5 };
    let triangle = [[0.0, 0.0], [3.0, 0.2], [1.0, 2.0], [0.0, 0.0]];
    let drawing = Area::paths(&[triangle.to_vec(), vec![[2.5, 1.5]]]).unwrap();
    let sought = [Measure::Stiffness, Measure::Error, Measure::Torque];
    let areas = [rectangle, drawing, Area::Annulus].into_iter().zip(sought);
    let solved = areas.map(|(area, measure)| {
        let is_ring = area == Area::Annulus;
        let specification = Specification {
            symmetric: is_ring,
            base: if is_ring { [0.0; 2] } else { [0.04, 0.2] },
            link_sum: 0.5,
            tolerance: TOLERANCE,
            objective: Objective::Measure(measure, 0.15),
            ..leg(area.clone(), 0.3)
        };
        (solve(&specification), area)
    });
    solved.collect()
}

#[test]
fn each_figure_is_that_of_the_analyses_at_its_worst_point() {
    for (answer, _) in designs() {
        for design in [answer.best, answer.stock] {
            for (index, (found, at, _)) in figures(&design).into_iter().enumerate() {
                let known = by_the_analyses(design.lengths, at.into()).unwrap()[index];
                assert_near(&format!("figure {index} of {design:?}"), found, known, 1e-9);
            }
        }
    }
}

#[test]
fn no_point_of_a_fine_grid_is_worse_than_the_worst_point() {
    for (answer, area) in designs() {
        let design = answer.best;
        let [x, y] = design.place;
        let from_place = |u: f64, v: f64| {
            Vector2::new(
                0.5 * design.lengths[4] + x + design.size * u,
                y + design.size * v,
            )
        };
        let shares = || (0..=600).map(|i| f64::from(i) / 600.0);
        let points: Vec<_> = match &area {
            Area::Rectangle { aspect } => shares()
                .flat_map(|u| shares().map(move |v| [u - 0.5, v]))
                .map(|[u, v]| from_place(u, v / aspect))
                .collect(),
            Area::Paths(paths) => paths
                .iter()
                .flat_map(|path| path.windows(2))
                .flat_map(|ends| {
                    let along =
                        |axis: usize, t| ends[0][axis] + t * (ends[1][axis] - ends[0][axis]);
                    shares().map(move |t| [along(0, t), along(1, t)])
                })
                .map(|[u, v]| from_place(u, v))
                .collect(),
            // All directions are alike.
            _ => shares()
                .map(|u| Vector2::new(0.0, y + design.size * u))
                .collect(),
        };
        let mut worst = [f64::INFINITY; 5];
        for point in points {
            let here = by_the_analyses(design.lengths, point).unwrap();
            for (index, (_, _, sign)) in figures(&design).into_iter().enumerate() {
                worst[index] = worst[index].min(sign * here[index]);
            }
        }
        for (worst, (found, _, sign)) in worst.into_iter().zip(figures(&design)) {
            println!("{:.9} {found:.9}", sign * worst);
            assert!(
                sign * found <= worst + 1e-9 * worst.abs(),
                "{found} {worst}"
            );
        }
    }
}

#[test]
fn a_least_sine_alone_keeps_singularities_out() {
    let answer = solve(&Specification {
        dexterity: 0.0,
        sine: 0.4,
        ..leg(Area::Annulus, 0.0)
    });
    assert_eq!(answer.proof, Proof::Proved);
    assert!(
        answer.best.dexterity > 0.1 && answer.best.size > 0.5,
        "{:?}",
        answer.best
    );
}

#[test]
fn an_arm_of_least_error_errs_less_than_the_shortest_one() {
    let rectangle = |objective| {
        solve(&Specification {
            base: [0.04, 0.3],
            link_sum: 0.4,
            tolerance: TOLERANCE,
            objective,
            ..leg(Area::Rectangle { aspect: 1.5 }, 0.3)
        })
        .best
    };
    let shortest = rectangle(Objective::LinkSum(0.15));
    let best = rectangle(Objective::Measure(Measure::Error, 0.15));
    let [less, more] = [best, shortest].map(|design| design.measures.error);
    assert!(
        less < 0.8 * more && less > TOLERANCE.length,
        "{less} {more}"
    );
}
