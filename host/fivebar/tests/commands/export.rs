//! The command `fivebar export`. The contents of the models are checked by the programs that
//! read them (scripts/peers.sh).

use fivebar_testkit::program;
use std::path::Path;
use std::process::Output;
use usvg::roxmltree::Document;

fn export(arguments: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("export").args(arguments).output().unwrap()
}

#[test]
fn the_model_is_printed_or_written_to_the_named_file() {
    let folder = tempfile::tempdir().unwrap();
    for (format, begins) in [("mjcf", "<mujoco"), ("urdf", "<?xml"), ("dot", "graph")] {
        let printed = export(&[format, "usp_2dof"]);
        assert!(printed.status.success());
        let model = String::from_utf8(printed.stdout).unwrap();
        assert!(model.trim_start().starts_with(begins), "{model}");

        let path = folder.path().join(format);
        let path = path.to_str().unwrap();
        let written = export(&[format, "usp_2dof", "--out", path]);
        assert!(written.status.success());
        assert_eq!(std::fs::read_to_string(path).unwrap(), model);
        let message = String::from_utf8(written.stdout).unwrap();
        assert!(
            message.contains("usp_2dof") && message.contains(path),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1);
    }
}

/// The robot file of the benchtop arm with another name.
fn named(folder: &Path, name: &str) -> String {
    let (_, benchtop) = include_str!("../../../files/robots/benchtop.toml")
        .split_once("name = \"benchtop\"")
        .unwrap();
    let path = folder.join("arm.toml");
    std::fs::write(&path, format!("name = {name:?}{benchtop}")).unwrap();
    path.to_str().unwrap().into()
}

#[test]
fn the_model_is_well_formed_with_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let name = "a --- <b> & \"c\" 'd' --";
    let robot = named(folder.path(), name);
    for (format, attribute) in [("mjcf", "model"), ("urdf", "name")] {
        let model = String::from_utf8(export(&[format, &robot]).stdout).unwrap();
        let document = Document::parse(&model).unwrap();
        assert_eq!(document.root_element().attribute(attribute), Some(name));
    }
}

#[test]
fn urdf_joints_have_the_torque_of_their_motors() {
    let model = String::from_utf8(export(&["urdf", "benchtop"]).stdout).unwrap();
    let document = Document::parse(&model).unwrap();
    let limits = document
        .descendants()
        .filter(|node| node.has_tag_name("limit"));
    let efforts = limits.map(|node| node.attribute("effort").unwrap().parse().unwrap());
    // 4 A · 0.0234 N·m/A · 8
    let off = |effort: f64| (effort - 0.7488).abs();
    assert!(efforts.clone().all(|effort| off(effort) < 1e-9));
    assert_eq!(efforts.count(), 2);
}

#[test]
fn mjcf_motors_have_equal_control_and_force_ranges() {
    let model = String::from_utf8(export(&["mjcf", "benchtop"]).stdout).unwrap();
    let document = Document::parse(&model).unwrap();
    let motors = document
        .descendants()
        .filter(|node| node.has_tag_name("motor"));
    for motor in motors.clone() {
        for (limited, range) in [("ctrllimited", "ctrlrange"), ("forcelimited", "forcerange")] {
            assert_eq!(motor.attribute(limited), Some("true"));
            let range = motor.attribute(range).unwrap().split(' ');
            let ends: Vec<f64> = range.map(|end| end.parse().unwrap()).collect();
            // 4 A · 0.0234 N·m/A · 8
            assert!((ends[0] + 0.7488).abs() < 1e-9, "{ends:?}");
            assert!((ends[1] - 0.7488).abs() < 1e-9, "{ends:?}");
            assert_eq!(ends.len(), 2);
        }
    }
    assert_eq!(motors.count(), 2);
}

#[test]
fn a_path_that_cannot_be_written_is_named_in_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let refused = export(&["dot", "--out", folder.path().to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(1));
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(
        message.contains(folder.path().to_str().unwrap()),
        "{message}"
    );
}

/// scripts/peers.sh compares the motion with other engines; this is what the file has for it.
#[test]
fn urdf_has_the_rotors_the_friction_and_the_tool_and_says_what_it_has_not() {
    let model = String::from_utf8(export(&["urdf", "benchtop"]).stdout).unwrap();
    let document = Document::parse(&model).unwrap();
    let robot = fivebar_files::robot::Robot::load("benchtop").unwrap();
    let arm = robot.arm().unwrap();
    let rotors = arm.rotor_inertia();
    assert!(rotors.iter().all(|&rotor| rotor > 0.0));
    let named = |kind: &str, name: &str| {
        let mut nodes = document.descendants();
        nodes.find(|node| node.has_tag_name(kind) && node.attribute("name") == Some(name))
    };
    for (name, index, rotor) in [("link1", 0, rotors[0]), ("link4", 3, rotors[1])] {
        let link = named("link", name).unwrap();
        let inertia = link.descendants().find(|node| node.has_tag_name("inertia"));
        let izz: f64 = inertia.unwrap().attribute("izz").unwrap().parse().unwrap();
        let alone = arm.links()[index].inertia;
        assert!((izz - alone - rotor).abs() < 1e-15, "{name}: {izz}");
    }
    let drives = robot.actuators.unwrap();
    for (name, drive) in ["A", "E"].into_iter().zip(drives) {
        let joint = named("joint", name).unwrap();
        let dynamics = joint.children().find(|node| node.has_tag_name("dynamics"));
        let dynamics = dynamics.unwrap();
        let number = |key: &str| dynamics.attribute(key).unwrap().parse::<f64>().unwrap();
        assert_eq!(number("damping"), drive.viscous_friction);
        assert_eq!(number("friction"), drive.coulomb_friction);
    }
    assert!(named("link", "tool").is_some());
    for words in [
        "set it to (0, 0, 0) m/s²",
        "leave the joints' armature at 0",
    ] {
        assert!(model.contains(words), "{words}");
    }
    // The models have no gains: with a bandwidth in the file none are searched for the belts.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("belts.toml");
    let belts = include_str!("../../../files/robots/benchtop_belt.toml");
    std::fs::write(&path, format!("{belts}\n[control]\nbandwidth = 100.0\n")).unwrap();
    for format in ["urdf", "mjcf"] {
        let belts = export(&[format, path.to_str().unwrap()]).stdout;
        let belts = String::from_utf8(belts).unwrap();
        assert!(belts.contains("Not in this model: the stiffness of the drives, "));
        assert!(Document::parse(&belts).is_ok());
    }
}
