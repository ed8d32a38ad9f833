//! The cells of a path: even ones at first, then finer where a limit is passed between nodes.

use super::demand::{Demand, DrivenArm};
use super::error::PlanError;
use super::limits::PlanLimits;
use super::passes::Cells;
use super::path::PathPiece;
use super::strip::MOST_PASSES;

/// Fewest first cells between two even points: the even point is a node, and the cell on either side
/// of it shows a change.
const CELLS_PER_EVEN_POINT: usize = 2;
/// Fewest first cells of a piece of the path: a short arc between two even points is resolved, too.
const CELLS_PER_PIECE: f64 = 16.0;
/// The angle by which the path turns within a first cell at most, nearly [rad]: 126 cells in a full
/// circle. The chord of such a cell is shorter than its arc by 0.05²/24, about 1e-4 of it.
const TURNING: f64 = 0.05;
/// The relative excess of a limit above which a cell is split. It is below [`ACCEPTED`], so that a
/// round also splits the cells that the next round would find just above that.
const SPLIT_ABOVE: f64 = 3.5e-3;
/// The relative excess of a limit at which the splitting ends if no cell is above it.
const ACCEPTED: f64 = 4.5e-3;
/// Most parts of a cell in one round: the excess falls with the width only where the cells are
/// narrow, so a wide one is split again in the next round instead.
const MOST_PARTS: f64 = 8.0;
/// Most rounds of splitting. They bound the time; most paths need fewer.
const ROUNDS: usize = 8;
/// Most cells per first cell: splitting ends beyond. It bounds time and memory.
const MOST_CELLS: usize = 16;
/// Most first cells of a run: planning them takes up to 2.5 GB.
const MOST_FIRST: usize = 1_000_000;
/// Memory is reserved for so many cells per first cell at once: it costs time when it is first
/// written, and again when it grows.
const RESERVED_CELLS: usize = 3;
/// Passes before the first split. The viscous term starts from x = 0: the second pass is the first
/// with a real estimate of it.
const FIRST_PASSES: usize = 2;
/// Passes before each later split, which start from the x of the coarser cells: the viscous term
/// need not be exact there.
const NEXT_PASSES: usize = 1;
/// Largest difference of the tangents of two pieces between which the run does not stop, relative.
const KINK: f64 = 1e-4;
/// |C′| as a share of that beside it, at most which the path has a cusp.
const CUSP: f64 = 1e-6;
/// A bound for x in units of length²/s² where no limit bounds it.
const FASTEST: f64 = 1e12;

/// [s, s + w] on one piece, with the indices of its demands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) piece: usize,
    /// s of the path, and of the piece.
    pub(super) s: f64,
    local: f64,
    pub(super) w: f64,
    pub(super) start: usize,
    pub(super) middle: usize,
    pub(super) end: usize,
}

/// A path in cells.
pub(super) struct Grid<'a> {
    arm: &'a DrivenArm,
    limits: &'a PlanLimits,
    pieces: &'a [PathPiece],
    length: f64,
    even_points: usize,
    pub(super) cells: Vec<Cell>,
    /// Cells that meet share a demand, and keep it when they are split.
    demands: Vec<Demand>,
}

/// A grid with x at its nodes, and the passes that gave it.
pub(super) struct Solved<'a> {
    pub(super) grid: Grid<'a>,
    pub(super) x: Vec<f64>,
    problem: Cells,
}

impl Solved<'_> {
    /// Plans again with x at the nodes at most at `caps`.
    pub(super) fn solve_below(&mut self, caps: &[f64]) {
        for (ceiling, cap) in self.problem.ceiling.iter_mut().zip(caps) {
            *ceiling = ceiling.min(*cap);
        }
        self.problem.solve(&mut self.x, MOST_PASSES);
    }
}

impl<'a> Grid<'a> {
    /// Cells whose nodes hold the even points and the ends of the pieces.
    pub(super) fn new(
        arm: &'a DrivenArm,
        limits: &'a PlanLimits,
        pieces: &'a [PathPiece],
        even_points: usize,
    ) -> Result<Self, PlanError> {
        let cells = CELLS_PER_EVEN_POINT * (even_points + pieces.len());
        let mut grid = Self {
            arm,
            limits,
            pieces,
            length: Self::length_of(pieces),
            even_points,
            cells: Vec::with_capacity(cells),
            demands: Vec::with_capacity(2 * RESERVED_CELLS * cells),
        };
        let close = 1e-9 * grid.length;
        let (mut begin, mut k) = (0.0, 0);
        for (n, piece) in pieces.iter().enumerate() {
            let last = n + 1 == pieces.len();
            let end = if last {
                grid.length
            } else {
                begin + piece.length()
            };
            let mut s = begin;
            let mut start = grid.add(n, 0.0, s)?;
            while s < end {
                while grid.even_point(k) <= s + close {
                    k += 1;
                }
                let even = grid.even_point(k);
                let next = if even >= end - close { end } else { even };
                let turning = piece.turning(s - begin, next - begin) / TURNING;
                let of_piece = CELLS_PER_PIECE * (next - s) / piece.length();
                let count = CELLS_PER_EVEN_POINT.max(turning.max(of_piece).ceil() as usize);
                if count > MOST_FIRST - grid.cells.len() {
                    return Err(PlanError::Long(s));
                }
                let w = (next - s) / count as f64;
                for j in 0..count {
                    let s = s + w * j as f64;
                    start = grid.push(n, s, s - begin, w, start)?;
                }
                s = next;
            }
            begin = end;
        }
        Ok(grid)
    }

    /// The length of a path.
    pub(super) fn length_of(pieces: &[PathPiece]) -> f64 {
        pieces.iter().map(PathPiece::length).sum()
    }

    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// s of the k-th even point.
    pub(super) fn even_point(&self, k: usize) -> f64 {
        self.length * k as f64 / (self.even_points - 1) as f64
    }

    /// The demand of an index.
    pub(super) fn at(&self, index: usize) -> &Demand {
        &self.demands[index]
    }

    /// Keeps the demand at a point of a piece, and returns its index.
    pub(super) fn add(&mut self, piece: usize, local: f64, s: f64) -> Result<usize, PlanError> {
        let demand = self.demand(piece, local, s)?;
        self.demands.push(demand);
        Ok(self.demands.len() - 1)
    }

    /// The same demand with the Coulomb friction of another.
    fn with_coulomb(&mut self, index: usize, other: usize) -> usize {
        let demand = Demand {
            coulomb: self.demands[other].coulomb,
            ..self.demands[index]
        };
        if demand.coulomb == self.demands[index].coulomb {
            return index;
        }
        self.demands.push(demand);
        self.demands.len() - 1
    }

    pub(super) fn demand(&self, piece: usize, local: f64, s: f64) -> Result<Demand, PlanError> {
        let point = self.pieces[piece].at(local);
        let demand = self.arm.demand(&point);
        demand.map_err(|error| PlanError::Pose(s, error))
    }

    /// The cell between two demands, about a third one.
    pub(super) fn cell(
        &mut self,
        piece: usize,
        [s, local, w]: [f64; 3],
        [start, middle, end]: [usize; 3],
    ) -> Result<Cell, PlanError> {
        let [start, end] = [start, end].map(|index| self.with_coulomb(index, middle));
        let demands = [start, middle, end].map(|index| self.at(index));
        let [a, b, c] = demands.map(|at| at.tangent.norm());
        if a.min(b).min(c) <= CUSP * a.max(b).max(c) {
            return Err(PlanError::Cusp(s));
        }
        let [first, others @ ..] = demands.map(|at| at.sin32);
        if others.iter().any(|sine| sine * first <= 0.0) {
            return Err(PlanError::Crosses(s));
        }
        Ok(Cell {
            piece,
            s,
            local,
            w,
            start,
            middle,
            end,
        })
    }

    /// x at the nodes, on cells that are split until no limit is passed by much.
    pub(super) fn solve(mut self) -> Result<Solved<'a>, PlanError> {
        let most = MOST_CELLS * self.cells.len();
        let mut problem = Cells::with_capacity(RESERVED_CELLS * self.cells.len());
        self.fill(&mut problem)?;
        let mut x = vec![0.0; self.cells.len() + 1];
        problem.solve(&mut x, FIRST_PASSES);
        for _ in 0..ROUNDS {
            let Some(guess) = self.split(&x)? else { break };
            x = guess;
            self.fill(&mut problem)?;
            problem.solve(&mut x, NEXT_PASSES);
            if self.cells.len() > most {
                break;
            }
        }
        problem.solve(&mut x, MOST_PASSES);
        Ok(Solved {
            grid: self,
            x,
            problem,
        })
    }

    /// Splits the cells at whose ends a limit is passed, and gives x at the new nodes; none if
    /// there is no need. The excess falls with the width, so a cell is split in proportion.
    fn split(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, PlanError> {
        let excesses = self.cells.iter().zip(x.windows(2));
        let excesses: Vec<f64> = excesses
            .map(|(cell, ends)| self.excess(cell, ends[0], ends[1]))
            .collect();
        if excesses.iter().all(|excess| *excess <= ACCEPTED) {
            return Ok(None);
        }
        let parts = |excess: f64| (excess / SPLIT_ABOVE).ceil().clamp(1.0, MOST_PARTS) as usize;
        let count = excesses.iter().map(|excess| parts(*excess)).sum();
        let whole = std::mem::replace(&mut self.cells, Vec::with_capacity(count));
        let mut guess = Vec::with_capacity(count + 1);
        guess.push(x[0]);
        for ((cell, ends), excess) in whole.iter().zip(x.windows(2)).zip(excesses) {
            let parts = parts(excess);
            self.cut(cell, parts)?;
            let step = (ends[1] - ends[0]) / parts as f64;
            guess.extend((1..parts).map(|part| ends[0] + step * part as f64));
            guess.push(ends[1]);
        }
        Ok(Some(guess))
    }

    /// Appends a cell in even parts. The demand of its middle is one of theirs.
    fn cut(&mut self, whole: &Cell, parts: usize) -> Result<(), PlanError> {
        if parts == 1 {
            self.cells.push(*whole);
            return Ok(());
        }
        let piece = whole.piece;
        // In halves of a part, from the beginning.
        let half = 0.5 * whole.w / parts as f64;
        let demand = |grid: &mut Self, halves: usize| match halves {
            0 => Ok(whole.start),
            halves if halves == parts => Ok(whole.middle),
            halves if halves == 2 * parts => Ok(whole.end),
            halves => {
                let offset = half * halves as f64;
                grid.add(piece, whole.local + offset, whole.s + offset)
            }
        };
        let mut start = whole.start;
        for part in 0..parts {
            let offset = 2.0 * half * part as f64;
            let middle = demand(self, 2 * part + 1)?;
            let end = demand(self, 2 * part + 2)?;
            let span = [whole.s + offset, whole.local + offset, 2.0 * half];
            let cell = self.cell(piece, span, [start, middle, end])?;
            self.cells.push(cell);
            start = end;
        }
        Ok(())
    }

    /// Writes the rows and bounds of all cells.
    fn fill(&self, problem: &mut Cells) -> Result<(), PlanError> {
        problem.width.clear();
        problem.ceiling.clear();
        problem.rows.clear();
        let mut last: Option<&Cell> = None;
        for cell in &self.cells {
            let before = problem.rows.len();
            let drives = self.arm.drives();
            self.limits
                .rows(self.at(cell.middle), drives, &mut problem.rows);
            let rows = &problem.rows[before..];
            problem.per_cell = rows.len();
            if rows.iter().any(|row| row.c.abs() >= row.limit) {
                return Err(PlanError::CannotStand(cell.s));
            }
            problem.width.push(cell.w);
            problem.ceiling.push(self.ceiling(last, cell));
            last = Some(cell);
        }
        problem.ceiling.push(0.0);
        Ok(())
    }

    /// The greatest x where a cell begins.
    fn ceiling(&self, last: Option<&Cell>, cell: &Cell) -> f64 {
        let Some(last) = last else { return 0.0 };
        let ends = [last.end, cell.start].map(|index| self.at(index));
        let kink = (ends[0].tangent - ends[1].tangent).norm();
        if kink > KINK * ends[1].tangent.norm() {
            return 0.0;
        }
        let fastest = FASTEST * self.length * self.length;
        let ends = ends.map(|at| self.limits.ceiling(at));
        ends[0].min(ends[1]).min(fastest)
    }

    /// The greatest share of a limit that a motion uses at the demand of an index; 1 is at the limit.
    pub(super) fn used(&self, index: usize, x: f64, u: f64) -> f64 {
        self.used_at(self.at(index), x, u)
    }

    /// As [`Self::used`], of any demand.
    pub(super) fn used_at(&self, at: &Demand, x: f64, u: f64) -> f64 {
        self.limits.used(at, self.arm.drives(), x, u)
    }

    /// Most by which a limit is passed within a cell with x at its ends, relative.
    pub(super) fn excess(&self, cell: &Cell, x: f64, next: f64) -> f64 {
        let u = 0.5 * (next - x) / cell.w;
        let middle = 0.5 * (x + next);
        let used = self
            .used(cell.start, x, u)
            .max(self.used(cell.end, next, u));
        used.max(self.used(cell.middle, middle, u)) - 1.0
    }

    /// The demand at s of the path, between those of its cell, and q‴; `cell` is the index for an earlier
    /// point, and becomes that of this one.
    pub(super) fn between(&self, s: f64, cell: &mut usize) -> (Demand, [f64; 2]) {
        while self.cells.get(*cell + 1).is_some_and(|next| next.s <= s) {
            *cell += 1;
        }
        let cell = &self.cells[*cell];
        let ends = [cell.start, cell.middle, cell.end].map(|index| self.at(index));
        let share = (s - cell.s) / cell.w;
        let weights = [4.0 * share - 3.0, 4.0 - 8.0 * share, 4.0 * share - 1.0];
        let q3 = [0, 1].map(|j| {
            let terms = [0, 1, 2].map(|k| weights[k] * ends[k].q2[j]);
            terms.iter().sum::<f64>() / cell.w
        });
        (Demand::between(ends, share), q3)
    }

    /// As [`PlanLimits::pace`].
    pub(super) fn pace(&self, at: &Demand, rate: f64, u: f64) -> f64 {
        self.limits.pace(at, self.arm.drives(), rate, u)
    }

    /// s of a node where the curvature jumps while the arm moves.
    pub(super) fn curvature_jump(&self, x: &[f64]) -> Option<f64> {
        let pairs = self.cells.windows(2).zip(&x[1..]);
        let jump = pairs.filter(|(_, x)| **x > 0.0).find(|(pair, _)| {
            let ends = [pair[0].end, pair[1].start];
            let [one, other] = ends.map(|index| self.at(index).curvature);
            (one - other).norm() > KINK * (one.norm() + other.norm())
        });
        jump.map(|(pair, _)| pair[1].s)
    }
}
