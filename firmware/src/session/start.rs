//! The fault with which a board starts.

use crate::protocol::Reset;
use crate::safety::Fault;
use crate::storage::StorageError;

/// The fault with which a board starts, the most serious first: a clock failure, a watchdog
/// reset, damaged settings. A board on which no settings were ever stored starts without a fault,
/// but the session lets nothing move until some are applied.
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
    fn a_board_starts_with_the_most_serious_fault() {
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
