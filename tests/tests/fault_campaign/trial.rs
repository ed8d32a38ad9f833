//! A trial: an arm, a state, a fault and its time, all from a seed.

use crate::arms::Arm;
use crate::injected::{Fault, KINDS};
use oorandom::Rand64;

/// The state in which a fault is injected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum During {
    Stopped,
    Waking,
    Homing,
    Exciting,
    Armed,
    RunningSlowly,
    RunningFast,
    TimeOptimal,
    Stopping,
    Crossing,
    Held,
}

impl During {
    pub(crate) const ALL: [Self; 11] = [
        Self::Stopped,
        Self::Waking,
        Self::Homing,
        Self::Exciting,
        Self::Armed,
        Self::RunningSlowly,
        Self::RunningFast,
        Self::TimeOptimal,
        Self::Stopping,
        Self::Crossing,
        Self::Held,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Stopped => "stopped",
            Self::Waking => "waking",
            Self::Homing => "homing",
            Self::Exciting => "exciting",
            Self::Armed => "armed",
            Self::RunningSlowly => "running slowly",
            Self::RunningFast => "running fast",
            Self::TimeOptimal => "time-optimal",
            Self::Stopping => "stopping",
            Self::Crossing => "crossing",
            Self::Held => "held by fault 12",
        }
    }

    /// Whether an arm can be in it. An upright arm falls while it is excited.
    fn suits(self, arm: &Arm) -> bool {
        match self {
            Self::Crossing => arm.crossing.is_some(),
            Self::Exciting => arm.robot.gravity.norm() == 0.0,
            _ => true,
        }
    }

    /// The longest time from the beginning of the state to the fault [s].
    pub(crate) fn longest(self) -> f64 {
        match self {
            Self::Waking => 2.5e-3,
            Self::Stopping => 0.03,
            Self::Stopped | Self::Exciting | Self::Armed => 0.1,
            Self::Homing | Self::Crossing | Self::Held => 0.3,
            Self::RunningSlowly | Self::RunningFast | Self::TimeOptimal => 0.5,
        }
    }
}

/// A trial.
#[derive(Clone, Debug)]
pub(crate) struct Trial {
    pub(crate) seed: u64,
    /// The index of the arm.
    pub(crate) arm: usize,
    pub(crate) during: During,
    /// Time from the beginning of the state to the fault [s].
    pub(crate) after: f64,
    /// The index of the kind of fault.
    pub(crate) kind: usize,
    pub(crate) fault: Fault,
}

impl Trial {
    /// Every kind of fault meets every state in turn; the rest is random.
    pub(crate) fn of(seed: u64, arms: &[Arm]) -> Self {
        let random = &mut Rand64::new(seed.into());
        let kinds = KINDS.len() as u64;
        let kind = (seed % kinds) as usize;
        let during = During::ALL[((seed / kinds) % During::ALL.len() as u64) as usize];
        let suits = |arm: &usize| (KINDS[kind].suits)(&arms[*arm]);
        let mut able: Vec<_> = (0..arms.len()).filter(suits).collect();
        let mut during = during;
        if able.iter().any(|&arm| during.suits(&arms[arm])) {
            able.retain(|&arm| during.suits(&arms[arm]));
        } else {
            during = During::RunningFast;
        }
        let arm = able[random.rand_range(0..able.len() as u64) as usize];
        Self {
            seed,
            arm,
            during,
            after: random.rand_float() * during.longest(),
            kind,
            fault: KINDS[kind].fault(random, &arms[arm]),
        }
    }
}
