//! The places at which a hand let the tip rest: what a program needs that picks something up and puts it down.

use super::TaughtPath;
use std::fmt::Write as _;

/// How far the tip may be from where a rest began [m].
const STILL: f64 = 5e-4;
/// The shortest rest of a file of places [s].
pub const SHORTEST_REST: f64 = 0.5;

impl TaughtPath {
    /// The mean places of the tip [m] where it stayed within 0.5 mm for so long [s], in their order. The path begins and ends with
    /// such a place, because the record has no more of these rests than their last moment.
    pub fn rests(&self, least: f64) -> Vec<[f64; 2]> {
        let [Some(first), Some(last)] = [self.tip_m.first(), self.tip_m.last()] else {
            return Vec::new();
        };
        let knots = (least / self.knot_s).ceil().max(1.0) as usize;
        let mut rests = vec![*first];
        let mut begin = 0;
        while begin < self.tip_m.len() {
            let still = self.tip_m[begin..].iter();
            let count = still
                .take_while(|tip| distance(**tip, self.tip_m[begin]) <= STILL)
                .count();
            if count > knots {
                let places = &self.tip_m[begin..begin + count];
                let mean = [0, 1]
                    .map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / count as f64);
                push(&mut rests, mean);
                begin += count;
            } else {
                begin += 1;
            }
        }
        push(&mut rests, *last);
        rests
    }

    /// The places as a table: x and y [m].
    pub fn rests_to_csv(&self) -> String {
        let mut table = String::from("x_m,y_m\n");
        for [x, y] in self.rests(SHORTEST_REST) {
            // A String takes all that is written.
            let _ = writeln!(table, "{x:.6},{y:.6}");
        }
        table
    }
}

/// Adds a place, unless it is the last one again.
fn push(rests: &mut Vec<[f64; 2]>, place: [f64; 2]) {
    if rests
        .last()
        .is_none_or(|last| distance(*last, place) > STILL)
    {
        rests.push(place);
    }
}

fn distance([x, y]: [f64; 2], [to_x, to_y]: [f64; 2]) -> f64 {
    (to_x - x).hypot(to_y - y)
}

#[cfg(test)]
mod tests {
    use super::TaughtPath;

    /// A path with rests of so many knots of 10 ms at corners, and 20 knots between them.
    fn path(corners: &[([f64; 2], usize)]) -> TaughtPath {
        let mut tips = Vec::new();
        for (place, rest) in corners {
            let from = tips.last().copied().unwrap_or(*place);
            for step in 1..=20 {
                let share = f64::from(step) / 20.0;
                tips.push([0, 1].map(|axis| from[axis] + share * (place[axis] - from[axis])));
            }
            tips.extend(vec![*place; *rest]);
        }
        let points: Vec<String> = tips.iter().map(|[x, y]| format!("[{x}, {y}]")).collect();
        let text = format!(
            "{{\"taught_path\": 1, \"robot\": \"benchtop\", \"knot_s\": 0.01, \"tip_m\": [{}]}}",
            points.join(",")
        );
        TaughtPath::parse(&text).unwrap()
    }

    #[test]
    fn places_where_the_tip_rested_long_enough_are_told_in_their_order() {
        let corners = [
            [0.0, 0.15],
            [0.03, 0.15],
            [0.03, 0.18],
            [0.05, 0.18],
            [0.0, 0.15],
        ];
        // The third one is passed with a short stop.
        let taught = path(&[
            (corners[0], 5),
            (corners[1], 70),
            (corners[2], 30),
            (corners[3], 60),
            (corners[4], 5),
        ]);
        let found = taught.rests(0.5);
        let expected = [corners[0], corners[1], corners[3], corners[4]];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for ([x, y], [ex, ey]) in found.iter().zip(expected) {
            assert!((x - ex).hypot(y - ey) < 3e-4, "{found:?}");
        }
        assert_eq!(taught.rests(0.25).len(), 5);
        assert_eq!(taught.rests_to_csv().lines().count(), 5);
    }
}
