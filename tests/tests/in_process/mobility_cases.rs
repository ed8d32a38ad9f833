//! Mobility: all figures of 26 mechanisms of the literature; turning, shifting and scaling must
//! not change them.

use fivebar_design::mobility::{Freedom, Joint, MechanismGraph, Screw, analyse_graph};
use fivebar_files::mobility::{EXAMPLES, MobilityCase, parse};
use fivebar_report::study::mobility::{MobilityAnalysis, analyse, answer};
use nalgebra::Vector3;
use proptest::prelude::*;
use serde_json::{Value, json};
use std::error::Error;

/// This key describes how the case was set up; it is not a result.
const NOT_A_RESULT: &str = "uses_parallelogram_as_P";

fn cases() -> Value {
    serde_json::from_str(include_str!("../../data/mobility_cases.json")).unwrap()
}

/// Compares every expected key; `cases` may have been moved or scaled.
fn compare(cases: &Value) -> Result<(), Box<dyn Error>> {
    let studies = parse("cases.json", &cases.to_string())?;
    let lists = ["parallel", "graph"].map(|kind| cases[kind].as_array().unwrap());
    let mut compared = 0;
    for (case, study) in lists.into_iter().flatten().zip(&studies) {
        let found = answer(&study.name, &analyse(study));
        for (key, expected) in case["expected"].as_object().unwrap() {
            if key != NOT_A_RESULT && &found[key] != expected {
                let found = &found[key];
                let name = &study.name;
                return Err(format!("{name}: {key} is {found}, expected {expected}").into());
            }
        }
        compared += 1;
    }
    assert_eq!(compared, 26);
    Ok(())
}

#[test]
fn every_expected_figure_of_26_mechanisms() {
    compare(&cases()).unwrap();
}

/// Every twist of every case turned, shifted and scaled as its mechanism would be.
fn displaced(turn: [f64; 3], shift: [f64; 3], scale: f64) -> Value {
    fn visit(value: &mut Value, change: &dyn Fn(&mut Vec<Value>)) {
        match value {
            Value::Array(items) if items.len() == 6 && items.iter().all(Value::is_number) => {
                change(items);
            }
            Value::Array(items) => items.iter_mut().for_each(|item| visit(item, change)),
            Value::Object(map) => map
                .iter_mut()
                .filter(|(key, _)| *key == "limbs" || *key == "joints" || *key == "twists")
                .for_each(|(_, item)| visit(item, change)),
            _ => {}
        }
    }
    let motion = nalgebra::Isometry3::new(Vector3::from(shift), Vector3::from(turn));
    let change = |items: &mut Vec<Value>| {
        let number = |i: usize| items[i].as_f64().unwrap();
        let screw = Screw {
            direction: Vector3::new(number(0), number(1), number(2)),
            moment: Vector3::new(number(3), number(4), number(5)) * scale,
        };
        let moved = screw.transformed(&motion).to_vector();
        *items = moved.iter().map(|x| json!(x)).collect();
    };
    let mut cases = cases();
    for kind in ["parallel", "graph"] {
        for case in cases[kind].as_array_mut().unwrap() {
            visit(case, &change);
        }
    }
    cases
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn no_figure_depends_on_place_attitude_or_size(
        turn in prop::array::uniform3(-3.0..3.0_f64),
        shift in prop::array::uniform3(-5.0..5.0_f64),
        exponent in -2.0..2.0_f64,
    ) {
        let outcome = compare(&displaced(turn, shift, 10_f64.powf(exponent)));
        prop_assert!(outcome.is_ok(), "{}", outcome.unwrap_err());
    }
}

fn example(name: &str) -> (MobilityCase, MobilityAnalysis) {
    let (_, text) = EXAMPLES.iter().find(|(known, _)| *known == name).unwrap();
    let study = parse(name, text).unwrap().remove(0);
    let analysis = analyse(&study);
    (study, analysis)
}

/// λ, d, v, M by (7), instantaneous, finite, left free by held drives.
fn figures(name: &str) -> [i64; 7] {
    let (study, analysis) = example(name);
    let found = answer(&study.name, &analysis);
    let keys = [
        "lambda",
        "d",
        "v",
        "M_eq7",
        "M_inst",
        "finite_M",
        "M_with_drives_held",
    ];
    keys.map(|key| found[key].as_i64().unwrap())
}

#[test]
fn our_arm_has_two_freedoms_and_its_drives_hold_it() {
    assert_eq!(figures("five-bar"), [3, 3, 0, 2, 2, 2, 0]);
}

#[test]
fn where_the_elbows_meet_the_drives_lose_hold() {
    assert_eq!(figures("five-bar-elbows-meet"), [3, 3, 0, 2, 2, 2, 1]);
}

#[test]
fn a_flat_arm_has_a_third_freedom_for_an_instant() {
    let [lambda, _, _, _, instantaneous, finite, _] = figures("five-bar-flat");
    assert_eq!([lambda, instantaneous, finite], [4, 3, 2]);
}

#[test]
fn huangs_worked_examples_from_their_drawings() {
    let huang = |name| {
        let (study, analysis) = example(name);
        answer(&study.name, &analysis)
    };
    let first = huang("huang-3rrr");
    let keys = [
        "n",
        "g",
        "lambda",
        "k",
        "v",
        "M_eq7",
        "platform_dof_eq9",
        "rot_rank",
        "pure_translations",
    ];
    assert_eq!(
        keys.map(|key| first[key].as_i64().unwrap()),
        [14, 15, 1, 0, 0, 5, 5, 3, 2]
    );
    assert_eq!(first["q"], json!([1, 1, 1]));
    let second = huang("huang-4rprrr");
    assert_eq!(
        keys.map(|key| second[key].as_i64().unwrap()),
        [18, 20, 0, 2, 2, 4, 4, 1, 3]
    );
    assert_eq!(second["q"], json!([1, 1, 1, 1]));
    // Three translations, and the rotation is about z.
    let rotation = second["freedoms"].as_array().unwrap();
    let axis = &rotation.iter().find(|f| f["kind"] == "rotation").unwrap()["axis"];
    assert!((axis[2].as_f64().unwrap().abs() - 1.0).abs() < 1e-12);
}

#[test]
fn the_other_examples_move_as_their_builders_meant() {
    assert_eq!(figures("four-bar"), [3, 3, 0, 1, 1, 1, 0]);
    assert_eq!(figures("delta"), [1, 5, 1, 3, 3, 3, 0]);
    assert_eq!(figures("stewart"), [0, 6, 0, 6, 6, 6, 0]);
    assert_eq!(figures("slider-parallelograms"), [3, 3, 1, 2, 2, 2, 0]);
}

#[test]
fn a_shaky_structure_beside_a_real_freedom_counts_only_the_real_one() {
    let hinge = |from, to, x| Joint {
        from,
        to,
        freedoms: vec![Freedom::Screw(Screw::line(
            Vector3::z(),
            Vector3::new(x, 0.0, 0.0),
        ))],
        actuated: false,
    };
    // A flat triangle that is shaky (mobile for an instant only), and a wheel on it that turns.
    let joints = vec![
        hinge(0, 1, 0.0),
        hinge(1, 2, 1.0),
        hinge(2, 0, 2.5),
        hinge(2, 3, 2.0),
    ];
    let analysis = analyse_graph(&MechanismGraph::new(4, 3, joints).unwrap());
    assert_eq!(
        (analysis.mobility.instantaneous, analysis.mobility.finite),
        (2, 1)
    );
}

#[test]
fn constraints_do_no_work_on_freedoms() {
    for (name, _) in EXAMPLES {
        let (study, analysis) = example(name);
        let found = answer(&study.name, &analysis);
        let screw = |value: &Value| {
            let vector = |v: &Value| Vector3::from_fn(|i, _| v[i].as_f64().unwrap());
            let axis = vector(&value["axis"]);
            match value["kind"].as_str().unwrap() {
                "translation" | "couple" => Screw::free(axis),
                _ => Screw::helix(
                    axis,
                    vector(&value["point"]),
                    value["pitch"].as_f64().unwrap_or(0.0),
                ),
            }
        };
        let list = |value: &Value| {
            value
                .as_array()
                .unwrap()
                .iter()
                .map(screw)
                .collect::<Vec<_>>()
        };
        let (wrenches, twists) = (
            list(&found["constraints"]["platform"]),
            list(&found["freedoms"]),
        );
        assert_eq!(wrenches.len() + twists.len(), 6, "{name}");
        for (wrench, twist) in wrenches
            .iter()
            .flat_map(|w| twists.iter().map(move |t| (w, t)))
        {
            assert!(
                wrench.reciprocal_product(twist).abs() < 1e-6,
                "{name}: {wrench:?} {twist:?}"
            );
        }
    }
}

#[test]
fn unsound_descriptions_are_refused_in_one_sentence() {
    let refused = |file: &str, text: &str| match parse(file, text) {
        Ok(_) => panic!("accepted: {text}"),
        Err(error) => {
            let reason = error.to_string();
            assert!(
                reason.starts_with(file) && reason.lines().count() == 1,
                "{reason}"
            );
            reason
        }
    };
    let refusal = |text: &str| refused("x.toml", text);
    let limb = |joint: &str| format!("name = \"x\"\n[[limb]]\njoints = [{joint}]\n");
    let zero = refusal(&limb(
        r#"{ kind = "R", axis = [0, 0, 0], point = [0, 0, 0] }"#,
    ));
    assert_eq!(
        zero,
        "x.toml: limb 1, joint 1: an axis and its moment must be 1e-6 to 1e6 in size, in metres, and a joint \
         needs a freedom: check the units"
    );
    assert!(refusal(&limb(r#"{ kind = "Q", axis = [0, 0, 1] }"#)).contains('Q'));
    assert!(refusal("name = \"x\"\nlimb = 3\n").starts_with("x.toml, line 2: "));
    assert!(refusal(&limb(r#"{ kind = "P", axis = [0, 0, 1], colour = 1 }"#)).contains("colour"));
    assert!(refusal("name = \"x\"").contains("no [[limb]]"));
    let joint = |a: &str, b: &str| {
        format!("[[joint]]\nbetween = [\"{a}\", \"{b}\"]\nkind = \"P\"\naxis = [1, 0, 0]\n")
    };
    let ring = format!(
        "name = \"x\"\nplatform = \"a\"\n{}{}{}",
        joint("a", "b"),
        joint("b", "c"),
        joint("c", "a")
    );
    assert!(refusal(&ring).contains("connect a body to it"));
    let odd = format!(
        "name = \"x\"\nplatform = \"a\"\n{}colour = 1\n",
        joint("ground", "a")
    );
    assert!(refusal(&odd).contains("colour"));
    let apart = format!(
        "name = \"x\"\nplatform = \"a\"\n{}{}",
        joint("ground", "a"),
        joint("b", "c")
    );
    assert!(refusal(&apart).contains("not connected to the ground"));
    let many = format!("[[{}]]", ["[0,0,1,0,0,0]"; 100_000].join(","));
    let many = format!("{{\"parallel\":[{{\"name\":\"x\",\"limbs\":{many}}}]}}");
    assert!(refused("x.json", &many).contains("more than 200"));
    assert!(refused("x.json", "{\"parallel\":[]}").contains("no case"));
}

/// With a coordinate of 1e308 the answer held NaN: products of the numbers must stay finite.
#[test]
fn numbers_too_small_or_too_large_to_compute_with_are_refused_in_both_formats() {
    let toml = |size: &str, what: &str| {
        let joint = |axis: &str, point: &str| {
            format!("{{ kind = \"R\", axis = {axis}, point = {point}, actuated = true }}")
        };
        let odd = match what {
            "axis" => joint(&format!("[0, 0, {size}]"), "[0, 0, 0]"),
            _ => joint("[0, 0, 1]", &format!("[{size}, 0, 0]")),
        };
        let limb = |joint: &str| format!("[[limb]]\njoints = [{joint}]\n");
        let text =
            "name = \"n\"\n".to_owned() + &limb(&odd) + &limb(&joint("[0, 0, 1]", "[1, 0, 0]"));
        parse("n.toml", &text)
    };
    for size in ["1e308", "-1e308", "1e100", "2e6"] {
        for what in ["axis", "point"] {
            let error = toml(size, what).err().expect(size).to_string();
            assert!(error.contains("1e-6 to 1e6 in size, in metres"), "{error}");
        }
    }
    assert!(toml("1e-300", "axis").is_err());
    for size in ["1e-6", "1.0", "1e6"] {
        for what in ["axis", "point"] {
            let cases = toml(size, what).unwrap();
            let answer = answer(&cases[0].name, &analyse(&cases[0])).to_string();
            assert!(!answer.contains("null"), "{size}: {answer}");
        }
    }
    let json = |size: f64| {
        let twist = [0.0, 0.0, 1.0, size, 0.0, 0.0];
        let case = json!({ "name": "n", "limbs": [[twist], [[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]] });
        parse("n.json", &case.to_string())
    };
    assert!(json(1e308).is_err() && json(1e5).is_ok());
}
