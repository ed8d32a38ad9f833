//! The mismatches one by one.

use crate::mismatch::Mismatch;

impl Mismatch {
    /// Each difference that is on, with its key, alone: all others are off. The damping of a drive
    /// belongs to its stiffness, or to the flanks of backlash and of an uneven pulley.
    pub fn alone(&self) -> Vec<(&'static str, Self)> {
        let none = Self::NONE;
        let damped = Self {
            drive_damping: self.drive_damping,
            ..none
        };
        let (stiffness, backlash) = (self.stiffness, self.backlash);
        let (pulley_run_out, tooth_mesh) = (self.pulley_run_out, self.tooth_mesh);
        let has_flanks = [backlash, pulley_run_out, tooth_mesh] != [[0.0; 2]; 3];
        let is_damping_alone = stiffness.is_none() && !has_flanks;
        let own_damping = if is_damping_alone { damped } else { none };
        // A gap without a belt's stiffness beside it has its damping at the flanks.
        let flanks = if stiffness.is_none() { damped } else { none };
        // Names every other key: one without a line here does not compile.
        macro_rules! alone {
            ($($key:ident),*) => {{
                let Self {
                    stiffness: _,
                    drive_damping: _,
                    backlash: _,
                    pulley_run_out: _,
                    tooth_mesh: _,
                    $($key: _),*
                } = self;
                [$((stringify!($key), Self { $key: self.$key, ..none })),*]
            }};
        }
        let plain = alone!(
            link_mass,
            friction,
            payload,
            current_noise,
            current_offset,
            link_length,
            base_length,
            home_error,
            torque_constant,
            torque_ripple,
            cogging,
            stiction,
            encoder_error,
            encoder_latency,
            supply_resistance,
            pen_friction,
            paper_growth
        );
        let springs = [
            (
                "stiffness",
                Self {
                    stiffness,
                    ..damped
                },
            ),
            ("drive_damping", own_damping),
            ("backlash", Self { backlash, ..flanks }),
            (
                "pulley_run_out",
                Self {
                    pulley_run_out,
                    ..flanks
                },
            ),
            (
                "tooth_mesh",
                Self {
                    tooth_mesh,
                    ..flanks
                },
            ),
        ];
        let is_on = |(key, alone): &(&str, Self)| match *key {
            "stiffness" => stiffness.is_some(),
            "backlash" => backlash != none.backlash,
            "pulley_run_out" => pulley_run_out != none.pulley_run_out,
            "tooth_mesh" => tooth_mesh != none.tooth_mesh,
            _ => *alone != none,
        };
        plain.into_iter().chain(springs).filter(is_on).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::Mismatch;

    #[test]
    fn the_declared_mismatch_has_five_causes() {
        let declared = Mismatch::default();
        let alone = declared.alone();
        let keys: Vec<_> = alone.iter().map(|(key, _)| *key).collect();
        let five = [
            "link_mass",
            "friction",
            "payload",
            "current_noise",
            "current_offset",
        ];
        assert_eq!(keys, five);
        assert_eq!(alone[1].1.friction, declared.friction);
        assert_eq!(alone[1].1.link_mass, 0.0);
        assert!(Mismatch::NONE.alone().is_empty());
    }

    #[test]
    fn a_drives_damping_stays_with_its_stiffness_or_with_its_backlash() {
        let (damping, gap) = ([0.01, 0.02], [1e-3, 0.0]);
        let flanks = Mismatch {
            backlash: gap,
            drive_damping: damping,
            ..Mismatch::NONE
        };
        assert_eq!(flanks.alone(), [("backlash", flanks)]);
        let belt = Mismatch {
            stiffness: Some([900.0, 800.0]),
            ..flanks
        };
        let [stiffness, backlash] = [
            Mismatch {
                backlash: [0.0; 2],
                ..belt
            },
            Mismatch {
                backlash: gap,
                ..Mismatch::NONE
            },
        ];
        let expected = [("stiffness", stiffness), ("backlash", backlash)];
        assert_eq!(belt.alone(), expected);
        let uneven = Mismatch {
            pulley_run_out: [1e-3; 2],
            drive_damping: damping,
            ..Mismatch::NONE
        };
        assert_eq!(uneven.alone(), [("pulley_run_out", uneven)]);
        let alone = Mismatch {
            drive_damping: damping,
            ..Mismatch::NONE
        };
        assert_eq!(alone.alone(), [("drive_damping", alone)]);
    }
}
