//! The key Enter, by which the user lets a job go on at a pause.

use super::say::hint;
use fivebar_files::job::Pause;
use fivebar_sim::drive::DriveError;
use indicatif::ProgressBar;
use std::io::{self, BufRead};
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::thread;

/// Lines of the standard input. A line counts only after its pause was shown, so that nothing typed
/// earlier lets the arm go on.
pub(super) struct EnterKey<'a> {
    bar: &'a ProgressBar,
    lines: Receiver<()>,
    /// The number of moves before the pause that was shown last.
    shown: Option<usize>,
}

impl<'a> EnterKey<'a> {
    /// Reads `input` in a thread that ends with it.
    pub(super) fn listen(bar: &'a ProgressBar, input: impl BufRead + Send + 'static) -> Self {
        let (sender, lines) = mpsc::channel();
        thread::spawn(move || {
            for line in input.lines() {
                if line.is_err() || sender.send(()).is_err() {
                    return;
                }
            }
        });
        Self {
            bar,
            lines,
            shown: None,
        }
    }

    /// The standard input.
    pub(super) fn of_terminal(bar: &'a ProgressBar) -> Self {
        Self::listen(bar, io::BufReader::new(io::stdin()))
    }

    /// Shows the pause once; returns whether Enter was pressed since.
    pub(super) fn lets_go_on(&mut self, pause: &Pause) -> Result<bool, DriveError> {
        if self.shown != Some(pause.before) {
            self.shown = Some(pause.before);
            while self.lines.try_recv().is_ok() {}
            self.bar
                .suspend(|| hint(format_args!("{}, then press Enter\n", pause.text)));
        }
        match self.lines.try_recv() {
            Ok(()) => Ok(true),
            Err(TryRecvError::Empty) => Ok(false),
            Err(TryRecvError::Disconnected) => Err(DriveError::NoInput(pause.text.clone())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::EnterKey;
    use fivebar_files::job::Pause;
    use fivebar_sim::drive::DriveError;
    use indicatif::ProgressBar;
    use std::io::{BufReader, Write};
    use std::thread::sleep;
    use std::time::Duration;

    #[test]
    fn enter_counts_after_its_pause_was_shown_and_a_closed_input_ends_the_job() {
        let bar = ProgressBar::hidden();
        let (input, mut keys) = std::io::pipe().expect("a pipe");
        let mut enter = EnterKey::listen(&bar, BufReader::new(input));
        let wait = || sleep(Duration::from_millis(200));
        let pause = |before| Pause {
            before,
            text: "Pen change: red".into(),
        };
        keys.write_all(b"\n\n").expect("the pipe takes lines");
        wait();
        assert!(!enter.lets_go_on(&pause(3)).expect("an open input"));
        keys.write_all(b"\n").expect("the pipe takes lines");
        wait();
        assert!(enter.lets_go_on(&pause(3)).expect("an open input"));
        drop(keys);
        wait();
        let closed = enter.lets_go_on(&pause(9));
        assert!(matches!(closed, Err(DriveError::NoInput(text)) if text == "Pen change: red"));
    }
}
