//! A value in another unit is wrong by a thousand. Every number of a robot file is multiplied and divided
//! by 1000: the file is refused, with the line and what the value must be, or a table states why
//! such a value cannot be told from a meant one.

use fivebar_files::robot::{BUILT_IN, Robot, SliderRobot};
use toml::{Table, Value};

/// The upright benchtop arm with a value other than 0 for every key of a robot file that has numbers.
fn whole() -> String {
    let mut text = BUILT_IN[0].text.to_owned();
    for (old, new) in [
        ("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]"),
        (
            "[[actuator]]",
            "[[actuator]]\nbrake_torque = 0.5\nbrake_engage_time = 0.05\nbrake_release_time = 0.05\ncurrent_per_code = 0.004\nstiffness = 2500.0\n\
             drive_damping = 0.008\nencoder_latency = 1e-4\n\
             encoder_error = [{ harmonic = 1, amplitude = 1e-3, phase = 0.5 }]",
        ),
        ("[limits]", "[limits]\nmax_torque = [0.7, 0.7]"),
        (
            "[supply]",
            "[supply]\nrange = [16.8, 31.2]\nvoltage_per_code = 0.0117",
        ),
        (
            "[protection]",
            "[protection]\nover_speed = 1.5\nover_current = 1.5\ncommand_timeout = 0.1",
        ),
        (
            "[motion]",
            "[tool]\noffset = [0.02, 0.01]\n\n[tool_output]\nkind = \"servo\"\nup_width = 1e-3\n\
             down_width = 1.5e-3\nframe_rate = 50.0\ndown_time = 0.12\nup_time = 0.09\n\n[motion]",
        ),
    ] {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    text + "\n[homing]\nmethod = \"switch\"\nsamples = 8\nspeed = 0.4\nback_off = 0.05\ncurrent = 1.2\n\n\
            [contact]\nelastic_modulus = 207e9\npoisson_ratio = 0.3\nbearing_radius = 4e-3\n\
            restitution = 0.9\nfriction = 0.05\n\n[crossing]\nallowed = false\ndrag = 0.1\n"
}

/// Keys of which a value a thousand times as small is as good, and why.
const SMALL_ONES: &[(&str, &str)] = &[
    ("home", "an angle may be near 0"),
    ("limits.angle", "an angle may be near 0"),
    ("actuator.encoder_error.phase", "an angle may be near 0"),
    ("gravity", "a table may lie almost level"),
    ("payload", "a pen may weigh next to nothing"),
    (
        "link.com",
        "a balanced link has its centre of mass near its axis",
    ),
    (
        "actuator.viscous_friction",
        "0 is the default: a good bearing",
    ),
    (
        "actuator.coulomb_friction",
        "0 is the default: a good bearing",
    ),
    (
        "actuator.drive_damping",
        "0 is the default: next to no damping",
    ),
    (
        "actuator.encoder_latency",
        "0 is the default: a fast encoder",
    ),
    (
        "actuator.encoder_error.amplitude",
        "0 is the default: a good encoder",
    ),
    ("tool.offset", "0 is the default: a tool at C"),
    ("tool_output.down_time", "0 is valid: the arm need not wait"),
    ("tool_output.up_time", "0 is valid: the arm need not wait"),
    ("control.integral_rate", "0 is valid: no integral action"),
    ("tolerance.length_sd", "0 is the default: precise parts"),
    ("tolerance.input_sd", "0 is the default: precise parts"),
    ("tolerance.input_max", "0 is the default: precise parts"),
    (
        "tolerance.clearance_radius",
        "0 is the default: precise parts",
    ),
    ("contact.restitution", "an impact may take all the speed"),
    ("contact.friction", "0 is valid: lubricated"),
    ("crossing.drag", "0 is the default"),
    ("travel.left", "a position may be near 0"),
    ("travel.right", "a position may be near 0"),
    ("platform", "0 is the default: PRRRP"),
];

/// A file without [control] would be tuned each time that it is read.
const CONTROL: &str = "\n[control]\ntick_rate = 10000.0\nbandwidth = 250.0\ndamping = 1.0\n\
                       integral_rate = 60.0\nobserver_bandwidth = 1500.0\ncurrent_bandwidth = 3000.0\n";

/// Calls `act` with the path and a scaled copy of the whole for each number in `value`.
fn each_number(path: &str, value: &Value, factor: f64, act: &mut dyn FnMut(&str, Value)) {
    match value {
        Value::Float(0.0) => {}
        Value::Float(number) => act(path, Value::Float(number * factor)),
        Value::Integer(number) => {
            let scaled = *number as f64 * factor;
            let whole = scaled.round();
            let scaled = if (scaled - whole).abs() < 1.0 && whole >= 1.0 {
                Value::Integer(whole as i64)
            } else {
                Value::Float(scaled)
            };
            act(path, scaled);
        }
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                each_number(path, item, factor, &mut |path, new| {
                    let mut items = items.clone();
                    items[index] = new;
                    act(path, Value::Array(items));
                });
            }
        }
        Value::Table(table) => {
            for (key, item) in table {
                let dot = if path.is_empty() { "" } else { "." };
                each_number(
                    &format!("{path}{dot}{key}"),
                    item,
                    factor,
                    &mut |path, new| {
                        let mut table = table.clone();
                        table.insert(key.clone(), new);
                        act(path, Value::Table(table));
                    },
                );
            }
        }
        Value::String(_) | Value::Boolean(_) | Value::Datetime(_) => {}
    }
}

/// What is taken wrong by a thousand, of a file that is refused by `read`; how many values were tried.
fn taken(
    text: &str,
    read: impl Fn(&str) -> Result<(), fivebar_files::source::FileError>,
) -> (Vec<String>, usize) {
    let whole = Value::Table(text.parse::<Table>().unwrap());
    read(&toml::to_string(&whole).unwrap()).unwrap();
    let mut taken = Vec::new();
    let mut tried = 0;
    for factor in [1e3, 1e-3] {
        each_number("", &whole, factor, &mut |path, file| {
            tried += 1;
            let file = toml::to_string(&file).unwrap();
            match read(&file) {
                Err(error) => {
                    assert!(error.line.is_some(), "{path} × {factor}: {error}");
                    if std::env::var_os("FIVEBAR_SHOW").is_some() {
                        println!("{path} × {factor}: {error}");
                    }
                }
                Ok(()) => taken.push(format!("{path} × {factor}")),
            }
        });
    }
    taken.dedup();
    (taken, tried)
}

/// Those that no row of the table states.
fn unstated(taken: Vec<String>) -> Vec<String> {
    let is_stated = |name: &String| {
        let small = |(key, _): &(&str, &str)| *name == format!("{key} × 0.001");
        SMALL_ONES.iter().any(small)
    };
    taken.into_iter().filter(|name| !is_stated(name)).collect()
}

#[test]
fn each_number_of_a_robot_wrong_by_a_thousand_is_refused_or_stated() {
    let whole = whole();
    let texts = BUILT_IN.iter().map(|robot| (robot.name, robot.text));
    let mut all = 0;
    for (name, text) in texts.chain([("all keys", whole.as_str())]) {
        let read = |text: &str| Robot::parse("arm.toml", text).map(|_| ());
        // An arm without masses is not controlled, and drives on a bus need no search.
        let is_tuned = text.contains("mass =") && !text.contains("can-torque");
        let control = if is_tuned { CONTROL } else { "" };
        let (taken, tried) = taken(&(text.to_owned() + control), read);
        all += tried;
        let unstated = unstated(taken);
        assert!(unstated.is_empty(), "{name}: {unstated:#?}");
    }
    assert!(all > 700, "{all}");
}

#[test]
fn each_number_of_a_slider_wrong_by_a_thousand_is_refused_or_stated() {
    let text = include_str!("../../robots/slider.toml");
    let read = |text: &str| SliderRobot::parse("slider.toml", text).map(|_| ());
    let (taken, tried) = taken(text, read);
    assert!(tried >= 22, "{tried}");
    let unstated = unstated(taken);
    assert!(unstated.is_empty(), "{unstated:#?}");
}

#[test]
fn the_refusal_of_a_value_in_another_unit_says_which_values_it_follows_from() {
    let text = BUILT_IN[0].text;
    for (key, wrong, words) in [
        (
            "peak_current = 4.0",
            "4000.0",
            "`peak_current` of [[actuator]] 1 must be 0.0209 to 20.9 A: 1/500 to 2 times the stall current, \
             `voltage` of [supply] over `resistance`; not 4000.0 A: is one of these values in another unit?",
        ),
        (
            "thermal_time_constant = 12.0",
            "12000.0",
            "must be 0.1 to 3600 s",
        ),
        ("inductance = 0.24e-3", "0.24", "must be 2.3e-5 to 0.115 H"),
        ("encoder_counts = 16384", "16", "must be 157 at least"),
        ("payload = 0.03", "30.0", "must be 11.5 kg at most"),
        ("mass = 0.07", "70.0", "must be 1e-4 to 8 kg"),
    ] {
        let (name, _) = key.split_once(" = ").unwrap();
        let text = text.replacen(key, &format!("{name} = {wrong}"), 1);
        let error = Robot::parse("arm.toml", &text).unwrap_err();
        assert!(error.reason.contains(words), "{error}");
        let line = error.line.unwrap();
        let said = text.lines().nth(line - 1).unwrap();
        assert!(said.starts_with(name), "line {line}: {said}");
    }
}
