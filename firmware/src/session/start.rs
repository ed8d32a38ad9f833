//! The fault with which a board starts.

use crate::protocol::Reset;
use crate::safety::Fault;
use crate::storage::StorageError;

/// The fault with which a board starts, the most serious first: a clock failure, a reset other
/// than by power-up, damaged settings. Such a reset may have come while the arm moved, so a host
/// must see it and clear it. A board on which no settings were ever stored starts without a fault,
/// but the session lets nothing move until some are applied.
pub fn fault_at_start(
    crystal_runs: bool,
    reset: Reset,
    settings: Option<StorageError>,
) -> Option<Fault> {
    if !crystal_runs {
        return Some(Fault::ClockFailure);
    }
    match reset {
        Reset::Watchdog => Some(Fault::WatchdogReset),
        Reset::Panic => Some(Fault::Panic),
        Reset::HardFault => Some(Fault::HardFault),
        Reset::BrownOut => Some(Fault::BrownOut),
        Reset::Software | Reset::Pin | Reset::Unknown => Some(Fault::UnexpectedReset),
        Reset::Power => match settings {
            Some(StorageError::Corrupt) => Some(Fault::SettingsCorrupt),
            Some(StorageError::Blank | StorageError::Flash | StorageError::Range) | None => None,
        },
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
            (true, Reset::Software, None, Some(Fault::UnexpectedReset)),
            (true, Reset::Pin, blank, Some(Fault::UnexpectedReset)),
            (true, Reset::Unknown, None, Some(Fault::UnexpectedReset)),
            (true, Reset::Panic, None, Some(Fault::Panic)),
            (true, Reset::HardFault, corrupt, Some(Fault::HardFault)),
            (true, Reset::BrownOut, None, Some(Fault::BrownOut)),
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
