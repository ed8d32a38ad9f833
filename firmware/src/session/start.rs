//! What a board found out while it started.

use crate::protocol::Reset;
use crate::safety::Fault;
use crate::storage::StorageError;

/// The fault that a board starts with, the gravest first: a clock that does not run as it
/// should, a watchdog that had to reset, settings that are damaged. Settings that were
/// never stored are no fault; nothing moves without them all the same.
pub fn fault_at_start(
    crystal_runs: bool,
    reset: Reset,
    settings: Option<StorageError>,
) -> Option<Fault> {
    if !crystal_runs {
        return Some(Fault::ClockFailure);
    }
    match (reset, settings) {
        (Reset::Watchdog, _) => Some(Fault::WatchdogReset),
        (_, Some(StorageError::Corrupt)) => Some(Fault::SettingsCorrupt),
        (_, Some(StorageError::Blank | StorageError::Flash | StorageError::Range) | None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::fault_at_start;
    use crate::protocol::Reset;
    use crate::safety::Fault;
    use crate::storage::StorageError;

    #[test]
    fn a_board_starts_with_the_gravest_of_what_it_found() {
        let corrupt = Some(StorageError::Corrupt);
        let blank = Some(StorageError::Blank);
        for (crystal, reset, settings, fault) in [
            (true, Reset::Power, None, None),
            (true, Reset::Power, blank, None),
            (true, Reset::Panic, None, None),
            (true, Reset::Power, corrupt, Some(Fault::SettingsCorrupt)),
            (true, Reset::Watchdog, None, Some(Fault::WatchdogReset)),
            (true, Reset::Watchdog, corrupt, Some(Fault::WatchdogReset)),
            (false, Reset::Watchdog, corrupt, Some(Fault::ClockFailure)),
            (false, Reset::Power, None, Some(Fault::ClockFailure)),
        ] {
            assert_eq!(fault_at_start(crystal, reset, settings), fault, "{reset:?}");
        }
    }
}
