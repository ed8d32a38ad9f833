//! What a terminal shows while a job is read and placed: of a picture, a fit or many copies this takes seconds.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Time between two steps of the sign.
const STEP: Duration = Duration::from_millis(200);

/// Does a part of the work, and says meanwhile what is done and since when; on a terminal only.
pub(super) fn preparing<T>(what: &str, file: &str, work: impl FnOnce() -> T) -> T {
    shown(&ProgressBar::new_spinner(), what, file, work)
}

fn shown<T>(bar: &ProgressBar, what: &str, file: &str, work: impl FnOnce() -> T) -> T {
    let style = ProgressStyle::with_template("{spinner} {wide_msg}  {elapsed}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar.set_message(format!("{what} {file} …"));
    bar.enable_steady_tick(STEP);
    let done = work();
    bar.finish_and_clear();
    done
}

#[cfg(test)]
mod tests {
    use super::shown;
    use indicatif::{ProgressBar, ProgressDrawTarget, TermLike};
    use std::io;
    use std::sync::{Arc, Mutex, PoisonError};

    /// A terminal that keeps the present text.
    #[derive(Clone, Debug, Default)]
    struct Screen(Arc<Mutex<String>>);

    impl Screen {
        fn text(&self) -> String {
            self.0
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clone()
        }

        fn write(&self, text: &str) -> io::Result<()> {
            let mut screen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            screen.push_str(text);
            Ok(())
        }
    }

    impl TermLike for Screen {
        fn width(&self) -> u16 {
            80
        }

        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write(text)
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.write(text)
        }

        fn clear_line(&self) -> io::Result<()> {
            self.0
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clear();
            Ok(())
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_terminal_shows_the_file_while_it_is_read_and_nothing_afterwards() {
        let screen = Screen::default();
        let target = ProgressDrawTarget::term_like(Box::new(screen.clone()));
        let bar = ProgressBar::with_draw_target(None, target);
        let during = shown(&bar, "reading", "photo.png", || screen.text());
        assert!(during.contains("reading photo.png …"), "{during:?}");
        assert_eq!(screen.text().trim(), "");
    }
}
