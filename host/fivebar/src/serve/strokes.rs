//! The strokes of a path, thinned so that their message stays small however long the job is.

use super::wire::message::Stroke;

/// Greatest length of the chords of a drawn arc while few points are drawn [m].
const CHORD: f32 = 1e-3;
/// Least distance between points once they are thinned [m].
const FIRST_SPACING: f32 = 1e-4;
/// Points after which the path is thinned.
const MAX_POINTS: usize = 10_000;

/// A path that grows point by point. Up to [`MAX_POINTS`] all points are kept. Beyond them
/// points nearer than a spacing to the last one are dropped, and strokes shorter than it; the
/// spacing doubles whenever there are too many again.
#[derive(Debug, Default)]
pub(super) struct Strokes {
    strokes: Vec<Stroke>,
    points: usize,
    spacing: f32,
    /// The latest point, if it is nearer than the spacing to the last one kept.
    held: Option<[f32; 2]>,
}

impl Strokes {
    /// Greatest length of an arc's chords now [m].
    pub(super) fn chord(&self) -> f32 {
        CHORD.max(self.spacing)
    }

    /// The following points have the pen `down` or up; the path is at `from`.
    pub(super) fn pen(&mut self, down: bool, from: [f32; 2]) {
        if self.strokes.last().is_none_or(|stroke| stroke.down != down) {
            self.end_stroke();
            self.strokes.push(Stroke {
                down,
                points: vec![from],
            });
            self.count_point();
        }
    }

    /// Adds a point.
    pub(super) fn push(&mut self, point: [f32; 2]) {
        let Some(stroke) = self.strokes.last_mut() else {
            return;
        };
        let near = stroke.points.last();
        if near.is_some_and(|last| distance(*last, point) < self.spacing) {
            self.held = Some(point);
            return;
        }
        self.held = None;
        stroke.points.push(point);
        self.count_point();
    }

    fn count_point(&mut self) {
        self.points += 1;
        while self.points > MAX_POINTS {
            self.thin();
        }
    }

    /// All strokes.
    pub(super) fn finish(mut self) -> Vec<Stroke> {
        self.end_stroke();
        self.strokes
    }

    fn end_stroke(&mut self) {
        if let (Some(end), Some(stroke)) = (self.held.take(), self.strokes.last_mut()) {
            stroke.points.push(end);
            self.points += 1;
        }
    }

    fn thin(&mut self) {
        self.spacing = (2.0 * self.spacing).max(FIRST_SPACING);
        let current = self.strokes.pop();
        self.strokes
            .retain_mut(|stroke| thin(&mut stroke.points, self.spacing));
        if let Some(mut stroke) = current {
            thin(&mut stroke.points, self.spacing);
            self.strokes.push(stroke);
        }
        self.points = self.strokes.iter().map(|stroke| stroke.points.len()).sum();
        self.strokes.shrink_to_fit();
    }
}

/// Drops points nearer than `spacing` to the one kept before them; keeps both ends. Returns
/// whether the stroke leaves a circle of that radius about its start.
/// The lower left and the upper right corner of what strokes draw [m]; none if the pen is up in all of them.
pub(super) fn drawn_box(strokes: &[Stroke]) -> Option<[[f32; 2]; 2]> {
    let drawn = strokes.iter().filter(|stroke| stroke.down);
    let points = drawn.flat_map(|stroke| &stroke.points);
    points.fold(None, |corners, &point| {
        let [least, greatest] = corners.unwrap_or([point; 2]);
        let by_axis = |pick: fn(f32, f32) -> f32, corner: [f32; 2]| {
            [pick(corner[0], point[0]), pick(corner[1], point[1])]
        };
        Some([by_axis(f32::min, least), by_axis(f32::max, greatest)])
    })
}

fn thin(points: &mut Vec<[f32; 2]>, spacing: f32) -> bool {
    let Some((&first, &end)) = points.first().zip(points.last()) else {
        return false;
    };
    let long = points
        .iter()
        .any(|&point| distance(first, point) >= spacing);
    let mut kept = first;
    points.retain(|&point| {
        let keep = point == first || distance(kept, point) >= spacing;
        if keep {
            kept = point;
        }
        keep
    });
    if kept != end {
        points.push(end);
    }
    points.dedup();
    points.shrink_to_fit();
    long
}

fn distance([x1, y1]: [f32; 2], [x2, y2]: [f32; 2]) -> f32 {
    (x2 - x1).hypot(y2 - y1)
}

#[cfg(test)]
mod tests {
    use super::{MAX_POINTS, Strokes, distance};

    #[test]
    fn a_short_path_keeps_every_point() {
        let mut strokes = Strokes::default();
        strokes.pen(false, [0.0, 0.0]);
        strokes.push([0.1, 0.0]);
        strokes.pen(true, [0.1, 0.0]);
        strokes.push([0.1, 0.000_01]);
        strokes.push([0.1, 0.0]);
        let strokes = strokes.finish();
        let lengths: Vec<usize> = strokes.iter().map(|stroke| stroke.points.len()).collect();
        assert_eq!(lengths, [2, 3]);
    }

    #[test]
    fn a_path_of_a_million_points_is_thinned_and_keeps_its_shape() {
        let mut strokes = Strokes::default();
        let at = |index: u32| {
            let angle = index as f32 * 1e-4;
            [0.1 * angle.cos(), 0.1 * angle.sin()]
        };
        strokes.pen(true, at(0));
        (1..1_000_000).for_each(|index| strokes.push(at(index)));
        let spacing = strokes.spacing;
        let strokes = strokes.finish();
        let points = &strokes[0].points;
        assert_eq!(strokes.len(), 1);
        assert!(
            points.len() <= MAX_POINTS + 1 && spacing < 0.02,
            "{spacing}"
        );
        assert_eq!(points.last(), Some(&at(999_999)));
        for index in 0..63 {
            let place = at(1000 * index);
            let nearest = points.iter().map(|&point| distance(point, place));
            let nearest = nearest.fold(f32::MAX, f32::min);
            assert!(nearest <= spacing, "{nearest} m from the path");
        }
    }

    #[test]
    fn a_path_of_a_million_strokes_is_thinned() {
        let mut strokes = Strokes::default();
        let mut at = [0.0, 0.0];
        for index in 0..1_000_000_u32 {
            strokes.pen(index % 2 == 0, at);
            at = [1e-5 * (index % 7) as f32, 1e-7 * index as f32];
            strokes.push(at);
        }
        let points = strokes
            .finish()
            .into_iter()
            .map(|stroke| stroke.points.len());
        assert!(points.sum::<usize>() <= MAX_POINTS + 1);
    }
}
