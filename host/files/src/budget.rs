//! How much a file may ask for: a short file can describe a drawing of any size, so points, lines, values and
//! pixels are counted before memory is taken for them.
//!
//! The limits stand here together. With each of them at its end, a file is read with less than 1 GiB of memory
//! and 5 s of a processor.

/// Most points of a drawing, and most steps of a job in G-code.
const MOST_POINTS: usize = 1_000_000;
/// Most crossings of the lines of a hatch with outlines.
#[cfg(feature = "svg")]
const MOST_CROSSINGS: usize = 400_000;
/// Most steps along the outlines of lines, where they are calculated: each takes about 1 µs of a processor.
#[cfg(feature = "svg")]
const MOST_STEPS: usize = 3_000_000;
/// Most lines of a job in G-code.
const MOST_LINES: usize = 1_000_000;
/// Most groups of a DXF, each of two lines.
const MOST_GROUPS: usize = 4_000_000;
/// Most nodes of an SVG: its elements, texts and comments.
#[cfg(feature = "svg")]
pub(crate) const MOST_NODES: u32 = 500_000;
/// Most values of a table: ten minutes of a log of eight columns at 10 kHz.
const MOST_VALUES: usize = 48_000_000;
/// Most pixels of a picture: a progressive JPEG takes ten bytes for each.
const MOST_PIXELS: usize = 80_000_000;
/// Most pixels of a picture that becomes a job: its text is in memory beside them.
const MOST_TRACED: usize = 40_000_000;
/// Most dots of a picture, and most runs of its lines.
const MOST_DOTS: usize = 200_000;

/// What remains of a limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Budget {
    left: usize,
    over: OverBudget,
}

/// A file asks for more than its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("more than {most} {what} are asked for: {remedy}")]
pub struct OverBudget {
    most: usize,
    what: &'static str,
    remedy: &'static str,
}

impl Budget {
    fn new(most: usize, what: &'static str, remedy: &'static str) -> Self {
        Self {
            left: most,
            over: OverBudget { most, what, remedy },
        }
    }

    /// The points of a drawing or of a job.
    pub(crate) fn points() -> Self {
        let remedy = "simplify the drawing, or draw its parts one by one";
        Self::new(MOST_POINTS, "points", remedy)
    }

    /// The crossings of the lines of a hatch with outlines and with other fills.
    #[cfg(feature = "svg")]
    pub(crate) fn hatch() -> Self {
        let remedy = "choose a greater --hatch";
        Self::new(MOST_CROSSINGS, "ends of lines of the hatch", remedy)
    }

    /// The steps along the outlines of an SVG's lines.
    #[cfg(feature = "svg")]
    pub(crate) fn outlines() -> Self {
        let remedy = "scale its curves down, or leave out its markers and its lines of no width";
        Self::new(MOST_STEPS, "steps along the outlines of lines", remedy)
    }

    /// The lines of a job in G-code.
    pub(crate) fn lines() -> Self {
        let remedy = "draw the job in parts, or let its program write fewer lines";
        Self::new(MOST_LINES, "lines", remedy)
    }

    /// The groups of a DXF.
    pub(crate) fn groups() -> Self {
        let remedy = "save the layers that are to be drawn as a file of their own";
        Self::new(MOST_GROUPS, "groups of a code and a value", remedy)
    }

    /// The values of a table.
    pub(crate) fn values() -> Self {
        let remedy = "leave out rows or columns";
        Self::new(MOST_VALUES, "values", remedy)
    }

    /// The pixels of a picture.
    pub(crate) fn pixels() -> Self {
        let remedy = "scan with fewer dots per inch, or take the camera's usual size";
        Self::new(MOST_PIXELS, "pixels", remedy)
    }

    /// The pixels of a picture that becomes a job.
    pub(crate) fn traced_pixels() -> Self {
        let remedy = "save it smaller: a pen draws no more than a few million";
        Self::new(MOST_TRACED, "pixels", remedy)
    }

    /// The dots of a picture, and the runs of its lines.
    pub(crate) fn dots() -> Self {
        let remedy = "choose a greater --hatch, or a smaller --scale";
        Self::new(MOST_DOTS, "dots or lines", remedy)
    }

    /// The cells, each as wide as a pen, that a picture is divided into.
    pub(crate) fn cells() -> Self {
        let remedy = "choose a greater --hatch, or a smaller --scale";
        Self::new(MOST_TRACED, "cells as wide as the pen", remedy)
    }

    /// Takes a number of them, before the memory for them is taken.
    ///
    /// # Errors
    /// There are fewer left.
    pub(crate) fn take(&mut self, count: usize) -> Result<(), OverBudget> {
        self.left = self.left.checked_sub(count).ok_or(self.over)?;
        Ok(())
    }

    /// Takes a number that a calculation gives, whatever it gives: of infinity and of no number, none are left.
    ///
    /// # Errors
    /// As [`Self::take`].
    pub(crate) fn take_calculated(&mut self, count: f64) -> Result<usize, OverBudget> {
        if count <= self.left as f64 {
            // A negative number becomes 0.
            let count = count.ceil() as usize;
            self.take(count)?;
            return Ok(count);
        }
        Err(self.over)
    }
}

impl From<OverBudget> for String {
    fn from(over: OverBudget) -> Self {
        over.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::{Budget, MOST_POINTS};

    #[test]
    fn a_limit_holds_for_any_number_that_a_file_can_make() {
        let mut points = Budget::points();
        assert_eq!(points.take_calculated(2.5), Ok(3));
        assert_eq!(points.take_calculated(-1.0), Ok(0));
        for count in [f64::INFINITY, f64::NAN, 1e300, MOST_POINTS as f64] {
            let told = points.take_calculated(count).unwrap_err().to_string();
            assert!(
                told.starts_with("more than 1000000 points are asked for"),
                "{told}"
            );
        }
        assert!(points.take(usize::MAX).is_err());
        assert_eq!(points.take(MOST_POINTS - 3), Ok(()));
        assert!(points.take(1).is_err());
    }
}
