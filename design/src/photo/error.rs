//! Why a photograph cannot be compared with a job.

use core::fmt;

/// Why a photograph cannot be compared with a job.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PhotoError {
    /// Fewer or more than four marks were found, or not one first one: marks, and first ones.
    Marks(usize, usize),
    /// The marks are too small in the picture [pixels per millimetre].
    Coarse(f64),
    /// Three marks lie on a line, or the picture shows them from behind.
    View,
    /// The job has no stroke of which the surroundings are free of other strokes.
    NoSamples,
    /// The strokes are not where the job has them: the share of their points that was found.
    OtherJob(f64),
    /// The distances of the marks do not determine their places, or contradict each other by this much [m].
    Distances(f64),
}

impl fmt::Display for PhotoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Marks(4, firsts) => write!(
                f,
                "the four marks are there, but {firsts} of them have three circles in place of one: \
                 photograph the marks that --draw-marks writes, complete and from above"
            ),
            Self::Marks(0, _) => write!(
                f,
                "no mark is found: four marks, circles about one centre, must be on the paper, all in \
                 the picture, sharp, and at least 4 pixels per millimetre; --draw-marks FILE.gcode \
                 writes a job that draws them"
            ),
            Self::Marks(found, _) if found < 4 => write!(
                f,
                "{found} of the four marks are found: all must be in the picture, sharp, with closed \
                 circles that nothing touches, and at least 4 pixels per millimetre"
            ),
            Self::Marks(found, _) => write!(
                f,
                "{found} marks are found in place of four: the drawing itself has circles with radii as \
                 1 : 2 about one centre; cover them in the picture"
            ),
            Self::Coarse(per_millimetre) => write!(
                f,
                "the picture has {per_millimetre:.1} pixels per millimetre of paper, and 4 are needed: \
                 go nearer, or take the camera's full size"
            ),
            Self::View => write!(
                f,
                "three marks lie on a line or nearly: put them at the corners of the drawing"
            ),
            Self::NoSamples => write!(
                f,
                "no stroke has space around it: others are nearer than 1.4 times the window; give a \
                 smaller --window, such as 0.8mm"
            ),
            Self::OtherJob(share) => write!(
                f,
                "only {:.0} % of the strokes are found where the job has them: the job, --robot, \
                 --origin, --scale and --rotate must be those that were drawn, and the picture must not be \
                 cropped; an arm that is off by more needs a greater --window",
                100.0 * share
            ),
            Self::Distances(worst) if worst.is_nan() => write!(
                f,
                "five different distances between the marks 1 to 4 are needed, each above 0"
            ),
            Self::Distances(worst) => write!(
                f,
                "the distances of the marks contradict each other by {:.1} mm: measure them again, from \
                 centre to centre, in metres",
                1e3 * worst
            ),
        }
    }
}

impl core::error::Error for PhotoError {}
