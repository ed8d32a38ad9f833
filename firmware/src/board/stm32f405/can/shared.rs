//! The controller and the bus, which new settings change together.

use super::bus::{self, Bus};
use crate::ArmController;
use crate::board::SharedController;
use crate::drives::TorqueDrives;
use crate::safety::State;
use crate::settings::CheckedSettings;
use rtic_core::Mutex;

/// The shared controller, with the lock of the bus.
pub struct WithBus<Controller, Lock> {
    /// The controller.
    pub controller: Controller,
    /// The lock of the bus.
    pub bus: Lock,
}

impl<Controller: Mutex, Lock> Mutex for WithBus<Controller, Lock> {
    type T = Controller::T;

    fn lock<R>(&mut self, work: impl FnOnce(&mut Self::T) -> R) -> R {
        self.controller.lock(work)
    }
}

impl<Controller, Lock> SharedController<TorqueDrives> for WithBus<Controller, Lock>
where
    Controller: SharedController<TorqueDrives> + Mutex<T = ArmController<TorqueDrives>>,
    Lock: Mutex<T = &'static mut Bus>,
{
    fn renew(&mut self, settings: &CheckedSettings) -> Result<(), State> {
        self.controller.renew(settings)?;
        bus::exchange(&mut self.bus, settings);
        Ok(())
    }
}
