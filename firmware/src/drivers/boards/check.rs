//! What the compiler refuses of a board.

use super::{BOARDS, Board, CommonPins, Pin, Row, Use};

const _: () = {
    let mut board = 0;
    while board < BOARDS.len() {
        check(&BOARDS[board]);
        board += 1;
    }
};

/// Whether two names are the same.
pub(super) const fn is_same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let mut same = one.len() == other.len();
    let mut at = 0;
    while same && at < one.len() {
        same = one[at] == other[at];
        at += 1;
    }
    same
}

const fn check(board: &Board) {
    assert!(
        matches!(board.crystal, 8 | 12 | 16),
        "a board's crystal is told by measurement"
    );
    if let Ok(pins) = &board.brushed {
        check_kind(&board.common, Board::BREAK, &pins.rows(), pins.sleep);
    }
    if let Ok(pins) = &board.stepper {
        check_kind(&board.common, Board::BREAK, &pins.rows(), pins.enable);
    }
    if let Ok(pins) = &board.can {
        check_rows(&board.common.rows(Use::Level), &pins.rows());
    }
}

/// Also that one write takes the power of both drives, and that nothing else changes the modes of their port meanwhile.
const fn check_kind(common: &CommonPins, stop: Use, rows: &[Row], [power1, power4]: [Pin; 2]) {
    assert!(
        power1.port() == power4.port(),
        "the pins of both drives' power are in one port"
    );
    assert!(
        power1.port() != common.tool.port(),
        "the tool's pin is in another port than those of the drives' power"
    );
    check_rows(&common.rows(stop), rows);
}

const fn check_rows(common: &[Row], own: &[Row]) {
    let all = common.len() + own.len();
    let mut at = 0;
    while at < all {
        let row = nth(common, own, at);
        if let Use::Of(peripheral) = row.uses {
            assert!(
                peripheral.is_at(row.pin),
                "a peripheral does not have its signal at this pin"
            );
        }
        let mut before = 0;
        while before < at {
            assert!(
                nth(common, own, before).pin.0 != row.pin.0,
                "two signals share a pin"
            );
            before += 1;
        }
        at += 1;
    }
}

const fn nth(common: &[Row], own: &[Row], at: usize) -> Row {
    if at < common.len() {
        common[at]
    } else {
        own[at - common.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BrushedPins, CanPins, REFERENCE};
    use super::*;

    const fn pin(port: u8, number: u8) -> Pin {
        Pin::new(port, number)
    }

    fn brushed(change: impl Fn(&mut BrushedPins)) -> Board {
        let mut pins = REFERENCE.brushed();
        change(&mut pins);
        Board {
            brushed: Ok(pins),
            ..REFERENCE
        }
    }

    #[test]
    #[should_panic(expected = "two signals share a pin")]
    fn two_signals_at_one_pin_are_refused() {
        let home1 = REFERENCE.common.home[0];
        check(&brushed(|pins| pins.index[1] = home1));
    }

    #[test]
    #[should_panic(expected = "does not have its signal at this pin")]
    fn a_signal_where_its_peripheral_does_not_have_it_is_refused() {
        let can = Ok(CanPins {
            bus: [pin(b'D', 1), pin(b'D', 0)],
        });
        check(&Board { can, ..REFERENCE });
    }

    #[test]
    #[should_panic(expected = "one port")]
    fn drives_whose_power_one_write_does_not_take_are_refused() {
        check(&brushed(|pins| pins.sleep[1] = pin(b'C', 13)));
    }

    #[test]
    #[should_panic(expected = "another port")]
    fn a_tool_in_the_port_of_the_drives_power_is_refused() {
        let mut board = REFERENCE;
        board.common.tool = pin(b'B', 5);
        check(&board);
    }

    #[test]
    #[should_panic(expected = "told by measurement")]
    fn a_crystal_that_is_not_told_by_measurement_is_refused() {
        check(&Board {
            crystal: 25,
            ..REFERENCE
        });
    }

    #[test]
    fn each_board_is_found_by_its_name_alone() {
        for board in BOARDS {
            let found = Board::named(board.name).map(|found| found.what);
            assert_eq!(found, Some(board.what));
        }
        assert!(Board::named("stm32f405").is_none());
    }
}
