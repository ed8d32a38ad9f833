//! Arcs, wedges, rectangles and curves of a plot, as lines.

use super::Plot;
use crate::job::motion::within_reach;
use std::f64::consts::TAU;

/// Least and most lines of an arc or a curve of Bézier.
const LEAST_LINES: f64 = 8.0;
/// Points whose triangle is flatter than this share of its side's square lie on a line.
const FLAT: f64 = 1e-9;

impl Plot {
    /// An arc about a centre by an angle [degrees], counter-clockwise, as lines.
    pub(super) fn arc(&mut self, middle: [f64; 2], angle: f64, draws: bool) -> Result<(), String> {
        let [x, y] = [self.at[0] - middle[0], self.at[1] - middle[1]];
        let metres = x.hypot(y) * self.scale[0].abs().max(self.scale[1].abs());
        within_reach(metres).map_err(|error| error.to_string())?;
        let sweep = angle.clamp(-360.0, 360.0) / 360.0 * TAU;
        // The sagitta of a chord over 2a is r (1 − cos a) ≤ r a²/2.
        let half = (2.0 * self.tolerance / metres.max(self.tolerance)).sqrt();
        let count = match draws {
            true => (sweep.abs() / (2.0 * half)).ceil().max(LEAST_LINES),
            false => 1.0,
        };
        for step in 1..=count as u32 {
            let (sin, cos) = (sweep * f64::from(step) / count).sin_cos();
            let to = [middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y];
            self.line(to, draws)?;
        }
        Ok(())
    }

    /// The arc from the position through a point to an end. If the end is the position, it is a circle, whose
    /// diameter is that to the point; if the point is an end, or lies between them, it is a line.
    pub(super) fn arc_through(&mut self, by: [f64; 2], to: [f64; 2]) -> Result<(), String> {
        let from = self.at;
        if to == from {
            let middle = [0, 1].map(|axis| 0.5 * (from[axis] + by[axis]));
            return self.arc(middle, 360.0, self.is_down);
        }
        // b and c from `from`; the centre has the same distance from all three.
        let [bx, by] = [0, 1].map(|axis| by[axis] - from[axis]);
        let [cx, cy] = [0, 1].map(|axis| to[axis] - from[axis]);
        let [bb, cc] = [bx * bx + by * by, cx * cx + cy * cy];
        let doubled = 2.0 * (bx * cy - by * cx);
        if doubled.abs() <= FLAT * bb.max(cc) {
            let along = (bx * cx + by * cy) / cc;
            if (0.0..=1.0).contains(&along) {
                return self.line(to, self.is_down);
            }
            return Err(
                "its three points lie on a line, so that no arc passes through them".into(),
            );
        }
        let middle = [
            from[0] + (cy * bb - by * cc) / doubled,
            from[1] + (bx * cc - cx * bb) / doubled,
        ];
        let angle = |[x, y]: [f64; 2]| (y - middle[1]).atan2(x - middle[0]);
        let swept = (angle(to) - angle(from)).rem_euclid(TAU);
        // Counter-clockwise if the point lies right of the chord.
        let swept = if doubled > 0.0 { swept } else { swept - TAU };
        self.arc(middle, swept.to_degrees(), self.is_down)?;
        self.at = to;
        Ok(())
    }

    /// The edge of a wedge about the position [degrees]. The pen goes back to the position.
    pub(super) fn wedge(&mut self, radius: f64, start: f64, sweep: f64) -> Result<(), String> {
        let middle = self.at;
        let (sin, cos) = start.to_radians().sin_cos();
        self.is_open = false;
        self.line([middle[0] + radius * cos, middle[1] + radius * sin], true)?;
        self.arc(middle, sweep, true)?;
        self.line(middle, true)?;
        self.is_open = false;
        Ok(())
    }

    /// Cubic curves of Bézier, each by two controls and its end.
    pub(super) fn curves(&mut self, numbers: &[f64], is_relative: bool) -> Result<(), String> {
        for curve in numbers.chunks_exact(6) {
            let from = self.at;
            let zero = if is_relative { from } else { [0.0; 2] };
            let point = |index: usize| [zero[0] + curve[index], zero[1] + curve[index + 1]];
            let [first, second, to] = [point(0), point(2), point(4)];
            // A curve differs from the chord of an interval h by at most h²/8 · |B″|.
            let scale = self.scale[0].abs().max(self.scale[1].abs());
            let bend = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
                scale * (a[0] - 2.0 * b[0] + c[0]).hypot(a[1] - 2.0 * b[1] + c[1])
            };
            let bend = 6.0 * bend(from, first, second).max(bend(first, second, to));
            let count = (bend / (8.0 * self.tolerance)).sqrt().max(LEAST_LINES);
            within_reach(bend).map_err(|error| error.to_string())?;
            let count = if self.is_down { count.ceil() } else { 1.0 };
            for step in 1..=count as u32 {
                let t = f64::from(step) / count;
                let s = 1.0 - t;
                let to = [0, 1].map(|axis| {
                    s * s * (s * from[axis] + 3.0 * t * first[axis])
                        + t * t * (3.0 * s * second[axis] + t * to[axis])
                });
                self.line(to, self.is_down)?;
            }
            self.at = to;
        }
        Ok(())
    }

    /// A rectangle from the position to the opposite corner. The pen goes back to where it was.
    pub(super) fn rectangle(&mut self, [x, y]: [f64; 2]) -> Result<(), String> {
        let [left, low] = self.at;
        self.is_open = false;
        for to in [[x, low], [x, y], [left, y], [left, low]] {
            self.line(to, true)?;
        }
        self.is_open = false;
        Ok(())
    }
}
