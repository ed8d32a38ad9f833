//! An arm of each kind of drive, for tests of what works whatever turns the joints.

use fivebar_files::robot::{BuiltIn, Draft, Motors, StepperMotor};

/// The arms: built-in ones; `mit`, the leg with drives that speak the protocol of MIT-type drives; and `new`, as `fivebar new`
/// makes it, with other lengths, gears and steppers than any built-in arm.
pub(crate) const ARMS: [&str; 6] = [
    "benchtop",
    "benchtop_stepper",
    "leg",
    "mit",
    "classroom_servo",
    "new",
];

/// What makes MIT-type drives of ODrives in a robot file.
pub(crate) const MIT: (&str, &str) = (
    "protocol = \"odrive\"",
    "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
);

/// The robot file of one of the arms.
pub(crate) fn text(name: &str) -> String {
    let built_in = |name| BuiltIn::find(name).expect("a built-in robot").text;
    match name {
        "mit" => built_in("leg").replace(MIT.0, MIT.1),
        "new" => {
            let mut draft = Draft::new(name);
            draft.set_base(0.1);
            draft.motors = Motors::Steppers(StepperMotor {
                gear_ratio: -5.0,
                steps_per_turn: 400,
                microsteps: 8,
                holding_torque: 0.3,
                ..StepperMotor::TYPICAL
            });
            draft.text()
        }
        _ => built_in(name).into(),
    }
}
