//! The error of the tip over the workspace: expected after a calibration, found before it.

use super::parameters::Parameters;
use super::poses::reached;
use super::tip::{on_plate, posed};
use fivebar_kinematics::five_bar::{Pose, Workspace};
use nalgebra::{Matrix3, SMatrix, Vector2};

/// The error of a commanded position over the workspace [m].
#[derive(Clone, Debug, PartialEq)]
pub struct TipError {
    /// The points and the root mean square of the error there.
    pub points: Vec<(Vector2<f64>, f64)>,
    /// Root mean square over the points.
    pub rms: f64,
    /// At the worst point.
    pub worst: f64,
}

impl TipError {
    fn over(points: Vec<(Vector2<f64>, f64)>) -> Option<Self> {
        let sum: f64 = points.iter().map(|(_, error)| error * error).sum();
        let worst = points.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        (!points.is_empty()).then(|| Self {
            rms: (sum / points.len() as f64).sqrt(),
            worst,
            points,
        })
    }
}

/// The derivatives of the tip by the ten unknowns.
type Derivatives = SMatrix<f64, 2, 10>;

fn expected(j: &Derivatives, covariance: &SMatrix<f64, 10, 10>) -> f64 {
    (j * covariance * j.transpose()).trace().max(0.0).sqrt()
}

/// The expected error at the points that the arm reaches from its home, placement included:
/// √tr(∂T/∂p Σ ∂T/∂pᵀ); none if there is no point.
pub fn tip_error(
    p: &Parameters,
    covariance: &SMatrix<f64, 10, 10>,
    workspace: &Workspace<f64>,
    home: &Pose<f64>,
) -> Option<TipError> {
    let error = |(c, pose): (Vector2<f64>, Pose<f64>)| {
        (c, expected(&on_plate(p, &pose).jacobian, covariance))
    };
    TipError::over(reached(workspace, home).into_iter().map(error).collect())
}

/// As [`tip_error`], after the placement that makes the errors of all points together least, as
/// one who aligns a sheet would do: the derivatives J by the lengths and offsets lose what the
/// derivatives R by x, y, φ can take up, J − R (ΣRᵀR)⁻¹ ΣRᵀJ.
pub fn tip_error_best_placed(
    p: &Parameters,
    covariance: &SMatrix<f64, 10, 10>,
    workspace: &Workspace<f64>,
    home: &Pose<f64>,
) -> Option<TipError> {
    let derivatives = |(c, pose): (Vector2<f64>, Pose<f64>)| (c, on_plate(p, &pose).jacobian);
    let points: Vec<_> = reached(workspace, home)
        .into_iter()
        .map(derivatives)
        .collect();
    let rigid = |j: &Derivatives| j.fixed_columns::<3>(7).into_owned();
    let squares: Matrix3<f64> = points.iter().map(|(_, j)| rigid(j).tr_mul(&rigid(j))).sum();
    let inverse = squares.try_inverse()?;
    let mixed: SMatrix<f64, 3, 10> = points.iter().map(|(_, j)| rigid(j).tr_mul(j)).sum();
    let taken = inverse * mixed;
    let error =
        |(c, j): &(Vector2<f64>, Derivatives)| (*c, expected(&(j - rigid(j) * taken), covariance));
    TipError::over(points.iter().map(error).collect())
}

/// The error that the arm `found` makes at the points of the nominal workspace if it is commanded
/// with the nominal lengths and zeros, after the placement that makes all errors together least;
/// none if there is no point, or `found` cannot take all these angles.
pub fn tip_error_before(
    found: &Parameters,
    nominal: &Workspace<f64>,
    home: &Pose<f64>,
) -> Option<TipError> {
    let bare = Parameters {
        origin: [0.0; 2],
        turn: 0.0,
        ..*found
    };
    let pair = |(c, pose): (Vector2<f64>, Pose<f64>)| {
        let [theta1, _, _, theta4] = pose.angles();
        Some((c, posed(&bare, [theta1, theta4], home.assembly())?.c))
    };
    let pairs: Option<Vec<_>> = reached(nominal, home).into_iter().map(pair).collect();
    let pairs = pairs?;
    let placement = super::rigid(&pairs)?;
    let error = |(wanted, real): &(Vector2<f64>, Vector2<f64>)| {
        (
            *wanted,
            (placement * nalgebra::Point2::from(*real) - nalgebra::Point2::from(*wanted)).norm(),
        )
    };
    TipError::over(pairs.iter().map(error).collect())
}
