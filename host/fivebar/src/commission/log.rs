//! The rows of a log in units.

use fivebar_firmware::recorder::{LogConfig, Signals};
use fivebar_kinematics::five_bar::Joint;

/// The rows of a log.
#[derive(Debug)]
pub(super) struct LogRows {
    signals: Signals,
    words: Vec<u16>,
}

impl LogRows {
    pub(super) fn new(config: &LogConfig, words: Vec<u16>) -> Self {
        Self {
            signals: Signals::from_bits_truncate(config.signals),
            words,
        }
    }

    /// The words of one signal, row by row; none if it was not recorded.
    fn column(&self, signal: Signals) -> impl Iterator<Item = u16> + '_ {
        let width = self.signals.bits().count_ones() as usize;
        let before = self.signals.bits() & (signal.bits() - 1);
        let place = before.count_ones() as usize;
        let recorded = self.signals.contains(signal);
        let rows = self.words.chunks_exact(width.max(1));
        rows.filter(move |_| recorded).map(move |row| row[place])
    }

    /// The counts of a joint, from the first row on.
    pub(super) fn counts(&self, joint: Joint) -> Vec<f64> {
        let signal = [Signals::COUNTS_1, Signals::COUNTS_4][joint];
        let (mut last, mut sum) = (None, 0.0);
        self.column(signal)
            .map(|word| {
                let before = last.replace(word).unwrap_or(word);
                sum += f64::from(word.wrapping_sub(before) as i16);
                sum
            })
            .collect()
    }

    /// The codes of a joint's current.
    pub(super) fn current_codes(&self, joint: Joint) -> Vec<f64> {
        let signal = [Signals::SENSED_1, Signals::SENSED_4][joint];
        self.column(signal).map(f64::from).collect()
    }

    /// The duties of a joint.
    pub(super) fn duties(&self, joint: Joint) -> Vec<f64> {
        let signal = [Signals::TOLD_1, Signals::TOLD_4][joint];
        let duty = |word: u16| f64::from(word as i16) / 32_767.0;
        self.column(signal).map(duty).collect()
    }

    /// The codes of the bus voltage.
    pub(super) fn bus_codes(&self) -> Vec<f64> {
        self.column(Signals::SENSED_OF_BOTH)
            .map(f64::from)
            .collect()
    }
}
