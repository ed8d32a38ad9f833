//! The law s(t) of a run averaged over T1 and once more over T2, at rising times.
//!
//! With Δ1, Δ2 the differences over T1 and T2,
//!
//! s̄ = Δ1Δ2 ∬s/(T1 T2), ṡ̄ = Δ1Δ2 ∫s/(T1 T2), s̈̄ = Δ1Δ2 s/(T1 T2), s⃛̄ = Δ1Δ2 ṡ/(T1 T2).

use super::grid::Solved;

/// ∬s, ∫s, s and ṡ.
type Integrals = [f64; 4];

/// A run in time: the integrals at its nodes, and s̈ between them.
pub(super) struct TimeLaw {
    t: Vec<f64>,
    at: Vec<Integrals>,
    u: Vec<f64>,
}

impl TimeLaw {
    pub(super) fn new(solved: &Solved<'_>) -> Self {
        let x = &solved.x;
        let (mut t, mut now) = (vec![0.0], [0.0; 4]);
        let (mut at, mut u) = (vec![now], Vec::new());
        for (cell, ends) in solved.grid.cells.iter().zip(x.windows(2)) {
            let rate = 0.5 * (ends[1] - ends[0]) / cell.w;
            let dt = 2.0 * cell.w / (ends[0].sqrt() + ends[1].sqrt());
            now = later(now, rate, dt);
            (now[2], now[3]) = (cell.s + cell.w, ends[1].sqrt());
            t.push(t[t.len() - 1] + dt);
            at.push(now);
            u.push(rate);
        }
        u.push(0.0);
        Self { t, at, u }
    }

    pub(super) fn duration(&self) -> f64 {
        self.t[self.t.len() - 1]
    }

    /// The times of the nodes, and s̈ before and after each.
    pub(super) fn jumps(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let before = std::iter::once(0.0).chain(self.u.iter().copied());
        let u = before.zip(&self.u).map(|(before, after)| [before, *after]);
        self.t.iter().copied().zip(u)
    }

    /// The integrals at `t`; `node` is that of an earlier time, and becomes that of this one.
    fn at(&self, t: f64, node: &mut usize) -> Integrals {
        if t <= 0.0 {
            return [0.0; 4];
        }
        while self.t.get(*node + 1).is_some_and(|&next| next <= t) {
            *node += 1;
        }
        later(self.at[*node], self.u[*node], t - self.t[*node])
    }
}

/// The integrals after dt at a constant s̈.
fn later([ss, is, s, v]: Integrals, u: f64, dt: f64) -> Integrals {
    [
        ss + dt * (is + dt * (s / 2.0 + dt * (v / 6.0 + dt * u / 24.0))),
        is + dt * (s + dt * (v / 2.0 + dt * u / 6.0)),
        s + dt * (v + dt * u / 2.0),
        v + dt * u,
    ]
}

/// The averages of a law at rising times.
pub(super) struct Averages<'a> {
    law: &'a TimeLaw,
    /// T1, T2 [s].
    windows: [f64; 2],
    nodes: [usize; 4],
}

impl<'a> Averages<'a> {
    pub(super) fn new(law: &'a TimeLaw, windows: [f64; 2]) -> Self {
        Self {
            law,
            windows,
            nodes: [0; 4],
        }
    }

    /// s̄, ṡ̄, s̈̄ and s⃛̄ at a time not before that of the last call.
    pub(super) fn at(&mut self, t: f64) -> [f64; 4] {
        let [t1, t2] = self.windows;
        let [n0, n1, n2, n3] = &mut self.nodes;
        let law = self.law;
        let (now, one) = (law.at(t, n0), law.at(t - t1, n1));
        let (two, both) = (law.at(t - t2, n2), law.at(t - t1 - t2, n3));
        [0, 1, 2, 3].map(|k| (now[k] - one[k] - two[k] + both[k]) / (t1 * t2))
    }
}
