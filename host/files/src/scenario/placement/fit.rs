//! `--fit`: the largest scale at which an arm can draw a job, with the turn and the place for it.

use super::outline::Outline;
use super::trials::Trials;
use super::{Reach, Scenario, ScenarioError};
use crate::job::Job;

/// A drawing that is smaller [m] is none that is to be enlarged.
const LEAST_SIZE: f64 = 1e-4;
/// Step of the turns that are tried [degrees].
const TURN_STEP: u32 = 15;
/// A turn is preferred to an earlier one if the drawing becomes larger by this.
const WORTH_A_TURN: f64 = 1.01;
/// A scale that is smaller than this share of the greatest one is none.
const LEAST_SHARE: f64 = 1e-3;
/// Shrinking per trial when the planner refuses what the map has room for.
const SHRINK: f64 = 0.97;
/// Trials before a drawing is given up.
const MOST_SHRINKS: u32 = 12;

/// Why a job cannot be fitted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// The robot or the job is not valid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The drawing is a point, or smaller than a pen's line.
    #[error(
        "nothing of a size to draw: the drawing is {0:.4} mm long, and --fit enlarges no drawing of less than 0.1 mm"
    )]
    NoSize(f64),
    /// The arm has no clear page, or its masses are not known.
    #[error("robot `{0}` has no place where its planner accepts this job at any scale")]
    NoPlace(String),
    /// The arm has no clear page that is larger than the margin.
    #[error(
        "robot `{0}` has no place for this job with {1} mm around it: choose a smaller --margin"
    )]
    NoMargin(String, f64),
}

/// What a fit keeps as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// The scale.
    pub scale: bool,
    /// The turn.
    pub turn: bool,
}

/// A scale with a turn [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    pub(super) scale: f64,
    pub(super) turn: f64,
}

impl Scenario {
    /// Sets the greatest scale at which the arm can draw the job, and the turn for it, but for what
    /// is kept.
    ///
    /// # Errors
    /// A job that is not valid, or one that fits nowhere.
    pub fn fit_to_reach(&mut self, kept: Kept) -> Result<(), FitError> {
        // What is not valid has its own message.
        let job = self.placed([0.0; 2])?;
        let job = job.without_parking().unwrap_or(job);
        let [width, height] = Outline::of(&job).extent().size();
        let size = width.max(height) / self.scale;
        if size < LEAST_SIZE && !kept.scale {
            return Err(FitError::NoSize(1e3 * size));
        }
        self.origin = None;
        self.anywhere = true;
        let found = self.greatest_fit(&job, kept);
        let none = || match self.margin > 0.0 {
            true => FitError::NoMargin(self.robot.name.clone(), 1e3 * self.margin),
            false => FitError::NoPlace(self.robot.name.clone()),
        };
        let Fit { scale, turn } = found.ok_or_else(none)?;
        (self.scale, self.turn) = (scale, turn);
        Ok(())
    }

    /// The greatest scale and its turn, `anywhere` or not; `job` is placed at 0 with the present scale and turn.
    pub(super) fn greatest_fit(&self, job: &Job, kept: Kept) -> Option<Fit> {
        self.greatest_fit_by(&mut Trials::new(self.planner()?), job, kept)
    }

    fn greatest_fit_by(&self, trials: &mut Trials, job: &Job, kept: Kept) -> Option<Fit> {
        let reach = Reach::of(&self.robot, self.margin)?;
        let outline = Outline::of(job);
        let turns = match kept.turn {
            true => 1,
            false => 360 / TURN_STEP,
        };
        let mut best: Option<Fit> = None;
        for index in 0..turns {
            let added = f64::from(TURN_STEP * index).to_radians();
            if kept.scale {
                let fit = Fit {
                    scale: self.scale,
                    turn: self.turn + added,
                };
                if has_room(&reach, &outline.placed(added, 1.0))
                    && self.fits(&reach, trials, job, fit)
                {
                    return Some(fit);
                }
                continue;
            }
            let least = best.map_or(0.0, |best| WORTH_A_TURN * best.scale / self.scale);
            let Some(factor) = greatest_on_map(&reach, &outline, added, least) else {
                continue;
            };
            let mut fit = Fit {
                scale: rounded_down(factor * self.scale),
                turn: self.turn + added,
            };
            if !self.anywhere {
                fit.scale = fit
                    .scale
                    .min(rounded_down(self.scale * longest(&reach, &outline, added)));
            }
            for _ in 0..MOST_SHRINKS {
                if fit.scale < least * self.scale {
                    break;
                }
                if self.fits(&reach, trials, job, fit) {
                    best = Some(fit);
                    break;
                }
                fit.scale = rounded_down(SHRINK * fit.scale);
            }
        }
        best
    }

    /// Whether `job`, at 0 with the present scale and turn, finds a place at this scale and turn.
    fn fits(
        &self,
        reach: &Reach,
        trials: &mut Trials,
        job: &Job,
        Fit { scale, turn }: Fit,
    ) -> bool {
        let tried = Self {
            scale,
            turn,
            origin: None,
            ..self.clone()
        };
        let Some(unplaced) = tried.moved(job, self, [0.0; 2]) else {
            return false;
        };
        let at_best = tried.at_best_point(&unplaced).ok();
        at_best.is_some_and(|origin| trials.accept(&tried, &unplaced, origin))
            || tried.search(reach, trials, &unplaced).is_some()
    }
}

/// Whether the page has room for the box of an outline, or the map for its cells.
fn has_room(reach: &Reach, outline: &Outline) -> bool {
    let ([width, height], page) = (outline.extent().size(), reach.page_size());
    (width <= page[0] && height <= page[1]) || !reach.corners(outline).is_empty()
}

/// The greatest factor, above `least`, by which an outline that is turned by `turn` [rad] can be
/// scaled so that the map has room for its cells, or the page for its box.
fn greatest_on_map(reach: &Reach, outline: &Outline, turn: f64, least: f64) -> Option<f64> {
    let turned = outline.placed(turn, 1.0);
    let [width, height] = turned.extent().size();
    let (grid, page) = (reach.map.grid(), reach.page_size());
    let size = grid.high() - grid.low();
    let on_page = (page[0] / width).min(page[1] / height);
    let most = (size.x / width).min(size.y / height);
    if !most.is_finite() {
        return None;
    }
    let has_room = |factor: f64| !reach.corners(&turned.placed(0.0, factor)).is_empty();
    let mut low = on_page;
    if low < least {
        if !has_room(least) {
            return None;
        }
        low = least;
    }
    let mut high = most.max(low);
    // The map has 160 cells, so it can tell no more.
    while high - low > 5e-3 * high && high > LEAST_SHARE * most {
        let middle = 0.5 * (low + high);
        if has_room(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low).filter(|&low| low > 0.0)
}

/// The factor at which an outline that is turned is as long as the page's longer side.
fn longest(reach: &Reach, outline: &Outline, turn: f64) -> f64 {
    let [width, height] = outline.placed(turn, 1.0).extent().size();
    let [page_width, page_height] = reach.page_size();
    page_width.max(page_height) / width.max(height)
}

/// At most `value`, with three digits, as one types it.
pub(super) fn rounded_down(value: f64) -> f64 {
    let digits = 10_f64.powf(2.0 - value.log10().floor());
    let rounded = (value * digits * (1.0 + 1e-12)).floor() / digits;
    // The nearest number with few decimals.
    format!("{rounded:.12}").parse().unwrap_or(rounded)
}

#[cfg(test)]
mod tests {
    use super::{FitError, Kept, Trials, rounded_down};
    use crate::robot::Robot;
    use crate::scenario::Scenario;
    use std::fmt::Write as _;

    const FREE: Kept = Kept {
        scale: false,
        turn: false,
    };

    fn scenario(file: &str, text: String) -> Scenario {
        let robot = Robot::load("benchtop_pen").expect("a robot");
        Scenario::new("drawing", robot, file, text)
    }

    /// An SVG of a spiral of this many lines, which ends at its rim: a refusal comes late.
    fn spiral(lines: u32) -> String {
        let mut path = String::from("M200 150");
        for line in 1..=lines {
            let share = f64::from(line) / f64::from(lines);
            let (sin, cos) = (std::f64::consts::TAU * 40.0 * share).sin_cos();
            let (x, y) = (200.0 + 190.0 * share * cos, 150.0 + 140.0 * share * sin);
            let _ = write!(path, "L{x:.3} {y:.3}");
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"400mm\" height=\"300mm\" \
             viewBox=\"0 0 400 300\"><path fill=\"none\" stroke=\"black\" d=\"{path}\"/></svg>"
        )
    }

    #[test]
    fn a_fit_of_thousands_of_lines_checks_the_whole_job_a_few_times() {
        let mut scenario = scenario("spiral.svg", spiral(7000));
        scenario.anywhere = true;
        let job = scenario.placed([0.0; 2]).expect("a job");
        let mut trials = Trials::new(scenario.planner().expect("a planner"));
        let fit = scenario.greatest_fit_by(&mut trials, &job, FREE);
        let checks = trials.whole_checks;
        println!("{fit:?} after {checks} checks of {} steps", job.steps.len());
        assert!(fit.is_some() && job.steps.len() >= 7000);
        assert!((1..=60).contains(&checks), "{checks} checks");
    }

    #[test]
    fn the_moves_that_were_refused_before_change_no_fit() {
        let mut refusals = 0;
        for robot in ["benchtop_pen", "benchtop_stepper"] {
            let lines = "G21 G90 F600\nG0 X0 Y0\nG1 X90\nG1 Y9\nG1 X0 Y9\n";
            for text in [spiral(60), lines.into()] {
                let robot = Robot::load(robot).expect("a robot");
                let name = format!("{} {}", robot.name, text.len());
                let mut scenario = Scenario::new("drawing", robot, "drawing", text);
                scenario.anywhere = true;
                let job = scenario.placed([0.0; 2]).expect("a job");
                let planner = || scenario.planner().expect("a planner");
                let mut trials = Trials::new(planner());
                let mut exhaustive = Trials::without_memory(planner());
                let [found, expected] = [&mut trials, &mut exhaustive]
                    .map(|trials| scenario.greatest_fit_by(trials, &job, FREE));
                assert_eq!(found, expected, "{name}");
                refusals += exhaustive.whole_checks - trials.whole_checks;
            }
        }
        assert!(refusals > 5, "{refusals} checks fewer");
    }

    #[test]
    fn a_drawing_smaller_than_a_tenth_of_a_millimetre_is_not_enlarged() {
        let square = |side: f64| format!("G21 G90\nG0 X0 Y0\nG1 X{side} F600\nG1 Y{side}\n");
        let mut small = scenario("small.gcode", square(0.09));
        let refusal = small.fit_to_reach(FREE).expect_err("a refusal");
        assert!(
            matches!(refusal, FitError::NoSize(size) if (size - 0.09).abs() < 1e-9),
            "{refusal}"
        );
        let sentence = refusal.to_string();
        assert!(
            sentence.contains("nothing of a size to draw") && sentence.contains("0.0900 mm"),
            "{sentence}"
        );
        let mut kept = scenario("small.gcode", square(0.09));
        let with_scale = Kept {
            scale: true,
            turn: false,
        };
        kept.fit_to_reach(with_scale)
            .expect("a place at its own size");
        let mut larger = scenario("larger.gcode", square(0.11));
        larger.fit_to_reach(FREE).expect("a place");
        assert!(larger.scale > 100.0, "{}", larger.scale);
    }

    #[test]
    fn a_plan_in_national_coordinates_is_fitted() {
        // A garden of 40 m by 30 m in millimetres, at the east and the north of a country's grid.
        let corners = [[0, 0], [40_000, 0], [40_000, 30_000], [0, 30_000], [0, 0]];
        let mut vertices = String::new();
        for [x, y] in corners {
            let (x, y) = (2_600_000_000_i64 + x, 1_200_000_000_i64 + y);
            let _ = write!(vertices, "10\n{x}\n20\n{y}\n");
        }
        let text = format!(
            "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n\
             0\nLWPOLYLINE\n8\n0\n90\n5\n70\n0\n{vertices}0\nENDSEC\n0\nEOF\n"
        );
        let mut plan = scenario("garden.dxf", text);
        plan.fit_to_reach(FREE).expect("a place");
        let job = plan.job().expect("a job");
        let mut planner = plan.planner().expect("a planner");
        plan.verify(&mut planner, &job)
            .expect("a job that is drawn");
        let size = super::Outline::of(&job).extent().size();
        assert!(size[0].max(size[1]) > 0.1, "{size:?} m");
    }

    #[test]
    fn scales_are_rounded_down_to_three_digits() {
        for (value, rounded) in [
            (0.123_49, 0.123),
            (0.78, 0.78),
            (12.39, 12.3),
            (1999.0, 1990.0),
        ] {
            assert_eq!(rounded_down(value), rounded);
        }
    }
}
