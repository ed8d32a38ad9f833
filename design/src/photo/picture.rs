//! A picture in shades of grey.

use nalgebra::Vector2;

/// A picture in shades of grey, 0 black and 255 white. The middle of the pixel in column i and row j
/// lies at (i + ½, j + ½): x to the right, y down.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    grey: Vec<u8>,
}

impl Picture {
    /// The greys row by row from the top; none if they do not fill the size, or if there are none.
    pub fn new(width: usize, height: usize, grey: Vec<u8>) -> Option<Self> {
        let fits = width.checked_mul(height) == Some(grey.len()) && !grey.is_empty();
        fits.then_some(Self {
            width,
            height,
            grey,
        })
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The grey at a point, linear between the middles of pixels; none outside of them.
    pub(super) fn at(&self, point: Vector2<f64>) -> Option<f64> {
        let (x, y) = (point.x - 0.5, point.y - 0.5);
        let inside =
            x >= 0.0 && y >= 0.0 && x <= (self.width - 1) as f64 && y <= (self.height - 1) as f64;
        if !inside {
            return None;
        }
        let (column, row) = (x as usize, y as usize);
        let (u, v) = (x - column as f64, y - row as f64);
        let grey = |column: usize, row: usize| {
            let (column, row) = (column.min(self.width - 1), row.min(self.height - 1));
            f64::from(self.grey[row * self.width + column])
        };
        let upper = (1.0 - u) * grey(column, row) + u * grey(column + 1, row);
        let lower = (1.0 - u) * grey(column, row + 1) + u * grey(column + 1, row + 1);
        Some((1.0 - v) * upper + v * lower)
    }

    /// The picture with at most about `most` pixels, and how many pixels wide one of these was.
    pub(super) fn reduced(&self, most: usize) -> (Self, usize) {
        let factor = ((self.grey.len() as f64 / most as f64).sqrt().ceil() as usize).max(1);
        let (width, height) = (self.width / factor, self.height / factor);
        if factor == 1 || width == 0 || height == 0 {
            return (self.clone(), 1);
        }
        let mut grey = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let rows = row * factor..(row + 1) * factor;
                let sum: usize = rows
                    .flat_map(|row| {
                        let first = row * self.width + column * factor;
                        &self.grey[first..first + factor]
                    })
                    .map(|&grey| usize::from(grey))
                    .sum();
                grey.push((sum / (factor * factor)) as u8);
            }
        }
        let reduced = Self {
            width,
            height,
            grey,
        };
        (reduced, factor)
    }

    /// Which pixels are ink: darker than [`DARKER`] of the mean of their surroundings, so that a shadow
    /// over the paper is none.
    pub(super) fn ink(&self) -> Vec<bool> {
        let (width, height) = (self.width, self.height);
        // sums[(j, i)]: of all greys above row j and left of column i.
        let mut sums = vec![0_u64; (width + 1) * (height + 1)];
        for row in 0..height {
            let mut of_row = 0;
            for column in 0..width {
                of_row += u64::from(self.grey[row * width + column]);
                sums[(row + 1) * (width + 1) + column + 1] =
                    sums[row * (width + 1) + column + 1] + of_row;
            }
        }
        let reach = (width.max(height) / 32).max(4);
        let is_ink = |index: usize| {
            let (row, column) = (index / width, index % width);
            let (left, right) = (column.saturating_sub(reach), (column + reach).min(width));
            let (top, bottom) = (row.saturating_sub(reach), (row + reach).min(height));
            let corner = |row: usize, column: usize| sums[row * (width + 1) + column];
            let sum = corner(bottom, right) + corner(top, left)
                - corner(top, right)
                - corner(bottom, left);
            let mean = sum as f64 / ((right - left) * (bottom - top)) as f64;
            f64::from(self.grey[index]) < DARKER * mean
        };
        (0..width * height).map(is_ink).collect()
    }
}

/// The grey of ink as a share of that of its surroundings.
pub(super) const DARKER: f64 = 0.85;
