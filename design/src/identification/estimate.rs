//! The identification of an arm from a log.

use super::check::{check_mode, check_motion, check_times};
use super::error::IdentificationError;
use super::least_squares::{Solution, scales, solve};
use super::log::{Log, Observed};
use super::processing::systems;
use super::regressor::{BASE_NAMES, Regressor};
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DVector, Vector2};

/// Values with their standard deviations, which allow for the filtered noise being correlated.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The base parameters in the order of [`BASE_NAMES`] [kg·m², kg·m].
    pub base: Vec<f64>,
    /// Their deviations.
    pub base_sd: Vec<f64>,
    /// Viscous friction [N·m·s/rad].
    pub viscous: [f64; 2],
    /// Its deviations.
    pub viscous_sd: [f64; 2],
    /// Coulomb friction [N·m].
    pub coulomb: [f64; 2],
    /// Its deviations.
    pub coulomb_sd: [f64; 2],
    /// What the measured torque has more [N·m].
    pub offset: [f64; 2],
    /// Its deviations.
    pub offset_sd: [f64; 2],
    /// Condition of the regressor with J in 1e-3 kg·m², h in 1e-2 kg·m, friction in 1e-2.
    pub condition: f64,
    /// With this factor of its deviation on either side, a value's interval holds 95 %: Student's quantile, because
    /// the deviations are found from the log.
    pub coverage_factor: f64,
    /// The share of each joint's filtered rows that are left out, because wrong samples spoil them.
    pub left_out: [f64; 2],
    /// Root mean square of the filtered torque that is not explained, in the rows that are used [N·m].
    pub residual_rms: [f64; 2],
    /// The same over that of the torque.
    pub residual_share: [f64; 2],
}

/// The greatest condition with which parameters are distinguished.
const GREATEST_CONDITION: f64 = 3e3;
/// The greatest unexplained share of a torque.
pub(super) const GREATEST_SHARE: f64 = 0.5;

/// Finds base parameters and friction of an arm.
///
/// # Errors
/// What is wrong with the log, or which parameters its motion does not determine.
pub fn identify(log: &Log, observed: &Observed<'_>) -> Result<Identification, IdentificationError> {
    check_times(log, observed.tick_rate)?;
    let angles = check_motion(log, observed)?;
    check_mode(&angles, observed)?;
    let base = observed.base_count();
    let solved = |columns: Columns| -> Result<Solution, IdentificationError> {
        let lost = |_| IdentificationError::OtherMode(0.01);
        let angles = columns.angles(&angles);
        let systems = systems(&angles, &columns.torques(log, observed), observed);
        let systems = systems.map_err(lost)?;
        if systems[0].torque[0].len() < 4 * (base + 6) {
            return Err(IdentificationError::TooShort(
                log.times.last().unwrap_or(&0.0) - log.times[0],
            ));
        }
        let solutions = systems
            .iter()
            .filter_map(|system| solve(system, &scales(base)));
        averaged(solutions.collect(), systems[0].torque[0].len())
            .ok_or_else(|| IdentificationError::NotSeen(vec!["anything".into()], f64::INFINITY))
    };
    let found = solved(Columns::default())?;
    let worst = |solution: &Solution| solution.share[0].max(solution.share[1]);
    let is_sound = |solution: &Solution, columns: Columns| {
        has_inertia(solution, &columns.angles(&angles), observed)
    };
    let as_given = is_sound(&found, Columns::default());
    if worst(&found) > 0.2 || !as_given {
        for columns in Columns::EXCHANGED {
            let Ok(exchanged) = solved(columns) else {
                continue;
            };
            if worst(&exchanged) < 0.5 * worst(&found) && is_sound(&exchanged, columns) {
                return Err(columns.refusal());
            }
        }
    }
    if found.condition > GREATEST_CONDITION {
        let names = (0..base + 6).filter(|&index| found.weakest[index] > 0.3);
        return Err(IdentificationError::NotSeen(
            names.map(|index| name(index, base)).collect(),
            found.condition,
        ));
    }
    if !as_given {
        return Err(IdentificationError::Reversed);
    }
    for joint in Joint::ALL {
        if found.share[joint] > GREATEST_SHARE {
            return Err(IdentificationError::Unexplained(joint, found.share[joint]));
        }
    }
    let (value, sd) = (&found.value, &found.sd);
    let pair = |from: &nalgebra::DVector<f64>, index: usize| [from[index], from[index + 1]];
    Ok(Identification {
        base: value.as_slice()[..base].to_vec(),
        base_sd: sd.as_slice()[..base].to_vec(),
        viscous: pair(value, base),
        viscous_sd: pair(sd, base),
        coulomb: pair(value, base + 2),
        coulomb_sd: pair(sd, base + 2),
        offset: pair(value, base + 4),
        offset_sd: pair(sd, base + 4),
        condition: found.condition,
        coverage_factor: found.coverage_factor,
        left_out: found.left_out,
        residual_rms: found.rms,
        residual_share: found.share,
    })
}

/// The solution that explains the torques best, with deviations that allow for the others that explain them about as well: each
/// counts by its likelihood (Buckland, Burnham and Augustin 1997). Of rows in the filter's band about half are independent.
fn averaged(solutions: Vec<Solution>, rows: usize) -> Option<Solution> {
    let unexplained = |solution: &Solution| (solution.rms[0] * solution.rms[1]).max(1e-300).ln();
    let least = solutions.iter().map(unexplained).reduce(f64::min)?;
    let likelihood = |it: &Solution| (-0.5 * rows as f64 * (unexplained(it) - least)).exp();
    let all: f64 = solutions.iter().map(likelihood).sum();
    let share = |it: &Solution| likelihood(it) / all;
    let of_all = |figure: &dyn Fn(&Solution) -> DVector<f64>| {
        let terms = solutions.iter().map(|it| figure(it) * share(it));
        terms.reduce(|sum, term| sum + term)
    };
    let value = of_all(&|it| it.value.clone())?;
    let sd = of_all(&|it| {
        let off = &it.value - &value;
        (it.sd.component_mul(&it.sd) + off.component_mul(&off)).map(f64::sqrt)
    })?;
    let best = solutions
        .into_iter()
        .min_by(|a, b| unexplained(a).total_cmp(&unexplained(b)))?;
    Some(Solution { value, sd, ..best })
}

/// Which columns of a log are exchanged.
#[derive(Clone, Copy, Default)]
struct Columns {
    angles: bool,
    currents: bool,
}

impl Columns {
    const EXCHANGED: [Self; 3] = [
        Self {
            angles: false,
            currents: true,
        },
        Self {
            angles: true,
            currents: false,
        },
        Self {
            angles: true,
            currents: true,
        },
    ];

    fn refusal(self) -> IdentificationError {
        if self.angles {
            IdentificationError::SwappedAngles
        } else {
            IdentificationError::SwappedCurrents
        }
    }

    fn angles(self, given: &[Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let [first, second] = given.clone();
        if self.angles {
            [second, first]
        } else {
            [first, second]
        }
    }

    fn torques(self, log: &Log, observed: &Observed<'_>) -> [Vec<f64>; 2] {
        Joint::ALL.map(|joint| {
            let from = if self.currents { joint.other() } else { joint };
            let factor = observed.torque_per_ampere[joint];
            log.currents.iter().map(|row| factor * row[from]).collect()
        })
    }
}

fn name(index: usize, base: usize) -> String {
    match index.checked_sub(base) {
        None => BASE_NAMES[index].into(),
        Some(rest) => {
            let what = ["viscous friction", "Coulomb friction", "offset"][rest / 2];
            format!("{what} of {}", Joint::ALL[rest % 2])
        }
    }
}

/// Whether the mass matrix is positive definite in poses of the log.
fn has_inertia(solution: &Solution, angles: &[Vec<f64>; 2], observed: &Observed<'_>) -> bool {
    let rows = angles[0].len();
    let base = &solution.value.as_slice()[..observed.base_count()];
    let mut seen = (0..rows).step_by((rows / 50).max(1)).map(|row| {
        let column = |alpha: [f64; 2]| {
            let motion = [[angles[0][row], angles[1][row]], [0.0; 2], alpha];
            let still = Vector2::zeros();
            let at = Regressor::at(observed.geometry, observed.assembly, still, motion).ok()?;
            Some(at.torque(base))
        };
        let [m11, m41] = column([1.0, 0.0])?;
        let [m14, m44] = column([0.0, 1.0])?;
        Some(m11 > 0.0 && m11 * m44 > m14 * m41)
    });
    seen.all(|sound| sound != Some(false))
}

#[cfg(test)]
mod tests {
    use super::{DVector, Solution, averaged};

    fn solution(value: f64, rms: f64) -> Solution {
        Solution {
            value: DVector::repeat(1, value),
            sd: DVector::repeat(1, 0.3),
            coverage_factor: 2.0,
            rms: [rms; 2],
            left_out: [0.0; 2],
            share: [0.0; 2],
            condition: 1.0,
            weakest: DVector::repeat(1, 1.0),
        }
    }

    #[test]
    fn solutions_that_explain_a_log_as_well_widen_the_deviations_and_worse_ones_do_not() {
        let equal = vec![solution(1.0, 0.1), solution(2.0, 0.1)];
        let found = averaged(equal, 1000).unwrap();
        assert!((found.value[0] - 1.5).abs() < 1e-12, "{}", found.value[0]);
        // √(0.3² + 0.5²)
        assert!(
            (found.sd[0] - 0.583_095_189_484_530_1).abs() < 1e-12,
            "{}",
            found.sd[0]
        );
        let worse = vec![solution(1.0, 0.1), solution(2.0, 0.102)];
        let found = averaged(worse, 1000).unwrap();
        assert!((found.value[0] - 1.0).abs() < 1e-6 && (found.sd[0] - 0.3).abs() < 1e-6);
        assert!(averaged(Vec::new(), 1000).is_none());
    }
}
