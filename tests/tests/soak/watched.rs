//! A controller whose every tick is checked against the rules and the limits.

use fivebar_firmware::controller::Request;
use fivebar_firmware::{ActuatorCommand, Move, MoveKind, SensorSample, Settings, Status};
use fivebar_kinematics::five_bar::Side;
use fivebar_sim::link::{Target, TargetError};
use fivebar_stress::limits::{Followed, Limits, Reached};
use fivebar_stress::rules::Rules;

/// A target, the rules, and the limits of the moves.
pub(crate) struct Watched<T> {
    inner: T,
    rules: Rules,
    limits: Limits,
    assembly: Side,
    kinds: Vec<Followed>,
    /// Ticks that were checked.
    pub(crate) ticks: u32,
    /// The greatest shares of the limits.
    pub(crate) reached: Reached,
    /// The first rule that was broken.
    pub(crate) broken: Option<String>,
}

impl<T> Watched<T> {
    pub(crate) fn new(inner: T, settings: &Settings, moves: &[Move]) -> Self {
        let kinds = moves.iter().map(|next| match next.kind {
            MoveKind::Line { .. } | MoveKind::Arc { .. } => Followed::Path,
            MoveKind::Dwell { .. } => Followed::Dwell,
            MoveKind::Joint { .. } => Followed::Joint,
            MoveKind::Timed(_) | MoveKind::Crossing(_) => Followed::Timed,
        });
        Self {
            inner,
            // Every tick of such a run is a sign of life.
            rules: Rules::with_timeout(u32::MAX),
            limits: Limits::new(settings).expect("the settings of an arm"),
            assembly: settings.check().expect("valid settings").assembly(),
            kinds: kinds.collect(),
            ticks: 0,
            reached: Reached::default(),
            broken: None,
        }
    }
}

impl<T: Target> Target for Watched<T> {
    fn tick(&mut self, sample: &SensorSample) -> Result<(ActuatorCommand, Status), TargetError> {
        let (command, status) = self.inner.tick(sample)?;
        let rules = self.rules.check(self.ticks, sample, &command, &status);
        let tag = status.tag.and_then(|tag| self.kinds.get(tag as usize));
        // Nothing drops a path and begins another one in these runs, and nothing crosses.
        let limits = self.limits.check(&status, tag.copied(), 0, self.assembly);
        let broken = rules.map_err(|violation| violation.to_string());
        match broken.and(limits) {
            Ok(reached) => self.reached = self.reached.max(reached),
            Err(found) => {
                let tick = self.ticks;
                self.broken
                    .get_or_insert_with(|| format!("tick {tick}: {found}"));
            }
        }
        self.ticks += 1;
        Ok((command, status))
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.inner.request(request)?;
        match request {
            Request::Arm | Request::Home | Request::Excite(_) => self.rules.permitted = true,
            Request::EmergencyStop => self.rules.permitted = false,
            Request::ClearFault => self.rules.cleared = true,
            // The bridges go off when the brakes have engaged; in Stopped nothing is permitted.
            Request::Disarm | Request::Stop | Request::SetAngles(_) => {}
        }
        Ok(())
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        self.inner.offer(next)
    }

    fn is_idle(&self) -> bool {
        self.inner.is_idle()
    }
}
