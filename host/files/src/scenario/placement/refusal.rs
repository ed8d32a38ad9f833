//! Why a job finds no place, and what would help.

use super::fit::{Fit, Kept};
use super::outline::{Outline, first_too_large};
use super::{Reach, Scenario};
use crate::job::{Job, is_drawing};
use fivebar_firmware::planner::{MoveError, MoveErrorKind};
use std::fmt::Write as _;

impl Scenario {
    /// Why the planner refuses a move of the job, with the sizes of the drawing and of the page,
    /// and with a scale, a turn or an origin that works.
    pub fn refused_move(&self, error: &MoveError) -> String {
        let Ok(job) = self.placed(self.origin.unwrap_or_default()) else {
            return self.named(error.tag, &error.to_string());
        };
        let is_place = matches!(
            error.kind,
            MoveErrorKind::Unreachable
                | MoveErrorKind::JointLimit(_)
                | MoveErrorKind::LegSingularity(_)
                | MoveErrorKind::ParallelSingularity
        );
        let reach = Reach::of(&self.robot, self.margin).filter(|_| is_place);
        let Some(reach) = reach else {
            return self.named(error.tag, &error.to_string());
        };
        let size = Outline::of(&job).extent().size();
        let page = reach.page_size();
        let too_large = first_too_large(&job, page).filter(|_| self.origin.is_none());
        let mut text = match too_large {
            Some(line) => self.named(line, "the drawing becomes larger than the arm has room for"),
            None => match self.first_out_of_reach(&job, &reach, error.tag) {
                Some((line, [x, y])) => {
                    let [x, y] = [x, y].map(|metres| 1e3 * metres);
                    let why = format!("the tool cannot reach the point at ({x:.3}, {y:.3}) mm");
                    self.named(line, &why)
                }
                None => self.named(error.tag, &error.to_string()),
            },
        };
        let _ = write!(
            text,
            "; the drawing is {}, the largest clear page {}",
            millimetres(size),
            millimetres(page)
        );
        let advice = self.advice(&job);
        match advice.is_empty() {
            true => text,
            false => text + "; " + &advice,
        }
    }

    /// If the refused move is the motion to the job, which no line asks for: the first line that ends
    /// where the arm cannot be, and its end [m].
    fn first_out_of_reach(&self, job: &Job, reach: &Reach, tag: u32) -> Option<(u32, [f64; 2])> {
        let is_way = |tag: u32| tag == 0 || (job.is_drawing && !tag.is_multiple_of(2));
        if !is_way(tag) {
            return None;
        }
        let steps = job.steps.iter().filter(|step| !is_way(step.line));
        let mut ends = steps.filter_map(|step| Some((step.line, step.action.end()?)));
        ends.find(|(_, end)| reach.map.workspace().check((*end).into()).is_err())
    }

    /// What would make the job fit.
    fn advice(&self, job: &Job) -> String {
        if let Some([x, y]) = self.origin
            && [x, y].iter().any(|metres| metres.abs() >= 1.0)
        {
            return format!(
                "its (0, 0) is placed at {x} m, {y} m: write --origin {x}mm,{y}mm if \
                 millimetres are meant"
            );
        }
        let unplaced = match self.origin {
            None => Some(job.clone()),
            Some(_) => self.placed([0.0; 2]).ok(),
        };
        let Some(unplaced) = unplaced else {
            return String::new();
        };
        let without = match self.origin {
            None => "",
            Some(_) => " without --origin",
        };
        let is_as_it_is = |fit: Option<Fit>| fit.is_some_and(|fit| fit.scale >= self.scale);
        let keep = |scale, turn| Kept { scale, turn };
        let straight = self.greatest_fit(&unplaced, keep(false, true));
        if self.origin.is_some() && is_as_it_is(straight) {
            return "it fits without --origin".into();
        }
        let turned = self.greatest_fit(&unplaced, keep(false, false));
        let scale = |fit: Fit| fit.scale.min(self.scale);
        let anywhere = Self {
            anywhere: true,
            origin: None,
            ..self.clone()
        };
        let kept = anywhere.greatest_fit(&unplaced, keep(true, false));
        let mut remedies = Vec::new();
        if let Some(fit) = straight {
            remedies.push(format!("--scale {}", scale(fit)));
        }
        if kept.is_some() {
            remedies.push(format!("--fit --scale {}", self.scale));
        } else if let Some(fit) = turned
            && straight.is_none_or(|straight| scale(fit) > 1.05 * scale(straight))
        {
            let degrees = (1e6 * fit.turn.to_degrees()).round() / 1e6;
            remedies.push(format!("--scale {} --rotate {degrees}", scale(fit)));
        }
        match remedies.is_empty() {
            true => String::new(),
            false => format!("it fits{without} with {}", remedies.join(", or with ")),
        }
    }

    /// A reason with the place in the job's file to which it belongs.
    pub fn named(&self, tag: u32, reason: &str) -> String {
        let place = place_in_job(is_drawing(&self.job_text), tag);
        format!("{}, {place}: {reason}", self.job_file)
    }
}

/// A move's place in its file, by its tag: "line 3", or the number of a stroke for a drawing.
pub fn place_in_job(is_drawing: bool, tag: u32) -> String {
    match (tag, is_drawing) {
        (0, _) => "on the way to its beginning".into(),
        (tag, false) => format!("line {tag}"),
        (tag, true) if tag.is_multiple_of(2) => format!("stroke {}", tag / 2),
        (tag, true) => format!("on the way to stroke {}", tag.div_ceil(2)),
    }
}

fn millimetres([width, height]: [f64; 2]) -> String {
    let side = |metres: f64| {
        let millimetres = 1e3 * metres;
        let decimals = usize::from(millimetres < 1000.0);
        let text = format!("{millimetres:.decimals$}");
        text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
    };
    format!("{} × {} mm", side(width), side(height))
}
