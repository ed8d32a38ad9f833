//! The controller in its place in RAM, which the tick and the session share.

use crate::ArmController;
use crate::drives::{BrushedDrives, Drives};
use crate::safety::State;
use crate::session::SharedController;
use crate::settings::CheckedSettings;
use core::mem::{self, MaybeUninit};
use rtic_core::Mutex;

/// Room for a controller that lasts as long as the program.
pub type Place<D = BrushedDrives> = MaybeUninit<ArmController<D>>;

/// What a lock guards: the controller in use, alone or with what else the tick has.
pub trait Guarded<D: Drives>: Sized {
    /// The controller in use.
    fn controller(&mut self) -> &mut &'static mut ArmController<D>;

    /// Takes from new settings what else is guarded needs to know.
    fn use_settings(_lock: &mut impl Mutex<T = Self>, _settings: &CheckedSettings) {}
}

impl<D: Drives> Guarded<D> for &'static mut ArmController<D> {
    fn controller(&mut self) -> &mut &'static mut ArmController<D> {
        self
    }
}

/// The controller in use, behind its lock, and a spare one. New settings are put to use by an exchange of
/// both: the tick does not wait while a controller is made or copied.
pub struct Exchanged<'a, Lock, D: Drives + 'static = BrushedDrives> {
    /// The lock of the controller in use.
    pub lock: Lock,
    /// What the next settings make a controller of.
    pub spare: &'a mut &'static mut ArmController<D>,
}

impl<D: Drives, Lock: Mutex<T: Guarded<D>>> Mutex for Exchanged<'_, Lock, D> {
    type T = ArmController<D>;

    fn lock<R>(&mut self, work: impl FnOnce(&mut ArmController<D>) -> R) -> R {
        self.lock.lock(|guarded| work(guarded.controller()))
    }
}

impl<D: Drives, Lock: Mutex<T: Guarded<D>>> SharedController<D> for Exchanged<'_, Lock, D> {
    fn renew(&mut self, settings: &CheckedSettings) -> Result<(), State> {
        self.spare.reset(settings);
        let spare = &mut *self.spare;
        self.lock.lock(|guarded| {
            let controller = guarded.controller();
            controller.hand_over(spare)?;
            mem::swap(controller, spare);
            Ok(())
        })?;
        Lock::T::use_settings(&mut self.lock, settings);
        Ok(())
    }
}
