//! The keys of drives and sensors that are not ideal, in robot and scenario files: they are read as
//! documented, and refused with file, line, key and what to do.

use fivebar_files::robot::{BUILT_IN, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_plant::{EncoderSide, Harmonic, Mismatch};

/// The benchtop arm with these lines in its second `[[actuator]]`.
fn robot_text(keys: &str) -> String {
    let text = BUILT_IN[0].text;
    let at = text.rfind("[[actuator]]").unwrap() + "[[actuator]]\n".len();
    format!("{}{keys}\n{}", &text[..at], &text[at..])
}

fn scenario(mismatch: &str) -> Result<Scenario, String> {
    scenario_on("benchtop", mismatch)
}

fn scenario_on(robot: &str, mismatch: &str) -> Result<Scenario, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    let petal = include_str!("../../jobs/petal.gcode");
    std::fs::write(folder.path().join("petal.gcode"), petal).unwrap();
    let text = format!("robot = '{robot}'\njob = 'petal.gcode'\n[mismatch]\n{mismatch}\n");
    std::fs::write(&path, text).unwrap();
    Scenario::load(path.to_str().unwrap()).map_err(|error| error.to_string())
}

#[test]
fn the_drive_of_a_robot_file_is_read() {
    let text = robot_text(
        "stiffness = 2500\ndrive_damping = 0.03\nencoder_side = 'joint'\nencoder_latency = 1e-4\n\
         encoder_error = [{ harmonic = 2, amplitude = 1e-3, phase = 0.5 },\n  \
         { harmonic = 1, amplitude = -2e-3 }]",
    );
    let robot = Robot::parse("arm.toml", &text).unwrap();
    let [plain, given] = robot.actuators.unwrap();
    assert_eq!(plain.stiffness, None);
    assert_eq!(plain.encoder_side, EncoderSide::Motor);
    assert_eq!((plain.drive_damping, plain.encoder_latency), (0.0, 0.0));
    assert!(plain.encoder_error.terms().is_empty());
    assert_eq!(given.stiffness, Some(2500.0));
    assert_eq!(given.drive_damping, 0.03);
    assert_eq!(given.encoder_side, EncoderSide::Joint);
    assert_eq!(given.encoder_latency, 1e-4);
    let terms = [(2, 1e-3, 0.5), (1, -2e-3, 0.0)].map(|(harmonic, amplitude, phase)| Harmonic {
        harmonic,
        amplitude,
        phase,
    });
    assert_eq!(given.encoder_error.terms(), terms);
    let parameters = robot.plant_parameters().unwrap();
    assert_eq!(parameters.transmissions[0].stiffness, None);
    assert_eq!(parameters.transmissions[1].stiffness, Some(2500.0));
    assert_eq!(parameters.encoders[1].error.terms(), terms);
}

#[test]
fn a_drive_that_is_not_valid_is_refused_with_line_key_and_remedy() {
    for (keys, key, words) in [
        ("stiffness = 0.0", "stiffness", "positive"),
        ("stiffness = -5.0", "stiffness", "positive"),
        ("stiffness = 1e9", "stiffness", "leave it out for a rigid"),
        (
            "drive_damping = 0.03",
            "drive_damping",
            "give a `stiffness`",
        ),
        (
            "stiffness = 50.0\ndrive_damping = 99.0",
            "drive_damping",
            "0 to 16",
        ),
        ("encoder_latency = 0.2", "encoder_latency", "0 to 0.1 s"),
        ("encoder_latency = -1e-4", "encoder_latency", "0 to 0.1 s"),
        (
            "encoder_error = [{ harmonic = 0, amplitude = 1e-3 }]",
            "encoder_error",
            "1 or more",
        ),
        (
            "encoder_error = [{ harmonic = 9, amplitude = 0.12 }]",
            "encoder_error",
            "below 1",
        ),
        ("encoder_side = 'gear'", "encoder_side", "`joint`"),
        (
            "encoder_error = [{ harmonic = 1, amplitude = 0.01, face = 1 }]",
            "face",
            "`phase`",
        ),
    ] {
        let text = robot_text(keys);
        let assignment = keys.lines().last().unwrap();
        let line = 1 + text.lines().position(|line| line == assignment).unwrap();
        let message = Robot::parse("arm.toml", &text).unwrap_err().to_string();
        for word in [
            &format!("arm.toml, line {line}: "),
            &format!("`{key}`"),
            words,
        ] {
            assert!(message.contains(word), "{keys}: no `{word}` in: {message}");
        }
    }
    let text =
        robot_text("stiffness = 900.0").replace("rotor_inertia = 1.0e-6", "rotor_inertia = 0");
    let message = Robot::parse("arm.toml", &text).unwrap_err().to_string();
    assert!(message.contains("`rotor_inertia` above 0"), "{message}");
    let many = vec!["{ harmonic = 1, amplitude = 1e-6 }"; 17].join(", ");
    let text = robot_text(&format!("encoder_error = [{many}]"));
    let message = Robot::parse("arm.toml", &text).unwrap_err().to_string();
    assert!(
        message.contains("at most 16 harmonics, not 17"),
        "{message}"
    );
}

#[test]
fn a_mismatch_is_read_and_its_keys_are_off_when_left_out() {
    let whole = scenario(
        "link_length = [1e-4, -1e-4, 0, 5e-5]\nbase_length = 2e-4\nhome_error = [1e-3, -1e-3]\n\
         torque_constant = [0.05, -0.05]\ntorque_ripple = [0.02, 0.03]\ncogging = [2e-3, 1e-3]\n\
         stiffness = [2500, 1250]\ndrive_damping = [0.02, 0]\nbacklash = [1e-4, 0]\n\
         stiction = [0.5, 0.2]\n\
         encoder_error = [[{ harmonic = 1, amplitude = 3.5e-3, phase = 1 }], []]\n\
         encoder_latency = [1e-4, 0]\nsupply_resistance = 0.1\n\
         pulley_run_out = [1.2e-3, 1e-3]\ntooth_mesh = [4e-4, 0]\n\
         pen_friction = 0.25\npaper_growth = [5e-3, -1e-3]",
    );
    let Mismatch {
        link_length,
        base_length,
        home_error,
        torque_constant,
        torque_ripple,
        cogging,
        stiffness,
        drive_damping,
        backlash,
        stiction,
        encoder_error,
        encoder_latency,
        supply_resistance,
        pulley_run_out,
        tooth_mesh,
        pen_friction,
        paper_growth,
        ..
    } = whole.unwrap().mismatch;
    assert_eq!(link_length, [1e-4, -1e-4, 0.0, 5e-5]);
    assert_eq!((base_length, supply_resistance), (2e-4, 0.1));
    assert_eq!(home_error, [1e-3, -1e-3]);
    assert_eq!(torque_constant, [0.05, -0.05]);
    assert_eq!((torque_ripple, cogging), ([0.02, 0.03], [2e-3, 1e-3]));
    assert_eq!(stiffness, Some([2500.0, 1250.0]));
    assert_eq!((drive_damping, backlash), ([0.02, 0.0], [1e-4, 0.0]));
    assert_eq!((stiction, encoder_latency), ([0.5, 0.2], [1e-4, 0.0]));
    assert_eq!((pulley_run_out, tooth_mesh), ([1.2e-3, 1e-3], [4e-4, 0.0]));
    assert_eq!((pen_friction, paper_growth), (0.25, [5e-3, -1e-3]));
    let [first, second] = encoder_error;
    assert_eq!((first.terms()[0].harmonic, second.terms().len()), (1, 0));
    let zeros = "link_length = [0, 0, 0, 0]\nbase_length = 0\nhome_error = [0, 0]\n\
                 torque_constant = [0, 0]\ntorque_ripple = [0, 0]\ncogging = [0, 0]\n\
                 drive_damping = [0, 0]\nbacklash = [0, 0]\nstiction = [0, 0]\n\
                 encoder_error = [[], []]\nencoder_latency = [0, 0]\nsupply_resistance = 0\n\
                 pulley_run_out = [0, 0]\ntooth_mesh = [0, 0]\npen_friction = 0\n\
                 paper_growth = [0, 0]";
    assert_eq!(scenario(zeros).unwrap().mismatch, Mismatch::default());
}

#[test]
fn a_mismatch_that_is_not_valid_is_refused_with_line_key_and_remedy() {
    for (keys, words) in [
        ("stiffness = [0.0, 2500.0]", "leave it out for a rigid"),
        ("stiffness = [1e9, 2500.0]", "at 20 kHz"),
        ("stiffness = [2500.0]", "`stiffness`: invalid length"),
        ("stiffness = [2e3, 2e3, 2e3]", "invalid length 3"),
        ("drive_damping = [0.1, 0.0]", "give a `stiffness`"),
        ("backlash = [-1e-4, 0.0]", "0 to 0.1 rad, not -0.0001"),
        ("stiction = [0.5, -0.5]", "0 to 10, not -0.5"),
        ("cogging = [-1e-3, 0.0]", "at least 0, not -0.001"),
        ("torque_ripple = [1.0, 0.0]", "0 to 0.9, not 1.0"),
        ("torque_constant = [0.0, -1.0]", "at least -0.9, not -1.0"),
        ("home_error = [0.2, 0.0]", "-0.1 to 0.1 rad, not 0.2"),
        ("link_length = [0, 0, 0, 0.02]", "-0.01 to 0.01 m, not 0.02"),
        ("link_length = [0, nan, 0, 0]", "must be finite"),
        ("base_length = -0.01", "-0.008 to 0.008 m, not -0.01"),
        ("encoder_latency = [0.0, 0.2]", "0 to 0.1 s, not 0.2"),
        ("supply_resistance = -1.0", "0 to 100 Ω, not -1.0"),
        ("pulley_run_out = [-1e-3, 0.0]", "at least 0, not -0.001"),
        ("pulley_run_out = [0.04, 0.0]", "0 to 0.03125 rad, not 0.04"),
        (
            "tooth_mesh = [0.0, 0.002]",
            "0 to 0.001953125 rad, not 0.002",
        ),
        ("pen_friction = 11.0", "0 to 10 N, not 11.0"),
        ("paper_growth = [0.0, 0.06]", "-0.05 to 0.05, not 0.06"),
        (
            "encoder_error = [[], [{ harmonic = 4, amplitude = 0.3 }]]",
            "below 1",
        ),
        (
            "encoder_error = [{ harmonic = 4, amplitude = 0.3 }]",
            "line 4",
        ),
    ] {
        let message = scenario(keys).unwrap_err();
        assert!(message.contains("case.toml, line 4: "), "{keys}: {message}");
        let (key, _) = keys.split_once(' ').unwrap();
        for word in [key, words] {
            assert!(message.contains(word), "no `{word}` in: {message}");
        }
    }
    // Damping is bounded beside a stiffness and beside a backlash.
    for spring in ["stiffness = [9e2, 9e2]", "backlash = [1e-4, 1e-4]"] {
        let message = scenario(&format!("{spring}\ndrive_damping = [99.0, 0.0]")).unwrap_err();
        assert!(message.contains("line 5: `drive_damping`"), "{message}");
        assert!(message.contains("not 99.0"), "{message}");
    }
    // An arm with ideal torque sources has no rotors.
    for keys in [
        "stiffness = [2500.0, 2500.0]",
        "backlash = [1e-4, 0.0]",
        "tooth_mesh = [1e-4, 0.0]",
    ] {
        let message = scenario_on("usp_2dof", keys).unwrap_err();
        assert!(message.contains("give each [[actuator]]"), "{message}");
    }
}

#[test]
fn what_hobby_servos_do_not_have_is_refused_with_its_line() {
    let refused = |keys: &str| scenario_on("classroom_servo", keys).unwrap_err();
    for (keys, words) in [
        (
            "cogging = [1e-3, 0.0]",
            "and this arm has hobby servos: leave it out",
        ),
        ("supply_resistance = 0.1", "and this arm has hobby servos"),
        (
            "pulley_run_out = [1e-3, 0.0]",
            "is of a belt between motor and joint, and a hobby servo has none",
        ),
        (
            "[wiring]\nencoders_swapped = true",
            "is a mistake with brushed motors or steppers with encoders, and this arm has hobby servos: leave it out",
        ),
        (
            "link_mass = 0.1\n[[fault]]\nat = 0.5\nkind = 'encoder_dead'\njoint = 1",
            "is of motors with encoders, and this arm has hobby servos",
        ),
        (
            "link_mass = 0.1\n[[fault]]\nat = 0.5\nkind = 'step_lost'\njoint = 1\nsteps = 2",
            "needs an arm with steppers",
        ),
    ] {
        let message = refused(keys);
        assert!(message.contains("case.toml, line "), "{keys}: {message}");
        assert!(message.contains(words), "{keys}: {message}");
    }
    let keys = "home_error = [0.02, -0.02]\n[[fault]]\nat = 0.5\nkind = 'motor_stalled'\njoint = 4";
    scenario_on("classroom_servo", keys).unwrap();
}

#[test]
fn drives_on_a_bus_have_the_mismatch_of_motors_and_belts_but_no_supply() {
    let keys = "cogging = [0.06, 0.06]\ntorque_ripple = [0.02, 0.02]\nstiffness = [2e3, 2e3]\n\
                drive_damping = [0.05, 0.05]\nbacklash = [1e-4, 1e-4]";
    let mismatch = scenario_on("leg", keys).unwrap().mismatch;
    assert_eq!(mismatch.stiffness, Some([2e3; 2]));
    let message = scenario_on("leg", "supply_resistance = 0.1").unwrap_err();
    assert!(message.contains("line 4: `supply_resistance`"), "{message}");
    assert!(
        message.contains("has drives on a CAN bus: leave it out"),
        "{message}"
    );
}

#[test]
fn a_number_of_the_wiring_that_nothing_can_have_is_refused_with_its_line_and_bounds() {
    for (robot, key, bounds) in [
        ("benchtop", "counts = [0.0, -1.0]", "must be above -1"),
        (
            "benchtop_stepper",
            "microsteps = [0.0, 1.0]",
            "is 0.00390625 to 256.0, not 0.0",
        ),
        (
            "benchtop_stepper",
            "current_share = [1.0, 2.5]",
            "is 0.0 to 2.0, not 2.5",
        ),
        (
            "classroom_servo",
            "supply_share = nan",
            "is 0.0 to 2.0, not NaN",
        ),
        ("leg", "orders_lost = [1.5, 0.0]", "is 0.0 to 1.0, not 1.5"),
        (
            "leg",
            "answers_lost = [0.0, -0.1]",
            "is 0.0 to 1.0, not -0.1",
        ),
        (
            "leg",
            "torque_constant = [-1.0, 0.0]",
            "is -0.9 to 9.0, not -1.0",
        ),
        (
            "leg",
            "zero_shift = [0.0, 4.0]",
            "is -3.2 to 3.2 rad, not 4.0",
        ),
    ] {
        let message = scenario_on(robot, &format!("[wiring]\n{key}")).unwrap_err();
        let name = key.split(' ').next().unwrap();
        let start = format!("case.toml, line 5: `{name}` of [wiring] {bounds}");
        assert!(message.contains(&start), "{key}: {message}");
    }
}
