//! The image on QEMU's Cortex-M0 takes few enough instructions, gives the desktop's bits, and is near the exact answer.
//! scripts/targets.sh builds it, names it in LEG_IMAGE, and says in LEG_MOST how many a period may take.

use fivebar_kinematics::five_bar::Geometry;
use fivebar_leg_m0::{FEET, GROUND, LENGTHS, VELOCITY, period};
use std::process::Command;

/// What the image prints: by place of the foot the instructions, then the bits of two angles, rates and torques.
fn printed() -> Vec<Vec<u32>> {
    let image = std::env::var_os("LEG_IMAGE").expect("LEG_IMAGE names the image");
    let output = Command::new("qemu-system-arm")
        .args(["-machine", "microbit", "-icount", "shift=10"])
        .args(["-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(image)
        .output()
        .expect("qemu-system-arm starts");
    assert!(output.status.success(), "{output:?}");
    // Semihosting prints to standard error.
    let text = String::from_utf8([output.stdout, output.stderr].concat()).expect("text");
    let numbers = |line: &str| line.split(' ').map(|it| it.parse().expect(line)).collect();
    text.lines().map(numbers).collect()
}

#[test]
fn a_period_on_a_cortex_m0_is_within_its_budget_and_has_the_bits_of_the_desktop() {
    let most = std::env::var("LEG_MOST").expect("LEG_MOST is the most instructions of a period");
    let most: u32 = most.parse().expect("LEG_MOST is a number");
    let rows = printed();
    assert_eq!(rows.len(), FEET.len());
    let leg = Geometry::new(LENGTHS).unwrap();
    let exact_leg = Geometry::new(LENGTHS.map(f64::from)).unwrap();
    for (row, foot) in rows.iter().zip(FEET) {
        println!("foot at {foot:?} m: {} instructions", row[0]);
        assert!(
            row[0] <= most,
            "{} instructions, foot at {foot:?} m",
            row[0]
        );

        let inputs = [foot, VELOCITY, GROUND];
        let here = period(&leg, inputs).unwrap();
        let here = [here.angle, here.rate, here.torque].concat();
        let bits: Vec<u32> = here.iter().map(|it| it.to_bits()).collect();
        assert_eq!(row[1..], bits, "foot at {foot:?} m");

        let exact = period(&exact_leg, inputs.map(|pair| pair.map(f64::from))).unwrap();
        // The angles' bound is that of every arm's; the others are half a millionth of the terms of which rates [rad/s]
        // and torques [N·m] are the sum.
        let kinds = [
            ("angle", exact.angle, 7e-7),
            ("rate", exact.rate, 2e-6),
            ("torque", exact.torque, 1e-6),
        ];
        for ((kind, exact, bound), here) in kinds.into_iter().zip(here.chunks(2)) {
            for joint in 0..2 {
                let error = (f64::from(here[joint]) - exact[joint]).abs();
                assert!(error <= bound, "{kind}: {error:e}, foot at {foot:?} m");
            }
        }
    }
}
