//! The controller: the tick, from a sensor sample to an actuator command, and the requests that
//! tasks below the tick make.

mod belts;
mod crossing;
mod encoder;
mod excitation;
mod faults;
mod holding_brake;
mod homing;
mod homing_state;
mod impedance;
mod index_check;
mod joint;
mod model;
mod path;
mod planning;
mod report;
mod request;
mod rest;
mod setpoint;
mod setpoint_history;
mod status;
mod streaming;
mod tick;
mod time_slices;
mod touch;
mod tracking;
mod transitions;

use crate::drives::{BrushedDrives, Drives};
pub use crate::drives::{
    Excitation, Excited, FARTHEST_EXCITATION, LONGEST_EXCITATION, LONGEST_PULSE, MOST_DUTY,
};
use crate::safety::{Fault, Limits, State};
use crate::settings::{CheckedSettings, Settings};
use core::mem::MaybeUninit;
use core::ptr;
use crossing::Crossing;
pub(crate) use crossing::{
    CrossingSample, CrossingTimes, OUTSIDE as OUTSIDE_OF_ZONE, PIECES as CROSSING_PIECES, ZONE,
    polynomials as crossing_polynomials,
};
use encoder::Encoder;
pub use excitation::ExcitationEnd;
use excitation::ExcitationState;
use fivebar_kinematics::control::BeltState;
use fivebar_kinematics::five_bar::WorkingMode;
use holding_brake::HoldingBrake;
use homing_state::HomingState;
pub(crate) use impedance::Rendering;
pub use impedance::RenderingBounds;
use index_check::Landmarks;
use joint::Joint;
use model::Model;
use nalgebra::Vector2;
pub(crate) use path::Change;
pub use path::{ExtraTorque, QUEUED_SEGMENTS, QueuedSegment};
use path::{Path, PathOutput};
pub(crate) use path::{least_rest, stopping_time};
pub use planning::{Hold, PlanningSnapshot};
pub use report::StatusSample;
pub use request::{Posture, Request, RequestError, Stance};
use rest::Rest;
use setpoint::Setpoint;
use setpoint_history::SetpointHistory;
pub use status::{JointReference, Snapshot, Status};
pub(crate) use streaming::Splice;
use touch::Touch;
pub(crate) use touch::{TouchError, TouchPhase};
use transitions::Latched;

/// The controller of an arm with brushed motors on H-bridges.
pub type Controller = ArmController<BrushedDrives>;

/// The whole controller of an arm with these drives. A clone goes on from where it is: the exploration of all states needs that.
///
/// What every tick needs comes first, here and in the model: a load of the FPU reaches 1 KiB
/// from its base register, so one base register serves both.
#[derive(Clone)]
#[repr(C)]
pub struct ArmController<D: Drives> {
    joints: [Joint; 2],
    drives: D,
    setpoint: Setpoint,
    /// Position errors [rad] as last computed.
    error: [f32; 2],
    ticks: u32,
    /// The tick in which the command timeout was last restarted.
    heard_at: u32,
    rest: Rest,
    /// Ticks until the bridges are awake; [`Model::wake_up_ticks`] while they are off.
    waking: u32,
    state: State,
    brake: HoldingBrake,
    /// The working mode that the arm is in.
    mode: WorkingMode,
    limits: Limits,
    /// The first tick with the joints' counts has run.
    begun: bool,
    homed: bool,
    /// The joints' counts were 0 in an index pulse.
    homed_by_index: bool,
    /// The latched fault allows a controlled stop: the bridges stay on.
    controlled_stop: bool,
    /// This tick reaches the end of the path or of a stop; a turn changes the state.
    at_rest: bool,
    /// The fault that stops the arm on its path, found by the turn before.
    pending_stop: Option<Fault>,
    /// The fault that switches the bridges off in the next tick.
    pending_off: Option<Fault>,
    model: Model,
    setpoint_history: SetpointHistory,
    /// The deviations of joints behind belts.
    belts: [BeltState<f32>; 2],
    path: Path,
    /// The encoders with a known error.
    encoders: [Option<Encoder>; 2],
    /// The settings in use, which were checked.
    settings: Settings,
    homing: [HomingState; 2],
    /// Where the joints pass their switches and index pulses.
    landmarks: [Landmarks; 2],
    excitation: ExcitationState,
    /// The latched fault, as it was raised.
    latched: Option<Latched>,
    missed_ticks: u32,
    /// Goes up whenever the path is dropped before its end.
    path_generation: u32,
    crossing: Crossing,
    touch: Touch,
}

/// Writes the values of a new controller twice: as a controller, and each in its place in RAM. So the stack holds no
/// controller, and neither can forget a field.
macro_rules! fresh_controller {
    ($checked:ident; $($field:ident: $value:expr,)*) => {
        impl<D: Drives> ArmController<D> {
            /// A controller for the arm of these settings, in the state Stopped and not homed.
            pub fn new($checked: &CheckedSettings) -> Self {
                Self { $($field: $value,)* }
            }

            /// Makes what [`ArmController::new`] makes, in its place.
            // A call of its own: what checks the settings before does not take its stack.
            #[inline(never)]
            #[allow(unsafe_code)]
            pub fn place<'a>(place: &'a mut MaybeUninit<Self>, $checked: &CheckedSettings) -> &'a mut Self {
                let to = place.as_mut_ptr();
                // SAFETY: `to` is where a controller may be written, and `new` shows that these are all its fields.
                unsafe {
                    $(put(slot(&raw mut (*to).$field), || $value);)*
                    place.assume_init_mut()
                }
            }

            /// Becomes what [`ArmController::new`] makes, in place.
            #[allow(unsafe_code)]
            pub fn reset(&mut self, $checked: &CheckedSettings) {
                // SAFETY: all its fields are written, and none needs to be dropped.
                let place = unsafe { &mut *ptr::from_mut(self).cast::<MaybeUninit<Self>>() };
                Self::place(place, $checked);
            }
        }
    };
}

/// The room of a value.
///
/// # Safety
/// It is a place in RAM which no one else uses.
#[allow(unsafe_code)]
unsafe fn slot<'a, T>(place: *mut T) -> &'a mut MaybeUninit<T> {
    // SAFETY: asked for above; it may hold anything.
    unsafe { &mut *place.cast() }
}

/// Puts what `make` makes in its place. A call of its own: no two fields take stack at the same time.
#[inline(never)]
fn put<T>(place: &mut MaybeUninit<T>, make: impl FnOnce() -> T) {
    place.write(make());
}

fresh_controller! { checked;
    joints: [Joint::new(), Joint::new()],
    drives: D::new(checked),
    setpoint: Setpoint::hold([Vector2::zeros(); 2]),
    setpoint_history: SetpointHistory::none(),
    belts: belts::STILL,
    error: [0.0; 2],
    ticks: 0,
    heard_at: 0,
    rest: Rest::new(),
    waking: model::wake_up_ticks::<D>(checked),
    state: State::Stopped,
    brake: HoldingBrake::new(&checked.brake, checked.control.tick_rate),
    mode: checked.working_mode(),
    limits: Limits::empty(),
    begun: false,
    homed: false,
    homed_by_index: false,
    controlled_stop: false,
    at_rest: false,
    pending_stop: None,
    pending_off: None,
    model: Model::new::<D>(checked),
    path: Path::new(
        stopping_time(checked),
        1.0 / checked.control.tick_rate,
        PathOutput::new(checked),
    ),
    encoders: encoder::encoders(checked),
    settings: **checked,
    homing: [HomingState::new(0.0); 2],
    landmarks: Landmarks::of(checked),
    excitation: ExcitationState::none(checked.control.tick_rate),
    latched: None,
    missed_ticks: 0,
    path_generation: 0,
    crossing: Crossing::none(),
    touch: Touch::new::<D>(checked),
}

impl<D: Drives> ArmController<D> {
    /// Hands the motors' heat over to a new controller that takes the place of this one, if this one is stopped.
    ///
    /// # Errors
    /// The state of this one.
    pub fn hand_over(&self, new: &mut Self) -> Result<(), State> {
        if self.state != State::Stopped {
            return Err(self.state);
        }
        new.keep_heat(self);
        Ok(())
    }

    /// Takes the motors' heat over from the controller in use before: new settings cool no motor.
    /// Motors of other ratings are at least as hot as at a start.
    pub fn keep_heat(&mut self, before: &Self) {
        self.drives
            .keep_heat(&self.settings, &before.drives, &before.settings);
    }

    /// The settings in use. They are valid: they were checked before the controller was made.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    #[inline(always)]
    fn angles(&self) -> [f32; 2] {
        let [joint1, joint4] = &self.joints;
        [joint1.angle(), joint4.angle()]
    }

    /// The demanded torques [N·m].
    fn torques(&self) -> [f32; 2] {
        self.drives.torque(self.drives.report().current_demand)
    }

    #[inline(always)]
    fn velocities(&self) -> [f32; 2] {
        let [joint1, joint4] = &self.joints;
        [joint1.velocity(), joint4.velocity()]
    }

    /// θ1, θ4 as counted at this tick's sample [rad].
    #[inline(always)]
    fn counted(&self) -> [f32; 2] {
        let ([joint1, joint4], [axis1, axis4]) = (&self.joints, &self.model.axes);
        [joint1.counted(axis1), joint4.counted(axis4)]
    }
}

/// A controller that is not shared needs no lock.
impl<D: Drives> rtic_core::Mutex for ArmController<D> {
    type T = Self;

    fn lock<R>(&mut self, work: impl FnOnce(&mut Self) -> R) -> R {
        work(self)
    }
}
