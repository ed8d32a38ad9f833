//! What the session needs from this board: it stores nothing, and its ticks come from the host.

use super::instructions::InstructionCounter;
use crate::board::stack;
use crate::drives::DriveInterface;
use crate::protocol::StackUse;
use crate::recorder::{Log, Recorder};
use crate::session::Board;
use crate::settings::CheckedSettings;
use crate::storage::StorageError;
use crate::{ArmCommand, ArmController, ArmSample, Settings};

/// The log at the tick rate.
static LOG: Log = Log::new();

/// This board, with its end of the wires to these drives.
pub struct Lockstep<I: DriveInterface> {
    counter: InstructionCounter,
    link: I::Link,
}

impl<I: DriveInterface> Lockstep<I> {
    /// The board with the drives of these settings.
    pub fn new(counter: InstructionCounter, settings: &CheckedSettings) -> Self {
        let link = I::link(settings);
        Self { counter, link }
    }
}

impl<I: DriveInterface> Board<I::Drives, I::Sample, I::Command> for Lockstep<I> {
    fn save(&mut self, _: &Settings) -> Result<(), StorageError> {
        Err(StorageError::Flash)
    }

    fn use_settings(&mut self, settings: &CheckedSettings) {
        self.link = I::link(settings);
    }

    fn tick(
        &mut self,
        controller: &mut ArmController<I::Drives>,
        sample: &ArmSample<I::Sample>,
    ) -> Option<(ArmCommand<I::Command>, u32)> {
        // On a board, too, only an emergency stop interrupts a tick.
        let (sensed, told, command, instructions) = cortex_m::interrupt::free(|_| {
            let start = self.counter.now();
            let sensed = I::sense(&mut self.link, sample);
            let told = controller.tick(&sensed);
            let command = I::command(&mut self.link, &told);
            (sensed, told, command, self.counter.since(start))
        });
        LOG.recorder()
            .record(controller.drives(), &sensed, &told, controller.ticks());
        Some((command, instructions))
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(LOG.recorder())
    }

    fn stack(&self) -> Option<StackUse> {
        Some(stack::used())
    }
}
