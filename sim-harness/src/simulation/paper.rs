//! Paper that grows after it was drawn on.
//!
//! p' = p₀ + (1 + g) (p − p₀), in x and in y: what is drawn at p is seen at p', with the paper held where the pen first
//! comes down, at p₀.

/// A sheet under the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Paper {
    /// g in x and y.
    growth: [f64; 2],
    /// p₀ [m]; none before the pen comes down.
    held: Option<[f64; 2]>,
}

impl Paper {
    pub(super) fn that_grows(growth: [f64; 2]) -> Self {
        Self { growth, held: None }
    }

    /// Where the tool is seen on the paper [m] that is at `tool` with the pen down or up. With the pen up nothing is drawn,
    /// and it is where it is.
    pub(super) fn seen(&mut self, tool: [f64; 2], is_down: bool) -> [f64; 2] {
        if !is_down {
            return tool;
        }
        let held = *self.held.get_or_insert(tool);
        [0, 1].map(|i| tool[i] + self.growth[i] * (tool[i] - held[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::Paper;

    #[test]
    fn what_is_drawn_grows_about_the_first_point_and_what_is_not_drawn_stays() {
        let mut paper = Paper::that_grows([0.01, -0.02]);
        assert_eq!(paper.seen([0.3, 0.3], false), [0.3, 0.3]);
        assert_eq!(paper.seen([0.1, 0.2], true), [0.1, 0.2]);
        let [x, y] = paper.seen([0.2, 0.4], true);
        assert!((x - 0.201).abs() < 1e-15 && (y - 0.396).abs() < 1e-15);
        assert_eq!(paper.seen([0.2, 0.4], false), [0.2, 0.4]);
        let mut still = Paper::default();
        still.seen([0.1, 0.2], true);
        assert_eq!(still.seen([0.2, 0.4], true), [0.2, 0.4]);
    }
}
