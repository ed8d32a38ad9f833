//! Where joints turn back: Coulomb friction jumps there, so cells end there.

use super::error::PlanError;
use super::grid::Grid;

/// Most steps to the point where a joint turns back. The Illinois method's error falls with a power
/// of 1.44 a step, so a few reach [`LEAST_PART`].
const TURN_STEPS: usize = 12;
/// The narrowest part of a cell, as a share of it, and how near to the point of return the search
/// ends.
const LEAST_PART: f64 = 1e-6;

impl Grid<'_> {
    /// Appends a cell, cut where a joint turns back, and returns the index of the demand at its end. Coulomb
    /// friction jumps there, so that it is constant within each cell.
    pub(super) fn push(
        &mut self,
        piece: usize,
        s: f64,
        local: f64,
        w: f64,
        mut start: usize,
    ) -> Result<usize, PlanError> {
        let end = self.add(piece, local + w, s)?;
        let [q1, next_q1] = [start, end].map(|index| self.at(index).q1);
        let mut cuts = [0.0, 1.0, 1.0];
        for j in 0..2 {
            if q1[j] * next_q1[j] < 0.0 {
                cuts[j + 1] = self.turn(j, piece, [s, local, w], [q1[j], next_q1[j]])?;
            }
        }
        cuts.sort_by(f64::total_cmp);
        for k in 0..3 {
            let next = if k == 2 { 1.0 } else { cuts[k + 1] };
            let (from, width) = (cuts[k] * w, (next - cuts[k]) * w);
            if width > LEAST_PART * w {
                let (s, local) = (s + from, local + from);
                let next = if next < 1.0 {
                    self.add(piece, local + width, s)?
                } else {
                    end
                };
                let middle = self.add(piece, local + 0.5 * width, s)?;
                let cell = self.cell(piece, [s, local, width], [start, middle, next])?;
                self.cells.push(cell);
                start = next;
            }
        }
        Ok(end)
    }

    /// The share of a cell at which joint j turns back, by the Illinois method.
    fn turn(
        &self,
        j: usize,
        piece: usize,
        [s, local, w]: [f64; 3],
        [mut at_low, mut at_high]: [f64; 2],
    ) -> Result<f64, PlanError> {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..TURN_STEPS {
            let share = (low * at_high - high * at_low) / (at_high - at_low);
            let at = self.demand(piece, local + share * w, s)?.q1[j];
            if at * at_high < 0.0 {
                (low, at_low) = (high, at_high);
            } else {
                at_low *= 0.5;
            }
            (high, at_high) = (share, at);
            if at == 0.0 || (high - low).abs() < LEAST_PART {
                break;
            }
        }
        Ok(high)
    }
}
