//! Random specifications: the arms that a bounded search finds keep them at every place that the kinematics samples.

use fivebar_design::Noise;
use fivebar_design::synthesis::{
    Area, CrankRange, Design, Drive, Measure, Objective, Payload, Proof, Specification, Stock,
    Study, Tolerance,
};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Pose, Side, WorkingMode};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

/// Areas of arms that a search may examine.
const BUDGET: u64 = 20_000;
/// By how much a sample may fall short of 1/κ or of a sine: the search looks between its own samples to this.
const BETWEEN: f64 = 1e-6;
/// The area's size where it is not sought [m].
const SIZE: f64 = 0.2;
/// The results of the campaign, and the document that sums them up.
const RESULTS: &str = "../docs/verify/data/random_specifications.csv";
const DOCUMENT: &str = include_str!("../../docs/design/synthesis.md");

/// A specification with the limits that the sampling looks at.
struct Drawn {
    specification: Specification,
    /// The name of its area.
    area: &'static str,
    /// The paths of size 1, if the area is of paths.
    paths: Vec<Vec<[f64; 2]>>,
    /// The range of the cranks [rad].
    cranks: Option<[f64; 2]>,
    /// The step of lengths in stock [m], or a list of them.
    stock: Result<f64, Vec<f64>>,
}

fn draw(noise: &mut Noise) -> Drawn {
    let mut between = |low: f64, high: f64| low + (high - low) * noise.uniform();
    let kind = between(0.0, 4.0) as usize;
    let mut point = || {
        vec![between(0.0, 1.0), between(0.0, 1.0)]
            .try_into()
            .unwrap()
    };
    let points: Vec<[f64; 2]> = (0..4).map(|_| point()).collect();
    let (name, area, paths) = match kind {
        0 => ("ring", Area::Annulus, Vec::new()),
        1 => {
            let aspect = between(0.5, 2.0);
            ("rectangle", Area::Rectangle { aspect }, Vec::new())
        }
        _ => {
            let (name, paths) = match kind {
                2 => ("points", points.iter().map(|&point| vec![point]).collect()),
                _ => ("path", vec![points]),
            };
            let area = Area::paths(&paths).unwrap();
            let Area::Paths(paths) = area.clone() else {
                unreachable!()
            };
            (name, area, paths)
        }
    };
    let least = between(0.0, 1.0);
    let cranks = [least, least + between(1.2, 2.4)];
    let cranks = (kind > 0 && between(0.0, 1.0) < 0.7).then_some(cranks);
    let coaxial = between(0.0, 1.0) < 0.2;
    let objective = match between(0.0, 5.0) as usize {
        0 => Objective::Size,
        1 => Objective::LinkSum(SIZE),
        2 => Objective::Dexterity(SIZE),
        3 => Objective::Measure(Measure::Torque, SIZE),
        _ => Objective::Measure(Measure::Speed, SIZE),
    };
    let stock: Result<f64, Vec<f64>> = match between(0.0, 3.0) as usize {
        0 => Ok(1e-3),
        1 => Ok(5e-3),
        _ => Err((0..50).map(|_| between(0.02, 1.0)).collect()),
    };
    let specification = Specification {
        symmetric: between(0.0, 1.0) < 0.5,
        base: [0.0, if coaxial { 0.0 } else { between(0.05, 0.5) }],
        link_sum: 1.0,
        area,
        dexterity: between(0.1, 0.45),
        sine: (between(0.0, 1.0) - 0.5).max(0.0),
        cranks: cranks.and_then(CrankRange::new),
        stock: match &stock {
            Ok(step) => Stock::step(*step).unwrap(),
            Err(list) => Stock::list(list).unwrap(),
        },
        payload: (between(0.0, 1.0) < 0.4).then(|| payload(&mut between)),
        tolerance: Tolerance::default(),
        objective,
        front: 1,
        starts: 1,
    };
    Drawn {
        specification,
        area: name,
        paths,
        cranks,
        stock,
    }
}

/// A tip's load that moves under gravity, and three drives.
fn payload(between: &mut dyn FnMut(f64, f64) -> f64) -> Payload {
    let drive = |torque: f64| Drive {
        name: format!("{torque} N·m"),
        torque,
        speed: 20.0,
        torque_limit: 0.8 * torque,
        inertia: 2e-3 * torque,
        price: torque,
        mass: 0.0,
    };
    Payload {
        mass: between(0.05, 0.3),
        speed: between(0.1, 1.0),
        acceleration: between(0.5, 5.0),
        gravity: [0.0, -9.81],
        link_density: between(0.1, 0.5),
        drives: [3.0, 8.0, 20.0].map(drive).into(),
    }
}

/// A place of the area, from the middle of the base [m].
fn place(drawn: &Drawn, design: &Design, noise: &mut Noise, sample: usize) -> Vector2<f64> {
    let (mut u, mut v) = (noise.uniform(), noise.uniform());
    // Half of them on the rim, where the limits are.
    match sample % 8 {
        0 => u = 0.0,
        1 => u = 1.0,
        2 => v = 0.0,
        3 => v = 1.0,
        _ => (),
    }
    let at = |x: f64, y: f64| {
        let [from_x, from_y] = design.place;
        Vector2::new(from_x + design.size * x, from_y + design.size * y)
    };
    match &drawn.specification.area {
        Area::Annulus => {
            let (sin, cos) = (TAU * v).sin_cos();
            Vector2::new(cos, sin) * (design.place[1] + design.size * u)
        }
        Area::Rectangle { aspect } => at(u - 0.5, v / aspect),
        _ => {
            let path = &drawn.paths[sample % drawn.paths.len()];
            let along = u * (path.len() - 1) as f64;
            let from = (along as usize).min(path.len() - 1);
            let ([x0, y0], [x1, y1]) = (path[from], path[(from + 1).min(path.len() - 1)]);
            let share = along - from as f64;
            at(x0 + share * (x1 - x0), y0 + share * (y1 - y0))
        }
    }
}

/// What the samples have left to the limits.
#[derive(Clone, Copy, Debug)]
struct Left {
    /// The least 1/κ.
    dexterity: f64,
    /// The least sine of both elbows and at C.
    sine: f64,
    /// The least angle to a limit of the cranks [rad].
    crank: f64,
    /// The least share of the torque of the cheapest drive.
    torque: f64,
    /// Whether sin(θ3 − θ2) has one sign.
    one_mode: bool,
}

fn sampled(drawn: &Drawn, design: &Design, noise: &mut Noise, samples: usize) -> Left {
    let geometry = Geometry::new(design.lengths).unwrap();
    let mode = WorkingMode::new(Side::Right, Side::Left);
    let mut left = Left {
        dexterity: f64::INFINITY,
        sine: f64::INFINITY,
        crank: f64::INFINITY,
        torque: f64::INFINITY,
        one_mode: true,
    };
    let mut sign = None;
    for sample in 0..samples {
        let middle = Vector2::new(0.5 * design.lengths[4], 0.0);
        let c = middle + place(drawn, design, noise, sample);
        let Ok(pose) = geometry.inverse(c, mode) else {
            left.dexterity = f64::NEG_INFINITY;
            return left;
        };
        let dexterity = geometry.jacobian(&pose).unwrap().inverse_condition();
        left.dexterity = left.dexterity.min(dexterity);
        let sines = [pose.sin21(), pose.sin34(), pose.sin32()].map(f64::abs);
        left.sine = sines.into_iter().fold(left.sine, f64::min);
        if let Some(payload) = &drawn.specification.payload {
            let share = torque_left(payload, design, &geometry, &pose, noise);
            left.torque = left.torque.min(share);
        }
        let positive = pose.sin32() > 0.0;
        left.one_mode &= *sign.get_or_insert(positive) == positive;
        if let Some([least, greatest]) = drawn.cranks {
            let [theta1, _, _, theta4] = pose.angles();
            for angle in [theta1, PI - theta4] {
                let off = angle - 0.5 * (least + greatest);
                let off = off - (off / TAU).round() * TAU;
                left.crank = left.crank.min(0.5 * (greatest - least) - off.abs());
            }
        }
    }
    left
}

/// The share of the torque that the cheapest drive has left, by the inverse dynamics for rods, in a random direction of speed
/// and of acceleration.
fn torque_left(
    payload: &Payload,
    design: &Design,
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    noise: &mut Noise,
) -> f64 {
    let Some(drive) = payload.cheapest(design.load) else {
        return f64::NEG_INFINITY;
    };
    let [l1, l2, l3, l4, _] = geometry.lengths();
    let rods = [l1, l2, l3, l4].map(|l| Link::uniform_rod(payload.link_density * l, l));
    let gravity = payload.gravity.into();
    let arm = Arm::new(*geometry, rods, payload.mass, gravity, [drive.inertia; 2]).unwrap();
    let mut any = |length: f64| {
        let (sin, cos) = (TAU * noise.uniform()).sin_cos();
        Vector2::new(cos, sin) * length
    };
    let (v, a) = (any(payload.speed), any(payload.acceleration));
    let velocities = geometry.inverse_velocities(pose, v).unwrap();
    let accelerations = geometry
        .inverse_accelerations(pose, &velocities, a)
        .unwrap();
    let torques = arm
        .inverse_dynamics(pose, &velocities, &accelerations, Vector2::zeros())
        .unwrap();
    let left = [0, 1].map(|joint| {
        let (torque, speed) = (torques[joint].abs(), velocities.omega[3 * joint].abs());
        let available = drive.torque * (1.0 - speed / drive.speed);
        (available.min(drive.torque_limit) - torque) / drive.torque
    });
    left[0].min(left[1])
}

/// Whether the arm is what was asked for, at every sample.
fn is_kept(drawn: &Drawn, design: &Design, left: Left) -> bool {
    let specification = &drawn.specification;
    let [l1, l2, l3, l4, base] = design.lengths;
    let [low, high] = specification.base;
    let is_symmetric = l1 == l4 && l2 == l3;
    let is_size_sought = specification.objective == Objective::Size;
    left.one_mode
        && left.dexterity >= specification.dexterity - BETWEEN
        && left.sine >= specification.sine - BETWEEN
        && left.crank >= 0.0
        && left.torque >= 0.0
        && (low..=high).contains(&base)
        && design.link_sum() <= specification.link_sum + 1e-12
        && (is_symmetric || !specification.symmetric)
        && (is_size_sought || design.size == SIZE)
}

/// Whether the links are in stock.
fn is_in_stock(drawn: &Drawn, design: &Design) -> bool {
    design.lengths[..4]
        .iter()
        .all(|&length| match &drawn.stock {
            Ok(step) => (length / step - (length / step).round()).abs() < 1e-6,
            Err(list) => list.contains(&length),
        })
}

/// The row of a specification in the results, and whether an arm was found, is proved, and keeps everything.
fn tried(index: usize, noise: &mut Noise, samples: usize) -> (String, [bool; 3]) {
    let drawn = draw(noise);
    let specification = &drawn.specification;
    let study = Study::new(specification, index as u64).within(BUDGET);
    let legs = if specification.symmetric {
        "equal"
    } else {
        "unlike"
    };
    let mut row = format!("{index},{},{legs}", drawn.area);
    let Ok(found) = study.run(&[], &|_, _| {}) else {
        return (row + ",no,,,,,,\n", [false, false, true]);
    };
    let left = sampled(&drawn, &found.best, noise, samples);
    let stock = sampled(&drawn, &found.stock, noise, samples);
    // Lengths in stock may not meet what is required, but they are what they say.
    let is_stock_true = found.stock.dexterity <= stock.dexterity.max(0.0) + BETWEEN;
    let is_stock_true = is_stock_true && is_in_stock(&drawn, &found.stock);
    let kept = is_kept(&drawn, &found.best, left) && is_stock_true;
    let is_proved = found.proof == Proof::Proved;
    let over = |left: f64, least: f64| match left.is_finite() && least > 0.0 {
        true => format!("{:.7}", left - least),
        false => String::new(),
    };
    let shown = |left: f64| match left.is_finite() {
        true => format!("{left:.7}"),
        false => String::new(),
    };
    let (crank, torque) = (shown(left.crank), shown(left.torque));
    let _ = writeln!(
        row,
        ",yes,{},{},{},{crank},{torque},{}",
        if is_proved { "yes" } else { "no" },
        over(left.dexterity, specification.dexterity),
        over(left.sine, specification.sine),
        if kept { "kept" } else { "VIOLATED" },
    );
    (row, [true, is_proved, kept])
}

/// The results of these specifications; each has random numbers of its own.
fn campaign(indices: impl IntoIterator<Item = usize>, samples: usize) -> (String, [usize; 3]) {
    let mut text = String::from(
        "specification,area,legs,found,proved,1/κ over the least,sine over the least,angle to a limit of the cranks [rad],share of a drive's torque left,verdict\n",
    );
    let mut counts = [0; 3];
    for index in indices {
        let (row, verdicts) = tried(index, &mut Noise::new(index as u64), samples);
        print!("{row}");
        text += &row;
        for (count, verdict) in counts.iter_mut().zip(verdicts) {
            *count += usize::from(verdict);
        }
    }
    (text, counts)
}

/// Arms with unlike legs, whose cranks come near to their limits.
#[test]
fn arms_keep_random_specifications() {
    let (text, [found, proved, kept]) = campaign([11, 22, 42], 2000);
    assert!(found == 3 && proved == found && kept == 3, "{text}");
}

/// `FIVEBAR_UPDATE=1` tries 200 and writes the results; without it those that the results have are tried again.
#[test]
#[ignore = "minutes: ./ci.sh tables"]
fn whole_table_of_random_specifications() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(RESULTS);
    let update = std::env::var_os("FIVEBAR_UPDATE").is_some();
    let known = || std::fs::read_to_string(&path).unwrap();
    let count = if update {
        200
    } else {
        known().lines().count() - 1
    };
    let (text, [found, proved, kept]) = campaign(0..count, 20_000);
    if update {
        std::fs::write(&path, &text).unwrap();
    }
    assert_eq!(kept, count);
    assert!(
        2 * found >= count && proved == found,
        "{found} found, {proved} proved"
    );
    assert_eq!(text, known(), "FIVEBAR_UPDATE=1 writes it");
}

#[test]
fn the_document_has_the_figures_of_the_results() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(RESULTS);
    let text = std::fs::read_to_string(path).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|row| row.split(',').collect())
        .collect();
    let count = |column: usize, value: &str| rows.iter().filter(|row| row[column] == value).count();
    assert_eq!(count(9, "VIOLATED"), 0);
    let (found, proved) = (count(3, "yes"), count(4, "yes"));
    assert_eq!(count(9, "kept"), found);
    let sentence = format!(
        "Of {} random specifications {found} gave an arm, {proved} proved",
        rows.len()
    );
    assert!(DOCUMENT.contains(&sentence), "{sentence}");
}

#[test]
fn the_drive_that_is_chosen_carries_the_payload_at_every_place() {
    let mut noise = Noise::new(1);
    let mut drawn = draw(&mut noise);
    let mut carried = payload(&mut |low, _| low);
    for drive in &mut carried.drives {
        drive.torque *= 0.1;
        drive.torque_limit = drive.torque;
    }
    drawn.specification.area = Area::Rectangle { aspect: 1.5 };
    drawn.specification.objective = Objective::Measure(Measure::Speed, SIZE);
    drawn.specification.symmetric = true;
    let study = |drawn: &Drawn| {
        Study::new(&drawn.specification, 1)
            .within(BUDGET)
            .run(&[], &|_, _| {})
    };
    drawn.specification.payload = None;
    let free = study(&drawn).unwrap().best;
    drawn.specification.payload = Some(carried);
    let found = study(&drawn).unwrap();
    let left = sampled(&drawn, &found.best, &mut noise, 20_000);
    assert!(
        is_kept(&drawn, &found.best, left) && left.torque < 0.1,
        "{left:?}"
    );
    // Without the payload the search finds an arm whose drive does not.
    assert!(sampled(&drawn, &free, &mut noise, 2000).torque < 0.0);
    assert!(found.drives.iter().all(Option::is_some));
}
