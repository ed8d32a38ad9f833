//! The least value of a function without derivatives, by a simplex that reflects, grows and shrinks.
//!
//! Source: J. Nelder, R. Mead, A simplex method for function minimization, The Computer Journal 7 (1965).

/// A corner and its value.
type Corner<const N: usize> = ([f64; N], f64);

/// Where `value` is least, as far as so many trials show, from `start` with steps of `size`. An infinite value is
/// one that is not allowed. A value that is not below the given limit is not needed exactly: any that is not below it
/// will do.
pub(super) fn least<const N: usize>(
    value: impl Fn(&[f64; N], f64) -> f64,
    start: [f64; N],
    size: f64,
    most_trials: usize,
) -> [f64; N] {
    let of = |x: [f64; N], limit: f64| -> Corner<N> { (x, value(&x, limit)) };
    let exactly = |x: [f64; N]| of(x, f64::INFINITY);
    let mut corners: Vec<Corner<N>> = vec![exactly(start)];
    // To both sides, so that not all gains grow together.
    corners.extend((0..N).map(|i| {
        let mut x = start;
        x[i] += if i % 2 == 0 { size } else { -size };
        exactly(x)
    }));
    let mut trials = N + 1;
    while trials < most_trials {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let ((best, best_value), (worst, worst_value)) = (corners[0], corners[N]);
        let middle: [f64; N] =
            std::array::from_fn(|i| corners[..N].iter().map(|(x, _)| x[i]).sum::<f64>() / N as f64);
        let beyond = |share: f64, limit: f64| {
            let x = std::array::from_fn(|i| middle[i] + share * (middle[i] - worst[i]));
            of(x, limit)
        };
        let reflected = beyond(1.0, worst_value);
        trials += 1;
        if reflected.1 < best_value {
            let grown = beyond(2.0, reflected.1);
            trials += 1;
            corners[N] = if grown.1 < reflected.1 {
                grown
            } else {
                reflected
            };
            continue;
        }
        if reflected.1 < corners[N - 1].1 {
            corners[N] = reflected;
            continue;
        }
        let share = if reflected.1 < worst_value { 0.5 } else { -0.5 };
        let limit = reflected.1.min(worst_value);
        let inside = beyond(share, limit);
        trials += 1;
        if inside.1 < limit {
            corners[N] = inside;
            continue;
        }
        for corner in &mut corners[1..] {
            *corner = exactly(std::array::from_fn(|i| 0.5 * (best[i] + corner.0[i])));
        }
        trials += N;
    }
    let least = corners.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    least.map_or(start, |(x, _)| x)
}

#[cfg(test)]
mod tests {
    use super::least;

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        // Rosenbrock's.
        let valley = |x: &[f64; 2], _| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let [x, y] = least(valley, [-1.2, 1.0], 0.3, 400);
        assert!((x - 1.0).abs() < 1e-4 && (y - 1.0).abs() < 1e-4, "{x}, {y}");
    }

    #[test]
    fn a_value_that_is_only_known_to_be_not_below_its_limit_changes_nothing() {
        let exact = |x: &[f64; 2]| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let limited = |x: &[f64; 2], limit: f64| {
            let value = exact(x);
            if value < limit { value } else { limit }
        };
        let [found, expected] = [
            least(limited, [-1.2, 1.0], 0.3, 400),
            least(|x, _| exact(x), [-1.2, 1.0], 0.3, 400),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn what_is_not_allowed_is_not_found() {
        let half = |x: &[f64; 1], _| if x[0] < 1.0 { f64::INFINITY } else { x[0] };
        let [x] = least(half, [3.0], 0.5, 200);
        assert!((1.0..1.001).contains(&x), "{x}");
    }
}
