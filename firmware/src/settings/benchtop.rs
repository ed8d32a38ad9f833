//! The settings of the benchtop arm, `host/files/robots/benchtop.toml`, which
//! gives the source of each value. A board without stored settings starts with these, and the
//! instruction counts are measured with them.

use super::{
    AdvancedSettings, AxisSettings, BeltSettings, BrakeSettings, ControlSettings, EncoderTable,
    FieldLag, HomeReference, HomingSettings, LinkSettings, MotionSettings, ProtectionSettings,
    Settings, ToolOutputSettings,
};

const CRANK: LinkSettings = LinkSettings {
    mass: 0.07,
    com: [0.0414, 0.0],
    inertia: 1.33e-4,
};

const fn axis(home_angle: f32, home_forward: bool, angle_limits: [f32; 2]) -> AxisSettings {
    AxisSettings {
        gear_ratio: 8.0,
        rotor_inertia: 1e-6,
        torque_constant: 0.0234,
        resistance: 2.3,
        inductance: 0.24e-3,
        viscous_friction: 1.5e-3,
        coulomb_friction: 9e-3,
        encoder_counts: 16384,
        index_counts: 16384,
        encoder_latency: 0.0,
        home_angle,
        home_forward,
        angle_limits,
        max_speed: 35.0,
        max_acceleration: 1000.0,
        peak_current: 4.0,
        continuous_current: 1.3,
        thermal_time_constant: 12.0,
        current_per_code: 16.0 / 4096.0,
        current_zero_code: 2048,
    }
}

impl Settings {
    /// The benchtop arm.
    pub const BENCHTOP: Self = Self {
        lengths: [0.10, 0.16, 0.16, 0.10, 0.08],
        links: [
            CRANK,
            LinkSettings {
                mass: 0.05,
                com: [0.08, 0.0],
                inertia: 2.94e-4,
            },
            LinkSettings {
                mass: 0.04,
                com: [0.06, 0.0],
                inertia: 2.14e-4,
            },
            CRANK,
        ],
        payload: 0.03,
        gravity: [0.0, 0.0],
        tool_offset: [0.0, 0.0],
        elbows_left: [false, true],
        assembly_left: true,
        axes: [
            axis(2.792_526_8, true, [0.6, 3.6]),
            axis(0.349_065_9, false, [-0.46, 2.54]),
        ],
        control: ControlSettings {
            tick_rate: 10_000.0,
            bandwidth: 390.0,
            damping: 1.0,
            integral_rate: 97.5,
            observer_bandwidth: 3120.0,
            current_bandwidth: 3500.0,
            friction_smoothing: 0.02,
            computed_torque: true,
        },
        homing: HomingSettings {
            speed: 0.7,
            back_off: 0.05,
            current: 1.2,
        },
        home_reference: HomeReference::SWITCHES,
        motion: MotionSettings {
            max_speed: 0.3,
            max_acceleration: 4.0,
            max_jerk: 1000.0,
            corner_tolerance: 5e-5,
            singularity_margin: 0.15,
        },
        protection: ProtectionSettings {
            following_error: 0.02,
            over_speed: 52.5,
            over_current: 6.0,
            bus_voltage: [16.8, 31.2],
            bus_voltage_per_code: 48.0 / 4096.0,
            command_timeout: 0.1,
        },
        tool_output: ToolOutputSettings::None,
        encoder_tables: [EncoderTable::NONE; 2],
        crossing_allowed: false,
        brake: BrakeSettings::NONE,
        advanced: AdvancedSettings::DEFAULT,
        belts: [BeltSettings::RIGID; 2],
        field_lags: [FieldLag::NONE; 2],
    };
}
