//! What the tick has, and shares with the session.

use super::{Parts, Sample};
use crate::ArmController;
use crate::board::exchanged::Guarded;
use crate::settings::CheckedSettings;
use rtic_core::Mutex;

/// What the tick has, under one lock: each one more would cost it cycles.
pub struct Locked<P: Parts> {
    /// The controller in use.
    pub controller: &'static mut ArmController<P::Drives>,
    /// The parts for its drives.
    pub parts: P,
    /// The sample of the last tick.
    pub sample: Sample<P>,
}

impl<P: Parts> Guarded<P::Drives> for Locked<P> {
    fn controller(&mut self) -> &mut &'static mut ArmController<P::Drives> {
        &mut self.controller
    }

    fn use_settings(lock: &mut impl Mutex<T = Self>, settings: &CheckedSettings) {
        P::use_settings(lock, settings);
    }
}
