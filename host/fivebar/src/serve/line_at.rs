//! The line of a job that draws nearest to a point, from which the job can begin.

use super::controller_thread::ControllerThread;
use super::job_thread::Work;
use super::parsed_job::ParsedJob;
use super::requests::Refused;
use super::wire::lease::{Page, PageId};
use super::wire::message::ServerMessage;
use fivebar_firmware::{Move, MoveKind};
use std::f32::consts::TAU;
use std::sync::Arc;

impl ControllerThread {
    /// Has the line of the loaded job looked for that draws nearest to a point [m].
    pub(super) fn look_for_line(&mut self, page: &Page, point: [f64; 2]) -> Result<(), Refused> {
        if self.jobs.is_busy() {
            return Err("The job is being checked: wait a moment.".into());
        }
        let loaded = self.loaded.as_ref().ok_or("There is no job: load one.")?;
        let job = Arc::clone(&loaded.job);
        let start = self.preview.start(&self.session.status);
        // `as` rounds.
        let point = point.map(|coordinate| coordinate as f32);
        self.jobs.order(Work::LineAt(page.id, job, point), start);
        Ok(())
    }

    /// Tells a page the line that was found.
    pub(super) fn tell_line(&self, to: PageId, found: Option<(u32, [f32; 2])>) {
        match found {
            Some((line, at)) => self.updates.send(&ServerMessage::Line { to, line, at }),
            None => self.refuse(Some(to), "The job draws nothing.".into()),
        }
    }
}

impl ParsedJob {
    /// The line that draws nearest to a point [m], and where the tool is before it; none if nothing is drawn.
    pub(super) fn line_at(&self, point: [f32; 2]) -> Option<(u32, [f32; 2])> {
        let mut place = None;
        let mut found: Option<(f32, u32)> = None;
        for next in self.moves.iter() {
            if next.tool > 0
                && let Some(far) = place.and_then(|from| distance(from, &next, point))
                && found.is_none_or(|(least, _)| far < least)
            {
                found = Some((far, next.tag));
            }
            place = fivebar_sim::path_queue::end(&next).or(place);
        }
        let (_, line) = found?;
        let (_, at) = self.at_line(line)?;
        Some((line, at?))
    }
}

/// The distance of a point from a straight move or an arc [m]; none for other moves.
fn distance(from: [f32; 2], next: &Move, point: [f32; 2]) -> Option<f32> {
    let apart = |[x, y]: [f32; 2]| (point[0] - x).hypot(point[1] - y);
    match next.kind {
        MoveKind::Line { to, .. } => {
            let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
            let square = dx * dx + dy * dy;
            let along = (point[0] - from[0]) * dx + (point[1] - from[1]) * dy;
            let share = (along / square.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            Some(apart([from[0] + share * dx, from[1] + share * dy]))
        }
        MoveKind::Arc {
            to,
            center,
            clockwise,
            ..
        } => {
            let angle = |[x, y]: [f32; 2]| (y - center[1]).atan2(x - center[0]);
            let sense = if clockwise { -1.0 } else { 1.0 };
            let turned = |at| (sense * (angle(at) - angle(from))).rem_euclid(TAU);
            let radius = (from[0] - center[0]).hypot(from[1] - center[1]);
            // An arc that ends where it begins is a whole circle.
            let is_beside = to == from || turned(point) <= turned(to);
            let ends = apart(from).min(apart(to));
            Some(if is_beside {
                (apart(center) - radius).abs()
            } else {
                ends
            })
        }
        MoveKind::Dwell { .. }
        | MoveKind::Joint { .. }
        | MoveKind::Timed(_)
        | MoveKind::Crossing(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_from_lines_and_arcs_is_that_of_their_nearest_point() {
        let of = |kind, point| {
            let (tag, tool) = (1, 1);
            distance([1.0, 0.0], &Move { tag, tool, kind }, point).unwrap()
        };
        let line = MoveKind::Line {
            to: [3.0, 0.0],
            feed: 1.0,
        };
        assert_eq!(
            [[2.0, 1.0], [0.0, 0.0], [5.0, 0.0]].map(|point| of(line, point)),
            [1.0, 1.0, 2.0]
        );
        for (clockwise, to, beside, behind) in [
            (false, [0.0, 1.0], [1.0, 1.0], [-2.0, 0.0]),
            (true, [0.0, -1.0], [1.0, -1.0], [-2.0, 0.0]),
        ] {
            let center = [0.0, 0.0];
            let arc = MoveKind::Arc {
                to,
                center,
                clockwise,
                feed: 1.0,
            };
            assert!((of(arc, beside) - (2.0_f32.sqrt() - 1.0)).abs() < 1e-6);
            assert!((of(arc, behind) - 5.0_f32.sqrt()).abs() < 1e-6);
            // Beside the other half.
            assert!((of(arc, [1.0, -beside[1]]) - 1.0).abs() < 1e-6);
            let circle = MoveKind::Arc {
                to: [1.0, 0.0],
                center,
                clockwise,
                feed: 1.0,
            };
            assert!((of(circle, behind) - 1.0).abs() < 1e-6);
        }
    }
}
