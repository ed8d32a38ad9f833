//! Crossings of a type 2 singularity against the reference's two.

use fivebar_design::crossing::{CrossingCondition, CrossingPlan};
use fivebar_files::robot::Robot;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use fivebar_report::study::crossing::plan;
use nalgebra::Vector2;
use serde_json::Value;

pub(crate) fn case(name: &str) -> Value {
    let text = include_str!("../../data/crossing.json");
    let all: Value = serde_json::from_str(text).unwrap();
    all["cases"][name].clone()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn pair(value: &Value) -> [f64; 2] {
    [number(&value[0]), number(&value[1])]
}

/// The robot file of a case; the benchtop arm's drives have the case's friction and rotors.
pub(crate) fn robot(case: &Value, extra: &str) -> Robot {
    let built_in = fivebar_files::robot::BuiltIn::find("benchtop")
        .unwrap()
        .text;
    let actuators = built_in.split("[[actuator]]").skip(1).take(2);
    let actuators = actuators.map(|text| text.split("[limits]").next().unwrap());
    let actuators: Vec<String> = actuators
        .map(|text| format!("[[actuator]]{text}"))
        .collect();
    let robot = &case["robot"];
    let lengths = &robot["link_lengths"];
    let mut text = format!(
        "name = \"case\"\ngravity = {}\nbase = {}\npayload = {}\nworking_mode = {}\n",
        robot["gravity"], lengths[4], robot["payload"], case["elbows"]
    );
    for k in 0..4 {
        text += &format!(
            "[[link]]\nlength = {}\nmass = {}\ncom = {}\ninertia = {}\n",
            lengths[k], robot["mass"][k], robot["com"][k], robot["inertia_about_com"][k]
        );
    }
    text += &actuators.concat();
    text += "[limits]\nmax_speed = [35.0, 35.0]\n";
    Robot::parse("case.toml", &(text + extra)).unwrap()
}

fn planned(case: &Value) -> CrossingPlan {
    let robot = robot(case, "[crossing]\nallowed = true\n");
    plan(
        &robot,
        [pair(&case["start"]), pair(&case["end"])],
        number(&case["tf"]),
    )
    .unwrap()
}

#[test]
fn the_crossings_are_the_reference_s() {
    for name in ["short", "pinched"] {
        let case = case(name);
        let found = planned(&case);
        let close = |found: f64, key: &str, tolerance: f64| {
            let expected = number(&case[key]);
            assert!(
                (found - expected).abs() < tolerance,
                "{name}: {key} {found}, {expected}"
            );
        };
        close(found.s_c, "s_c", 1e-9);
        close(found.t_c, "tc", 1e-9);
        close(found.s_dot_c, "s_dot_c", 1e-9);
        close(found.s_ddot_c, "s_ddot_c", 1e-9);
        close(found.condition.f0, "f0", 1e-9);
        let n = pair(&case["N"]);
        assert!((found.condition.n - Vector2::from(n)).norm() < 1e-9);
        assert!(found.value.abs() < 1e-9, "{name}: f = {}", found.value);
        assert_eq!(found.assembly, [Side::Left, Side::Right]);
        for (k, coefficient) in found.law.coefficients.iter().enumerate() {
            let expected = number(&case["polynomial_in_t_over_tf"][k]);
            assert!((coefficient - expected).abs() < 1e-8 * (1.0 + expected.abs()));
        }
        for (found, expected) in found.peak_torque.iter().zip(pair(&case["peak_torque"])) {
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "{name}: {found}, {expected} N·m"
            );
        }
    }
}

#[test]
fn the_torque_is_bounded_up_to_the_singularity_only_with_the_condition() {
    let case = case("short");
    let robot = robot(&case, "[crossing]\nallowed = true\n");
    let arm = robot.arm().unwrap();
    let plan = planned(&case);
    let (from, to) = (
        Vector2::from(pair(&case["start"])),
        Vector2::from(pair(&case["end"])),
    );
    let torque = |place: f64, s_ddot: f64| {
        let geometry = arm.geometry();
        let pose = geometry
            .inverse(from + (to - from) * place, robot.elbows)
            .unwrap();
        let velocities = geometry
            .inverse_velocities(&pose, (to - from) * plan.s_dot_c)
            .unwrap();
        let along = (to - from) * s_ddot;
        let accelerations = geometry
            .inverse_accelerations(&pose, &velocities, along)
            .unwrap();
        let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros());
        torque.unwrap()[0].abs()
    };
    for distance in [1e-3, 1e-4, 1e-5] {
        assert!(torque(plan.s_c + distance, plan.s_ddot_c) < 0.2);
    }
    // Without the acceleration that the condition asks for, it grows as 1/sin.
    assert!(torque(plan.s_c + 1e-6, 0.0) > 10.0);
}

#[test]
fn the_condition_is_where_the_joint_force_at_c_can_be_found() {
    // (1/l2)·(moment that turns link 2 about B) + (σ/l3)·(of link 3 about D), from accelerations.
    let case = case("pinched");
    let robot = &case["robot"];
    let lengths = [0, 1, 2, 3, 4].map(|k| number(&robot["link_lengths"][k]));
    let links = [0, 1, 2, 3].map(|k| Link {
        mass: number(&robot["mass"][k]),
        com: Vector2::from(pair(&robot["com"][k])),
        inertia: number(&robot["inertia_about_com"][k]),
    });
    let geometry = Geometry::new(lengths).unwrap();
    let gravity = Vector2::new(0.3, -9.81);
    let arm = Arm::new(geometry, links, 0.03, gravity, [0.0; 2]).unwrap();
    let state = &case["state_at_crossing"];
    let mode = WorkingMode::new(Side::Right, Side::Right);
    let pose = geometry
        .inverse(Vector2::from(pair(&state["c"])), mode)
        .unwrap();
    let velocity = Vector2::from(pair(&state["c_velocity"]));
    let velocities = geometry.inverse_velocities(&pose, velocity).unwrap();
    let condition = CrossingCondition::new(&arm, &pose, &velocities);
    for acceleration in [
        Vector2::new(0.0, 0.0),
        Vector2::new(7.0, -3.0),
        Vector2::new(-40.0, 90.0),
    ] {
        let accelerations = geometry
            .inverse_accelerations(&pose, &velocities, acceleration)
            .unwrap();
        let [alpha1, alpha2, alpha3, alpha4] = accelerations.alpha;
        let [omega1, _, _, omega4] = velocities.omega;
        let turned = |u: Vector2<f64>| Vector2::new(-u.y, u.x);
        let cross = |a: Vector2<f64>, b: Vector2<f64>| a.x * b.y - a.y * b.x;
        let end = |u: Vector2<f64>, l: f64, w: f64, a: f64| (turned(u) * a - u * (w * w)) * l;
        let b = end(pose.u1, lengths[0], omega1, alpha1);
        let d = end(pose.u4, lengths[3], omega4, alpha4);
        let plane = |h: Vector2<f64>, u: Vector2<f64>| u * h.x + turned(u) * h.y;
        let h2 = links[1].com * links[1].mass + Vector2::new(0.03 * lengths[1], 0.0);
        let h3 = links[2].com * links[2].mass;
        let second = |k: usize, m: f64, l: f64| {
            links[k].inertia + links[k].mass * links[k].com.norm_squared() + m * l * l
        };
        let f = (second(1, 0.03, lengths[1]) * alpha2 + cross(plane(h2, pose.u2), b - gravity))
            / lengths[1]
            + (second(2, 0.0, 0.0) * alpha3 + cross(plane(h3, pose.u3), d - gravity)) / lengths[2];
        let found = condition.value(acceleration);
        assert!(
            f.abs() > 1e-2 && (found - f).abs() < 1e-9 * (1.0 + f.abs()),
            "{found}, {f}"
        );
    }
}

#[test]
fn what_cannot_be_crossed_is_refused_with_the_reason() {
    let case = case("short");
    let ends = [pair(&case["start"]), pair(&case["end"])];
    let refusal = |extra: &str, ends: [[f64; 2]; 2], time: f64| {
        plan(&robot(&case, extra), ends, time)
            .unwrap_err()
            .to_string()
    };
    let allowed = "[crossing]\nallowed = true\n";
    assert!(refusal("", ends, 0.3).contains("does not allow crossings"));
    assert!(refusal("[crossing]\ndrag = 0.1\n", ends, 0.3).contains("does not allow crossings"));
    assert!(refusal(allowed, ends, 0.05).contains("N·m"));
    assert!(refusal(allowed, [[0.04, 0.1], [0.05, 0.11]], 0.3).contains("nothing to cross"));
    assert!(refusal(allowed, [ends[0], ends[0]], 0.3).contains("ends where it begins"));
    assert!(refusal(allowed, ends, f64::NAN).contains("positive and finite"));
    // Measured on a simulated arm: 0.32 m/s passes a drag of 0.4 N, 0.16 m/s passes 0.1 N and
    // sticks at 0.2 N, 0.08 m/s sticks at 0.1 N. These times give the speeds.
    for (time, drag, passes) in [
        (0.3, 0.4, true),
        (0.6, 0.4, true),
        (1.2, 0.1, true),
        (1.2, 0.2, false),
        (2.4, 0.1, false),
    ] {
        let robot = robot(&case, &format!("{allowed}drag = {drag}\n"));
        let found = plan(&robot, ends, time);
        assert_eq!(found.is_ok(), passes, "{time} s, {drag} N");
        if let Err(error) = found {
            assert!(error.to_string().contains("too slow"), "{error}");
        }
    }
}
