//! Where the tool was between two states, how far from its reference, and how fast.

use fivebar_firmware::Status;

/// Positions of the tool in one state.
const MOST: usize = 32;
/// Least time between two positions from which the speed is taken [s].
const LEAST_TIME: f32 = 4e-3;

/// The tool since the last state.
#[derive(Debug, Default)]
pub(super) struct Trail {
    /// x, y [m], level, error [m], speed [m/s].
    points: Vec<[f32; 5]>,
    /// The tick and the place from which the speed is taken [m].
    from: Option<(u32, [f32; 2])>,
    speed: f32,
}

impl Trail {
    /// Notes where the tool is; ticks come at `tick_rate` [Hz].
    pub(super) fn note(&mut self, status: &Status, tick_rate: f32) {
        let Some(tool) = status.tool else {
            self.from = None;
            return;
        };
        let way = |from: [f32; 2]| (tool[0] - from[0]).hypot(tool[1] - from[1]);
        match self.from {
            Some((tick, from)) => {
                let time = status.tick.wrapping_sub(tick) as f32 / tick_rate;
                if time >= LEAST_TIME {
                    self.speed = way(from) / time;
                    self.from = Some((status.tick, tool));
                }
            }
            None => {
                self.speed = 0.0;
                self.from = Some((status.tick, tool));
            }
        }
        if self.points.len() < MOST {
            let error = status.reference.map_or(0.0, way);
            let [x, y] = tool;
            self.points
                .push([x, y, status.tool_level, error, self.speed]);
        }
    }

    /// The points since the last call of [`Self::clear`].
    pub(super) fn points(&self) -> &[[f32; 5]] {
        &self.points
    }

    pub(super) fn clear(&mut self) {
        self.points.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST, Trail};
    use fivebar_firmware::{Controller, Settings};

    #[test]
    fn a_trail_has_error_and_speed_and_a_bounded_length() {
        let controller = Controller::new(&Settings::BENCHTOP.check().expect("valid settings"));
        let mut status = controller.status();
        let mut trail = Trail::default();
        for step in 0..100_u32 {
            let x = 1e-3 * step as f32;
            status.tick = 100 * step;
            (status.tool, status.reference) = (Some([x, 0.1]), Some([x, 0.1001]));
            trail.note(&status, 1e4);
        }
        assert_eq!(trail.points().len(), MOST);
        let [x, y, level, error, speed] = trail.points()[MOST - 1];
        assert!((x - 0.031).abs() < 1e-6 && y == 0.1 && level == 0.0);
        assert!(
            (error - 1e-4).abs() < 1e-6 && (speed - 0.1).abs() < 1e-4,
            "{error} {speed}"
        );
        trail.clear();
        assert!(trail.points().is_empty());
    }
}
