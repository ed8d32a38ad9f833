//! Random simulated arms that are commissioned: wrong by lengths, masses, friction, switches, motors
//! and wiring. `scripts/soak.sh arms` tries many of them.

use crate::commission::{commission, killed_after, record, text, value};
use crate::commission_limits::assert_within_limits;
use oorandom::Rand64;
use std::fmt::Write as _;
use std::fs;
use std::time::Duration;

/// Mistakes in the wiring, and what `commission` says of each.
const MISTAKES: [(&str, &str); 18] = [
    ("motors_swapped = true", "the motors are swapped"),
    ("encoders_swapped = true", "the encoders are swapped"),
    (
        "motor_reversed = [true, false]",
        "the motor of joint 1 is reversed",
    ),
    (
        "motor_reversed = [false, true]",
        "the motor of joint 4 is reversed",
    ),
    (
        "encoder_reversed = [true, false]",
        "the encoder of joint 1 is reversed",
    ),
    (
        "encoder_reversed = [false, true]",
        "the encoder of joint 4 is reversed",
    ),
    (
        "current_reversed = [true, false]",
        "current sense of joint 1 is reversed",
    ),
    (
        "current_reversed = [false, true]",
        "current sense of joint 4 is reversed",
    ),
    (
        "motor_dead = [true, false]",
        "motor channel of joint 1 is dead",
    ),
    (
        "motor_dead = [false, true]",
        "motor channel of joint 4 is dead",
    ),
    ("encoder_dead = [true, false]", "encoder of joint 1 is dead"),
    ("encoder_dead = [false, true]", "encoder of joint 4 is dead"),
    (
        "current_dead = [true, false]",
        "current sensor of joint 1 is dead",
    ),
    (
        "current_dead = [false, true]",
        "current sensor of joint 4 is dead",
    ),
    (
        "counts = [1.0, 0.0]",
        "counts or the gear ratio of joint 1 are wrong",
    ),
    (
        "counts = [0.0, -0.75]",
        "counts or the gear ratio of joint 4 are wrong",
    ),
    (
        "\n[[fault]]\nkind = \"switch_stuck\"\njoint = 4\npressed = true",
        "the home switch of joint 4 is stuck",
    ),
    (
        "\n[[fault]]\nkind = \"bus_voltage\"\nvolts = 19.0",
        "the supply is wrong",
    ),
];

/// An arm of a seed: its scenario, and what must be found wrong with it, if anything.
struct RandomArm {
    scenario: String,
    mistake: Option<&'static str>,
}

impl RandomArm {
    fn new(seed: u64, random: &mut Rand64, wired: bool) -> Self {
        let mut within = |most: f64| most * (2.0 * random.rand_float() - 1.0);
        let mut pair = |most: f64| [within(most), within(most)];
        let [[l1, l2], [l3, l4], [base, payload]] = [pair(3e-4), pair(3e-4), pair(3e-4)];
        let ([mass, friction], home, constant) = (pair(0.2), pair(0.01), pair(0.05));
        let mut scenario = format!(
            "job = \"dot.gcode\"\nseed = {seed}\n[mismatch]\nlink_mass = {mass:?}\nfriction = \
             {friction:?}\nlink_length = [{l1:?}, {l2:?}, {l3:?}, {l4:?}]\nbase_length = {base:?}\n\
             payload = {:?}\nhome_error = {home:?}\ntorque_constant = {constant:?}\n",
            50.0 * payload.abs()
        );
        if !wired {
            return Self {
                scenario,
                mistake: None,
            };
        }
        let (lines, named) = MISTAKES[random.rand_range(0..MISTAKES.len() as u64) as usize];
        let _ = writeln!(scenario, "[wiring]\n{lines}");
        Self {
            scenario,
            mistake: Some(named),
        }
    }
}

/// Tip error [m] before and after, and the one that was expected.
type TipErrors = [f64; 3];

/// Commissions an arm, killed once after this time before, if any. Returns the shares of the limits
/// that it used, and the tip errors; none if a mistake was named.
fn commissioned(arm: &RandomArm, kill: Option<Duration>) -> ([f64; 4], Option<TipErrors>) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("dot.gcode"), "G1 X1 F600\n").unwrap();
    let scenario = folder.path().join("random.toml");
    fs::write(&scenario, &arm.scenario).unwrap();
    let scenario = scenario.display().to_string();
    if let Some(time) = kill {
        killed_after(folder.path(), &["--scenario", &scenario], time);
        if folder.path().join("out/simulated.json").exists() {
            assert_within_limits(folder.path(), &arm.scenario);
        }
    }
    let output = commission(folder.path(), &["--scenario", &scenario]);
    let (lines, message) = (&arm.scenario, text(&output.stderr));
    let shares = assert_within_limits(folder.path(), lines);
    if let Some(named) = arm.mistake {
        assert_eq!(output.status.code(), Some(1), "{lines}");
        assert!(message.contains(named), "{lines}: {message}");
        return (shares, None);
    }
    assert!(output.status.success(), "{lines}: {message}");
    let record = record(folder.path());
    assert_eq!(record["steps"].as_array().unwrap().len(), STEPS);
    // An excitation ends at 0.45 rad or 1.3 A; the joint then comes to rest, shorted, from 12 rad/s.
    for joint in [1, 4] {
        let travel = value(&record, &format!("greatest_travel{joint}_rad"));
        let current = value(&record, &format!("greatest_current{joint}_a"));
        assert!(travel > 0.3 && travel < 1.1, "{travel} rad: {lines}");
        assert!(current > 0.5 && current < 1.4, "{current} A: {lines}");
    }
    let found = ["before_rms", "after_rms", "expected"]
        .map(|which| value(&record, &format!("tip_error_{which}_m")));
    let [_, after, expected] = found;
    assert!(
        after < 2.0 * expected,
        "{after} m, {expected} m expected: {lines}"
    );
    (shares, Some(found))
}

/// Steps of a whole commissioning.
const STEPS: usize = 13;

#[test]
fn random_arms_that_are_wired_wrongly_have_their_mistake_named() {
    for seed in 1..4 {
        let mut random = Rand64::new(seed);
        let arm = RandomArm::new(seed as u64, &mut random, true);
        assert!(commissioned(&arm, None).1.is_none());
    }
}

/// `ARMS_SEED` and `ARMS_COUNT` say which arms; every fourth is wired wrongly, every other is killed
/// once at a random moment.
#[test]
#[ignore = "some seconds for each arm"]
fn many_random_arms_end_named_or_within_twice_their_own_prediction() {
    let number = |name: &str, default: u64| -> u64 {
        std::env::var(name).map_or(default, |text| text.parse().unwrap())
    };
    let (first, count) = (number("ARMS_SEED", 1), number("ARMS_COUNT", 100));
    let (mut named, mut ended, mut most) = (0, Vec::new(), [0.0_f64; 4]);
    for seed in first..first + count {
        let mut random = Rand64::new(seed.into());
        let arm = RandomArm::new(seed, &mut random, seed % 4 == 0);
        let kill = Duration::from_secs_f64(3.0 * random.rand_float());
        println!("seed {seed}");
        let (shares, found) = commissioned(&arm, Some(kill));
        for (most, share) in most.iter_mut().zip(shares) {
            *most = most.max(share);
        }
        match found {
            None => named += 1,
            Some(found) => ended.push(found),
        }
    }
    let range = |of: &dyn Fn(&[f64; 3]) -> f64| {
        let values = ended.iter().map(of);
        values.fold((f64::INFINITY, 0.0_f64), |(least, most), value| {
            (least.min(value), most.max(value))
        })
    };
    let before = range(&|found| 1e6 * found[0]);
    let after = range(&|found| 1e6 * found[1]);
    let share = range(&|found| found[1] / found[2]);
    println!(
        "{count} arms: {named} mistakes named; of {} the tip error fell from {:.0} to {:.0} µm RMS to \
         {:.1} to {:.1}, {:.2} times the prediction at most",
        ended.len(),
        before.0,
        before.1,
        after.0,
        after.1,
        share.1
    );
    println!("greatest shares of the limits of energy, heat, travel and speed: {most:.2?}");
}
