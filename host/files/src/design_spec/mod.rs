//! Specifications of `fivebar design`: what is wanted of an arm, in TOML.

mod payload;

use super::job::{Action, Job, Placement, read as read_job};
use super::refusal::{Key, Refusal, Refusals};
use super::source::{FileError, Source};
use super::text_file::{LARGEST_TOML, read_text};
use fivebar_design::synthesis::{
    Area, CrankRange, Measure, Objective, Specification, Stock, Tolerance,
};
use payload::{GearFile, MotorFile, PayloadFile};
use serde::Deserialize;
use std::f64::consts::TAU;
use std::path::Path;

/// The most designs of a front.
const MOST_DESIGNS: usize = 200;
/// The most searches of a design.
const MOST_STARTS: usize = 100_000;
/// Greatest length [m]; greater numbers are probably in millimetres.
const LONGEST: f64 = 20.0;
/// Chords of a full turn of an arc.
const CHORDS: f64 = 72.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SpecFile {
    symmetric: bool,
    base: [f64; 2],
    link_sum: Option<f64>,
    area: AreaFile,
    require: RequireFile,
    stock: Option<StockFile>,
    tolerance: Option<ToleranceFile>,
    objective: ObjectiveFile,
    payload: Option<PayloadFile>,
    #[serde(default)]
    motor: Vec<MotorFile>,
    #[serde(default)]
    gear: Vec<GearFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AreaFile {
    kind: Kind,
    width: Option<f64>,
    height: Option<f64>,
    aspect: Option<f64>,
    side: Option<f64>,
    points: Option<Vec<[f64; 2]>>,
    file: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Annulus,
    Square,
    Rectangle,
    Points,
    Drawing,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RequireFile {
    dexterity: Option<f64>,
    sine: Option<f64>,
    crank: Option<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StockFile {
    step: Option<f64>,
    lengths: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ToleranceFile {
    length: f64,
    angle: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectiveFile {
    maximise: Option<Maximise>,
    minimise: Option<Minimise>,
    #[serde(default = "one")]
    front: usize,
    #[serde(default = "one")]
    starts: usize,
}

fn one() -> usize {
    1
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Maximise {
    Size,
    Dexterity,
    Speed,
    Stiffness,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Minimise {
    LinkSum,
    Torque,
    Error,
}

/// Reads a specification. A drawing is looked for beside it.
///
/// # Errors
/// A file that cannot be read; a missing key or a value that is not valid, with its line.
pub fn read(path: &Path) -> Result<Specification, FileError> {
    let text = read_text(path, LARGEST_TOML);
    let text = text.map_err(|error| FileError::new(path.display(), error))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&path.display().to_string(), &text, folder)
}

/// The specification in the text of a file called `file`; drawings are looked for in `folder`.
///
/// ```
/// let text = r#"
/// symmetric = true
/// base = [0.0, 0.0]
/// link_sum = 0.3
/// [area]
/// kind = "annulus"
/// [require]
/// dexterity = 0.5
/// [objective]
/// maximise = "size"
/// "#;
/// let specification = fivebar_files::design_spec::parse("leg.toml", text, "".as_ref())?;
/// assert_eq!(specification.link_sum, 0.3);
/// # Ok::<(), fivebar_files::source::FileError>(())
/// ```
///
/// # Errors
/// A missing key, or a value that is not valid, with its line.
pub fn parse(file: &str, text: &str, folder: &Path) -> Result<Specification, FileError> {
    let read_drawing = |name: &str| read_job(&folder.join(name)).map_err(|error| error.to_string());
    parse_with(file, text, &read_drawing)
}

/// As [`parse`], with the drawing's text from `read_drawing`, which gets the name that the specification has for it.
///
/// # Errors
/// As [`parse`].
pub fn parse_with(
    file: &str,
    text: &str,
    read_drawing: &dyn Fn(&str) -> Result<String, String>,
) -> Result<Specification, FileError> {
    let source = Source::new(file, text);
    let spec = source.parse()?;
    made(&spec, read_drawing).map_err(|refusal| source.error(refusal))
}

/// The specification of a file with these values.
fn made(
    spec: &SpecFile,
    read_drawing: &dyn Fn(&str) -> Result<String, String>,
) -> Result<Specification, Refusal> {
    let mut refusals = Refusals::default();
    let [low, high] = spec.base;
    if !(0.0 <= low && low <= high && high <= LONGEST) {
        let reason =
            format!("must be [least, greatest], 0 to {LONGEST:?} m, not [{low:?}, {high:?}]");
        refusals.add(Key::Top("base"), reason);
    }
    let is_sought = matches!(spec.objective.maximise, Some(Maximise::Size));
    if let Some(sum) = spec.link_sum {
        refusals.note(length(Key::Top("link_sum"), sum));
        if sum <= 0.5 * low {
            let reason = format!("must be more than half the least `base`, not {sum:?}");
            refusals.add(Key::Top("link_sum"), reason);
        }
    } else if spec.objective.maximise.is_some() {
        let reason = "is missing: it limits the links of what is to be the greatest; give metres";
        refusals.add(Key::Top("link_sum"), reason);
    }
    let [dexterity, sine] = required(&spec.require, &mut refusals);
    let cranks = refusals.noted(cranks(&spec.require));
    let stock = refusals.noted(stock(spec.stock.as_ref()));
    let payload = refusals.noted(payload::made(
        spec.payload.as_ref(),
        &spec.motor,
        &spec.gear,
    ));
    let front = spec.objective.front;
    if !(1..=MOST_DESIGNS).contains(&front) {
        let reason = format!("must be 1 to {MOST_DESIGNS} designs, not {front}");
        refusals.add(Key::In("objective", "front"), reason);
    }
    let starts = spec.objective.starts;
    if !(1..=MOST_STARTS).contains(&starts) {
        let reason = format!("must be 1 to {MOST_STARTS} searches, not {starts}");
        refusals.add(Key::In("objective", "starts"), reason);
    }
    let tolerance = refusals.noted(tolerance(spec));
    let area = refusals.noted(area(&spec.area, is_sought, read_drawing));
    let (objective, other) = (&spec.objective.maximise, &spec.objective.minimise);
    let one_objective = objective.is_some() != other.is_some();
    if !one_objective {
        let reason = "must be given, or `minimise` in place of it: \"size\", \"dexterity\", \"speed\" or \
                      \"stiffness\", or the least \"link_sum\", \"torque\" or \"error\"";
        refusals.add(Key::In("objective", "maximise"), reason);
    }
    refusals.done()?;
    let (area, size) = area?;
    let objective = match (objective, other) {
        (Some(Maximise::Size), _) => Objective::Size,
        (Some(Maximise::Dexterity), _) => Objective::Dexterity(size),
        (Some(Maximise::Speed), _) => Objective::Measure(Measure::Speed, size),
        (Some(Maximise::Stiffness), _) => Objective::Measure(Measure::Stiffness, size),
        (None, Some(Minimise::Torque)) => Objective::Measure(Measure::Torque, size),
        (None, Some(Minimise::Error)) => Objective::Measure(Measure::Error, size),
        (None, Some(Minimise::LinkSum) | None) => Objective::LinkSum(size),
    };
    Ok(Specification {
        symmetric: spec.symmetric,
        base: spec.base,
        link_sum: spec.link_sum.unwrap_or(f64::INFINITY),
        area,
        dexterity,
        sine,
        cranks: cranks?,
        stock: stock?,
        payload: payload?,
        tolerance: tolerance?,
        objective,
        front,
        starts,
    })
}

/// The least 1/κ and the least sine; one that is not given is 0.
fn required(require: &RequireFile, refusals: &mut Refusals) -> [f64; 2] {
    let RequireFile {
        dexterity, sine, ..
    } = *require;
    if dexterity.is_none() && sine.is_none_or(|sine| sine == 0.0) {
        let reason = "is missing, and `sine`, too: without either the arm could be singular in the area; give one of \
                      them, more than 0 and less than 1";
        refusals.add(Key::In("require", "dexterity"), reason);
    }
    let mut share = |key, value: f64, least: bool| {
        if (value > 0.0 || (value == 0.0 && !least)) && value < 1.0 {
            return value;
        }
        let from = if least { "more than 0" } else { "at least 0" };
        let reason = format!("must be {from} and less than 1, not {value:?}");
        refusals.add(Key::In("require", key), reason);
        0.0
    };
    [
        dexterity.map_or(0.0, |value| share("dexterity", value, true)),
        sine.map_or(0.0, |value| share("sine", value, false)),
    ]
}

/// The range of the cranks; none if they may turn anywhere.
fn cranks(require: &RequireFile) -> Result<Option<CrankRange>, Refusal> {
    let Some([least, greatest]) = require.crank else {
        return Ok(None);
    };
    let range = CrankRange::new([least, greatest]).filter(|_| least.abs() <= TAU);
    range.map(Some).ok_or_else(|| {
        let reason = format!(
            "must be [least, greatest] of θ1, {} to 3.14 rad apart, not [{least:?}, {greatest:?}]",
            CrankRange::NARROWEST
        );
        Key::In("require", "crank").refused(reason)
    })
}

/// The lengths that can be had; whole millimetres if the file says nothing.
fn stock(stock: Option<&StockFile>) -> Result<Stock, Refusal> {
    let Some(StockFile { step, lengths }) = stock else {
        return Ok(Stock::default());
    };
    match (step, lengths) {
        (&Some(step), None) => Stock::step(step)
            .filter(|_| step <= LONGEST)
            .ok_or_else(|| {
                let reason = format!("must be 0.0001 to {LONGEST:?} m, not {step:?}");
                Key::In("stock", "step").refused(reason)
            }),
        (None, Some(lengths)) => Stock::list(lengths)
            .filter(|_| lengths.iter().all(|length| *length <= LONGEST))
            .ok_or_else(|| {
                let reason = format!("must be one length or more, 0.0001 to {LONGEST:?} m each");
                Key::In("stock", "lengths").refused(reason)
            }),
        _ => {
            let reason = "must be given, in metres, or `lengths` in place of it";
            Err(Key::In("stock", "step").refused(reason))
        }
    }
}

/// The stated errors; none are 0.
fn tolerance(spec: &SpecFile) -> Result<Tolerance, Refusal> {
    let Some(ToleranceFile { length, angle }) = spec.tolerance else {
        if matches!(spec.objective.minimise, Some(Minimise::Error)) {
            let reason = "is \"error\", which needs [tolerance] with the standard deviations `length`, in metres, and \
                          `angle`, in radians";
            return Err(Key::In("objective", "minimise").refused(reason));
        }
        return Ok(Tolerance::default());
    };
    for (key, value, most) in [("length", length, 0.01), ("angle", angle, 0.1)] {
        if !(0.0..=most).contains(&value) {
            let unit = if key == "angle" { "rad" } else { "m" };
            let reason = format!("must be 0 to {most:?} {unit}, not {value:?}");
            return Err(Key::In("tolerance", key).refused(reason));
        }
    }
    if length + angle == 0.0 {
        let reason = "must not be 0 together with `angle`: give the error of at least one";
        return Err(Key::In("tolerance", "length").refused(reason));
    }
    Ok(Tolerance { length, angle })
}

/// The area and its size [m], which means nothing where the size is sought.
fn area(
    area: &AreaFile,
    is_sought: bool,
    read_drawing: &dyn Fn(&str) -> Result<String, String>,
) -> Result<(Area, f64), Refusal> {
    let key = |name| Key::In("area", name);
    let given = [
        ("width", area.width.is_some()),
        ("height", area.height.is_some()),
        ("aspect", area.aspect.is_some()),
        ("side", area.side.is_some()),
        ("points", area.points.is_some()),
        ("file", area.file.is_some()),
    ];
    let own: &[&str] = match area.kind {
        Kind::Annulus => &["width"],
        Kind::Square => &["side"],
        Kind::Rectangle => &["width", "height", "aspect"],
        Kind::Points => &["points"],
        Kind::Drawing => &["file"],
    };
    for (name, is_given) in given {
        if is_given && !own.contains(&name) {
            let reason = format!(
                "does not belong to this `kind`, which has `{}`",
                own.join("`, `")
            );
            return Err(key(name).refused(reason));
        }
    }
    let needed = |name, value: Option<f64>| match value {
        Some(value) => length(key(name), value),
        None if is_sought => Ok(1.0),
        None => Err(key(name).refused("is missing: give metres")),
    };
    match area.kind {
        Kind::Annulus => Ok((Area::Annulus, needed("width", area.width)?)),
        Kind::Square => Ok((Area::Rectangle { aspect: 1.0 }, needed("side", area.side)?)),
        Kind::Rectangle => {
            let (aspect, width) = match (area.aspect, area.width, area.height) {
                (Some(aspect), width, None) => (aspect, needed("width", width)?),
                (None, Some(width), Some(height)) => {
                    let width = length(key("width"), width)?;
                    (width / length(key("height"), height)?, width)
                }
                _ => {
                    let reason = "must be given with `height`; or give `aspect`, width by height, where \
                                  the size is sought";
                    return Err(key("width").refused(reason));
                }
            };
            if !(1e-3..=1e3).contains(&aspect) {
                let reason = format!("is width by height, 0.001 to 1000, not {aspect:?}");
                return Err(key("aspect").refused(reason));
            }
            Ok((Area::Rectangle { aspect }, width))
        }
        Kind::Points => {
            let points = area.points.as_deref().unwrap_or_default();
            let paths: Vec<Vec<[f64; 2]>> = points.iter().map(|&point| vec![point]).collect();
            let reason = "must be two unlike points or more, [[x, y], …] in metres";
            path_area(&paths).ok_or_else(|| key("points").refused(reason))
        }
        Kind::Drawing => {
            let missing = "is missing: name a G-code or SVG file beside this one";
            let name = area.file.as_ref();
            let name = name.ok_or_else(|| key("file").refused(missing))?;
            let text = read_drawing(name);
            let text = text.map_err(|error| key("file").refused(format!("`{name}`: {error}")))?;
            let job = Job::parse(&text, &AS_DRAWN);
            let job = job.map_err(|error| key("file").refused(format!("`{name}`: {error}")))?;
            let reason = format!("`{name}` has no path");
            path_area(&[path(&job)]).ok_or_else(|| key("file").refused(reason))
        }
    }
}

fn path_area(paths: &[Vec<[f64; 2]>]) -> Option<(Area, f64)> {
    let points = || paths.iter().flatten();
    let extent = |axis: usize| {
        let least = points().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
        let most = points().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
        most - least
    };
    Some((Area::paths(paths)?, extent(0).max(extent(1))))
}

const AS_DRAWN: Placement = Placement {
    origin: [0.0; 2],
    scale: 1.0,
    turn: 0.0,
    home: [0.0; 2],
};

/// The path of a job from the end of its first motion, with the motions between the strokes; arcs as
/// chords.
fn path(job: &Job) -> Vec<[f64; 2]> {
    let mut path: Vec<[f64; 2]> = Vec::new();
    for step in &job.steps {
        if let (
            Some(&from),
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            },
        ) = (path.last(), &step.action)
        {
            let angle = |p: [f64; 2]| (p[1] - center[1]).atan2(p[0] - center[0]);
            let radius = (from[0] - center[0]).hypot(from[1] - center[1]);
            let turn = (angle(*to) - angle(from)).rem_euclid(TAU);
            let turn = match clockwise {
                _ if from == *to => TAU,
                true => turn - TAU,
                false => turn,
            };
            let count = (turn.abs() / TAU * CHORDS).ceil();
            path.extend((1..count as u32).map(|i| {
                let angle = angle(from) + turn * f64::from(i) / count;
                [
                    center[0] + radius * angle.cos(),
                    center[1] + radius * angle.sin(),
                ]
            }));
        }
        path.extend(step.action.end());
    }
    path
}

fn length(key: Key, value: f64) -> Result<f64, Refusal> {
    if value > 0.0 && value <= LONGEST {
        Ok(value)
    } else {
        let reason = format!("must be more than 0 and at most {LONGEST:?} m, not {value:?}");
        Err(key.refused(reason))
    }
}
