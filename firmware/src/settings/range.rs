//! The values that a field of an axis can have on any arm. They are wide: within them nothing in
//! the loops overflows or vanishes in `f32`.

/// |Gear ratio|.
pub const GEAR_RATIO: [f32; 2] = [1e-3, 1e4];
/// Rotor inertia [kg·m²].
pub const ROTOR_INERTIA: [f32; 2] = [0.0, 1.0];
/// Torque constant [N·m/A].
pub const TORQUE_CONSTANT: [f32; 2] = [1e-6, 1e3];
/// Winding resistance [Ω].
pub const RESISTANCE: [f32; 2] = [1e-5, 1e5];
/// Winding inductance [H].
pub const INDUCTANCE: [f32; 2] = [1e-9, 1e3];
/// Viscous friction [N·m·s/rad] and Coulomb friction [N·m].
pub const FRICTION: [f32; 2] = [0.0, 1e4];
/// Age of an encoder's angle [s].
pub const LATENCY: [f32; 2] = [0.0, 0.1];
/// Joint speed [rad/s].
pub const SPEED: [f32; 2] = [1e-3, 1e4];
/// Joint acceleration [rad/s²].
pub const ACCELERATION: [f32; 2] = [1e-3, 1e7];
/// Motor current [A].
pub const CURRENT: [f32; 2] = [1e-4, 1e5];
/// Time constant of the motor's heating [s]: of the winding of a tiny motor, of a large one with its housing.
/// With a longer one the model of the heat would protect no motor.
pub const HEATING: [f32; 2] = [0.1, 3600.0];
/// The trip point of speed over the greatest speed of the joints.
pub const SPEED_TRIP: [f32; 2] = [1.0, 100.0];
/// The trip point of current over the greatest peak current of the motors.
pub const CURRENT_TRIP: [f32; 2] = [1.0, 5.0];
/// Greatest peak current over the stall current at the highest bus voltage. A motor that turns at its no-load
/// speed can be braked with twice the stall current; beyond four times nothing can be measured.
pub const STALL: f32 = 4.0;
/// The lowest bus voltage over the highest.
pub const BUS: f32 = 0.02;
/// Width of a hobby servo's pulse [s].
pub const PULSE_WIDTH: [f32; 2] = [1e-4, 5e-3];
/// Pulses of a hobby servo per second [Hz].
pub const FRAME_RATE: [f32; 2] = [40.0, 400.0];
/// Time for which the arm waits while the tool moves [s].
pub const SETTLE_TIME: [f32; 2] = [0.0, 10.0];
/// Time in which a holding brake engages or releases [s].
pub const BRAKE_TIME: [f32; 2] = [0.0, 1.0];
/// Frequency of a tool's PWM [Hz].
pub const POWER_FREQUENCY: [f32; 2] = [10.0, 1e5];
/// Current per ADC code [A].
pub const CURRENT_PER_CODE: [f32; 2] = [1e-8, 1e3];
