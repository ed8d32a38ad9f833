//! Blocks: entities that INSERT draws again, moved, scaled and turned.

use super::entity::Entity;

/// Most INSERT within each other.
const DEEPEST: usize = 16;
/// Most columns or rows of an INSERT.
const MOST_COPIES: f64 = 1000.0;

/// A block of a file.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub(super) name: &'a str,
    /// The point of the block that comes to that of the INSERT [the file's units].
    base: [f64; 2],
    pub(super) entities: &'a [Entity<'a>],
}

impl<'a> Block<'a> {
    /// The block that begins with this entity.
    pub(super) fn new(begin: &Entity<'a>, entities: &'a [Entity<'a>]) -> Result<Self, String> {
        let base = [begin.number(10)?, begin.number(20)?];
        Ok(Self {
            name: begin.text(2).unwrap_or_default(),
            base: base.map(|it| it.unwrap_or(0.0)),
            entities,
        })
    }
}

/// Where the points of a block lie: p becomes M p + t, in the file's units.
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    matrix: [[f64; 2]; 2],
    offset: [f64; 2],
    /// The layer that entities on layer 0 take.
    pub(super) layer: Option<&'a str>,
    depth: usize,
}

impl<'a> Frame<'a> {
    /// That of the drawing itself.
    pub(super) const DRAWING: Self = Self {
        matrix: [[1.0, 0.0], [0.0, 1.0]],
        offset: [0.0; 2],
        layer: None,
        depth: 0,
    };

    pub(super) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|row| self.matrix[row][0] * x + self.matrix[row][1] * y + self.offset[row])
    }

    /// The greatest factor by which a length grows, or more.
    pub(super) fn growth(&self) -> f64 {
        let [[a, b], [c, d]] = self.matrix;
        a.hypot(c).hypot(b.hypot(d))
    }

    /// The layer of an entity of the block.
    pub(super) fn layer_of(&self, entity: &Entity<'a>) -> &'a str {
        let own = entity.text(8).unwrap_or("0");
        match self.layer {
            Some(layer) if own == "0" => layer,
            _ => own,
        }
    }

    /// The columns and rows of an INSERT in this frame.
    pub(super) fn counts(&self, insert: &Entity<'a>) -> Result<[usize; 2], String> {
        if self.depth == DEEPEST {
            return Err(insert.wrong("its blocks contain themselves"));
        }
        let or = |code| Ok::<_, String>(insert.number(code)?.unwrap_or(1.0));
        let counts = [or(70)?, or(71)?];
        if counts.iter().any(|&count| count > MOST_COPIES) {
            return Err(insert.wrong("it has more than 1000 columns or rows"));
        }
        Ok(counts.map(|count| count.max(1.0) as usize))
    }

    /// The frames of the copies of a block that an INSERT in this frame draws. `mirrors`: its normal is −z.
    pub(super) fn copies(
        &self,
        insert: &Entity<'a>,
        block: &Block<'a>,
        [columns, rows]: [usize; 2],
        mirrors: bool,
    ) -> Result<impl Iterator<Item = Self>, String> {
        let or = |code, default| Ok::<_, String>(insert.number(code)?.unwrap_or(default));
        let steps = [or(44, 0.0)?, or(45, 0.0)?];
        let (sin, cos) = or(50, 0.0)?.to_radians().sin_cos();
        let [sx, sy] = [or(41, 1.0)?, or(42, 1.0)?];
        let at = [insert.needed(10)?, insert.needed(20)?];
        let side = if mirrors { -1.0 } else { 1.0 };
        // A point of the block in the frame of this one: turned, scaled and moved, then mirrored in x.
        let linear = [[side * cos * sx, -side * sin * sy], [sin * sx, cos * sy]];
        let (frame, base, layer) = (*self, block.base, self.layer_of(insert));
        let copy = move |index: usize| {
            let step = [
                (index % columns) as f64 * steps[0],
                (index / columns) as f64 * steps[1],
            ];
            let turned = [cos * step[0] - sin * step[1], sin * step[0] + cos * step[1]];
            let zero = [side * (at[0] + turned[0]), at[1] + turned[1]];
            let moved =
                [0, 1].map(|row| zero[row] - linear[row][0] * base[0] - linear[row][1] * base[1]);
            let part = |row: usize, column: usize| {
                frame.matrix[row][0] * linear[0][column] + frame.matrix[row][1] * linear[1][column]
            };
            Self {
                matrix: [[part(0, 0), part(0, 1)], [part(1, 0), part(1, 1)]],
                offset: frame.place(moved),
                layer: Some(layer),
                depth: frame.depth + 1,
            }
        };
        Ok((0..columns * rows).map(copy))
    }
}
