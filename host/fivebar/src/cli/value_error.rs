//! Why the value of an argument is refused: what to give instead.

/// Why the value of an argument is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum ValueError {
    #[error("give a numeric address and a port, such as 127.0.0.1:9000")]
    Address,
    #[error("give columns and rows from 1 to 100, such as 3x2")]
    Copies,
    #[error("give an angle in degrees, such as 90")]
    Degrees,
    #[error("give grbl or reprap")]
    Dialect,
    #[error("give a distance of the lines from 0.1mm to 50mm, such as 0.8mm")]
    Hatch,
    #[error("give joints from A to E, such as B,D")]
    Joint,
    #[error("give a positive number of rad/s³, such as 1e5")]
    Jerk,
    #[error("give a length, such as 30mm, 1.5in, or 0.03 in metres")]
    Length,
    #[error("give the distortion k of the lens, from -0.12 to 0.2; 0 for a scanner")]
    Lens,
    #[error("give a share above 0 and below 1, such as 0.4")]
    Level,
    #[error("give a number of millimetres")]
    Millimetres,
    #[error("give {0} finite numbers, separated by commas")]
    Numbers(usize),
    #[error("give two lengths, such as 30mm,160mm, or 0.03,0.16 in metres")]
    Place,
    #[error("give two numbers, such as 2.79,0.35")]
    Point,
    #[error("give a length above 0, such as 50mm or 20um")]
    PositiveLength,
    #[error("give a positive number of millimetres")]
    PositiveMillimetres,
    #[error("give a number from 0.2 to 2000")]
    Rate,
    #[error("give a number of seconds from 0.1 to 600")]
    TeachTime,
    #[error("give a number of messages per second from 1 to 200")]
    RosRate,
    #[error("give a number of seconds from 0.1 to 3600")]
    Seconds,
    #[error("give a positive number")]
    Scale,
    #[error("give a number above 0, 1 at most")]
    Share,
    #[error("give a length from 0.5mm to 20mm")]
    Window,
    #[error("give left or right for each elbow, such as right,left")]
    WorkingMode,
    #[error("give outline, centre-line, tone, stipple or one-line")]
    Trace,
}
