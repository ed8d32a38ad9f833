//! The heights of the pen: tried by sliders of the page in control, and kept.

use super::controller_thread::ControllerThread;
use super::requests::Refused;
use super::wire::lease::PageId;
use super::wire::message::{ClientRequest, PenPosition};
use crate::pen_heights::{Height, PenTrial};
use fivebar_firmware::safety::State;
use fivebar_sim::controller::SpeedMeter;
use fivebar_sim::link::LinkError;

impl ControllerThread {
    /// Tries or keeps a height of the pen; none: the request is another one.
    pub(super) fn try_pen(
        &mut self,
        page: PageId,
        request: &ClientRequest,
    ) -> Result<Option<Result<(), Refused>>, LinkError> {
        let outcome = match *request {
            ClientRequest::PenHeight { pen, width } => {
                let height = match pen {
                    PenPosition::Up => Height::Up,
                    PenPosition::Down => Height::Down,
                };
                self.hold_pen(page, height, width)?
            }
            ClientRequest::KeepPen => self.keep_pen()?,
            _ => return Ok(None),
        };
        Ok(Some(outcome))
    }

    /// The widths of the servo's pulse with the pen up and down [s]; none without a servo.
    pub(super) fn pen_widths(&self) -> Option<[f32; 2]> {
        let own = || PenTrial::of(&self.session.settings).ok();
        let tried = self.pen.map(|(_, trial)| trial);
        Some(tried.or_else(own)?.widths)
    }

    fn hold_pen(
        &mut self,
        page: PageId,
        height: Height,
        width: f64,
    ) -> Result<Result<(), Refused>, LinkError> {
        let own = || PenTrial::of(&self.session.settings);
        let begun = self.pen.map_or_else(own, |(_, trial)| Ok(trial));
        let mut trial = match begun {
            Ok(trial) => trial,
            Err(why) => return Ok(Err(why)),
        };
        let held = trial.hold(&mut self.session, height, width)?;
        if held.is_ok() {
            self.pen = Some((page, trial));
            self.begin_time_anew();
        }
        Ok(held)
    }

    fn keep_pen(&mut self) -> Result<Result<(), Refused>, LinkError> {
        let Some((_, trial)) = self.pen else {
            return Ok(Err(
                "No height of the pen was tried: move a slider first.".into()
            ));
        };
        let kept = trial.keep(&mut self.session, &self.keep)?;
        self.begin_time_anew();
        if kept.is_ok() {
            self.pen = None;
            self.notice("The robot file has the heights of the pen. Home the arm.");
        }
        Ok(kept)
    }

    /// Gives the controller its own settings back, before an arm is powered and where the page that tried others is
    /// in control no more.
    pub(super) fn end_pen_trial(&mut self) -> Result<Result<(), Refused>, LinkError> {
        if self.pen.is_none() {
            return Ok(Ok(()));
        }
        let ended = PenTrial::end(&mut self.session)?;
        if ended.is_ok() {
            self.pen = None;
            self.begin_time_anew();
        }
        Ok(ended)
    }

    /// Ends a trial whose page is in control no more.
    pub(super) fn end_pen_trial_of_a_lost_page(&mut self) -> Result<(), LinkError> {
        let Some((page, _)) = self.pen else {
            return Ok(());
        };
        if !self.has_control(page) && self.session.status.state == State::Stopped {
            // Refused only in another state: later then.
            let _ = self.end_pen_trial()?;
        }
        Ok(())
    }

    /// A controller with new settings counts its time from 0.
    fn begin_time_anew(&mut self) {
        self.speed = SpeedMeter::from(0.0, self.session.clock.now());
    }
}
