//! A search that ends at its limit finds what the whole one finds.

use super::{BeltJoint, Search};
use crate::Noise;
use fivebar_kinematics::control::{Belt, BeltGains};

#[test]
fn a_limit_on_the_cost_changes_no_judgement_that_is_below_it() {
    let (period, jr) = (1e-4, 6.4e-5);
    let joint = BeltJoint {
        belt: Belt {
            stiffness: 2500.0,
            damping: 8e-3,
            rotor_inertia: jr,
            encoder_at_joint: false,
        },
        inertia: [5e-4, 3e-3],
        range: [0.7, 1.5],
        current_bandwidth: 3500.0,
        latency: 0.0,
        count: 4.8e-5,
        peak_torque: 0.75,
        period,
    };
    let search = Search::of(&joint);
    let mut noise = Noise::new(1);
    let mut seen = [0; 3];
    for _ in 0..40 {
        let x = [100.0, 0.7, 0.0234, 0.17, 0.0025, 0.055, 2e-2, 0.7];
        let [bandwidth, damping, rotor, g1, g2, g3, g4, g5] =
            x.map(|gain| gain * (3.0 * (noise.uniform() - 0.5)).exp());
        let gains = BeltGains {
            bandwidth,
            damping,
            rotor_damping: rotor * jr / period,
            observer: [g1, g2 / period, g3, g4, g5],
        };
        let whole = search.judge(&gains, f64::INFINITY);
        let cost = whole.map_or(f64::INFINITY, |it| it.cost(joint.peak_torque));
        for limit in [cost + 1.0, cost - 1.0, 5.0] {
            let limited = search.judge(&gains, limit);
            if cost < limit {
                assert_eq!(limited, whole, "{gains:?}");
                seen[0] += 1;
            } else if let Some(limited) = limited {
                assert!(limited.cost(joint.peak_torque) >= limit, "{gains:?}");
                seen[1] += 1;
            } else {
                assert_eq!(whole, None, "{gains:?}");
                seen[2] += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 5), "{seen:?}");
}
