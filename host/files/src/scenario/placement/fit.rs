//! `--fit`: the largest scale at which an arm can draw a job, with the turn and the place for it.

use super::outline::Outline;
use super::{Reach, Scenario, ScenarioError};
use crate::job::Job;
use fivebar_firmware::Planner;

/// Step of the turns that are tried [degrees].
const TURN_STEP: u32 = 15;
/// A turn is preferred to an earlier one if the drawing becomes larger by this.
const WORTH_A_TURN: f64 = 1.01;
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
    /// The arm has no clear page, or its masses are not known.
    #[error("robot `{0}` has no place where its planner accepts this job at any scale")]
    NoPlace(String),
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
        self.origin = None;
        self.anywhere = true;
        let found = self.greatest_fit(&job, kept);
        let none = || FitError::NoPlace(self.robot.name.clone());
        let Fit { scale, turn } = found.ok_or_else(none)?;
        (self.scale, self.turn) = (scale, turn);
        Ok(())
    }

    /// The greatest scale and its turn, `anywhere` or not; `job` is placed at 0 with the present scale and turn.
    pub(super) fn greatest_fit(&self, job: &Job, kept: Kept) -> Option<Fit> {
        let reach = Reach::of(&self.robot)?;
        let mut planner = self.planner()?;
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
                    && self.fits(&reach, &mut planner, job, fit)
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
                if self.fits(&reach, &mut planner, job, fit) {
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
        planner: &mut Planner,
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
        let is_there = at_best
            .and_then(|origin| tried.moved(&unplaced, &tried, origin))
            .is_some_and(|job| tried.accepts_strokes(planner, &job));
        is_there || tried.search(reach, planner, &unplaced).is_some()
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
    while high - low > 5e-3 * high {
        let middle = 0.5 * (low + high);
        if has_room(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
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
    use super::rounded_down;

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
