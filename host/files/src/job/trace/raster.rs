//! A picture as darkness: 0 is white, 1 is black. What lies beside it is white.

use crate::picture::Greys;

/// The longest side that is traced [pixels]: a pen of 0.3 mm draws 1000 lines in a large drawing.
const LONGEST: usize = 1500;
/// Steps of darkness that the search for a level compares.
const STEPS: usize = 256;

/// The darkness of pixels, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Raster {
    width: usize,
    height: usize,
    darkness: Vec<f32>,
}

impl Raster {
    pub(super) fn new(width: usize, height: usize, darkness: Vec<f32>) -> Self {
        debug_assert_eq!(darkness.len(), width * height);
        Self {
            width,
            height,
            darkness,
        }
    }

    /// The darkness of a picture, in which a square of pixels becomes one if it is very large; and the side of the square.
    pub(super) fn of(picture: &Greys) -> (Self, usize) {
        let [width, height] = picture.size;
        let side = width.max(height).div_ceil(LONGEST);
        let [columns, rows] = [width, height].map(|it| it.div_ceil(side));
        let mut darkness = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let [from_x, from_y] = [column, row].map(|it| it * side);
                let [to_x, to_y] = [(from_x + side).min(width), (from_y + side).min(height)];
                let mut sum = 0.0;
                for y in from_y..to_y {
                    for x in from_x..to_x {
                        sum += 255.0 - f32::from(picture.grey[y * width + x]);
                    }
                }
                let count = (to_x - from_x) * (to_y - from_y);
                darkness.push(sum / (255 * count) as f32);
            }
        }
        (Self::new(columns, rows, darkness), side)
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    pub(super) fn is_white(&self) -> bool {
        self.darkness.iter().all(|&dark| dark == 0.0)
    }

    /// The darkness of a pixel; 0 beside the picture.
    pub(super) fn at(&self, x: i64, y: i64) -> f32 {
        let is_inside = x >= 0 && y >= 0 && x < self.width as i64 && y < self.height as i64;
        match is_inside {
            true => self.darkness[y as usize * self.width + x as usize],
            false => 0.0,
        }
    }

    /// The darkness between the middles of four pixels [pixels from the upper left corner].
    pub(super) fn between(&self, [x, y]: [f64; 2]) -> f64 {
        let [x, y] = [x - 0.5, y - 0.5];
        // At the edge a pixel goes on as it is.
        let [x, y] = [
            x.clamp(0.0, (self.width - 1) as f64),
            y.clamp(0.0, (self.height - 1) as f64),
        ];
        let [column, row] = [x.floor(), y.floor()];
        let [u, v] = [x - column, y - row];
        let dark = |dx: i64, dy: i64| {
            let x = (column as i64 + dx).min(self.width as i64 - 1);
            let y = (row as i64 + dy).min(self.height as i64 - 1);
            f64::from(self.at(x, y))
        };
        let above = (1.0 - u) * dark(0, 0) + u * dark(1, 0);
        let below = (1.0 - u) * dark(0, 1) + u * dark(1, 1);
        (1.0 - v) * above + v * below
    }

    /// The level that divides the pixels into two groups with the least spread within them (N. Otsu, 1979).
    pub(super) fn middle_level(&self) -> f64 {
        let mut counts = [0.0; STEPS];
        for &dark in &self.darkness {
            counts[((dark * (STEPS - 1) as f32).round() as usize).min(STEPS - 1)] += 1.0;
        }
        let all: f64 = counts.iter().sum();
        let total: f64 = counts
            .iter()
            .enumerate()
            .map(|(step, count)| step as f64 * count)
            .sum();
        let (mut below, mut sum) = (0.0, 0.0);
        let mut best = (0.0, 0..=0);
        for (step, count) in counts.iter().enumerate() {
            below += count;
            sum += step as f64 * count;
            let above = all - below;
            if below == 0.0 || above == 0.0 {
                continue;
            }
            let apart = sum / below - (total - sum) / above;
            let between = below * above * apart * apart;
            // Between two groups that are far apart, each level is as good: the middle of them is taken.
            if between > best.0 * (1.0 + 1e-12) {
                best = (between, step..=step);
            } else if between >= best.0 * (1.0 - 1e-12) && *best.1.end() + 1 == step {
                best.1 = *best.1.start()..=step;
            }
        }
        let (_, steps) = best;
        (0.5 * (*steps.start() + *steps.end()) as f64 + 0.5) / (STEPS - 1) as f64
    }

    /// The picture with the darkness `level` as half black, by a power that keeps white and black.
    pub(super) fn with_half_ink_at(&self, level: f64) -> Self {
        let power = (0.5_f64.ln() / level.ln()) as f32;
        let darkness = self.darkness.iter().map(|dark| dark.powf(power));
        Self::new(self.width, self.height, darkness.collect())
    }

    /// The mean darkness of a box [pixels from the upper left corner], of which what lies beside the picture is white.
    pub(super) fn mean(&self, [from_x, from_y]: [f64; 2], side: f64) -> f64 {
        let shares = |from: f64, most: usize| {
            let to = (from + side).min(most as f64);
            let first = from.floor() as usize;
            let end = (to.ceil().max(0.0) as usize).min(most);
            (first..end).map(move |at| (at, to.min((at + 1) as f64) - from.max(at as f64)))
        };
        let mut sum = 0.0;
        for (y, high) in shares(from_y, self.height) {
            for (x, wide) in shares(from_x, self.width) {
                sum += high * wide * f64::from(self.darkness[y * self.width + x]);
            }
        }
        sum / (side * side)
    }
}
