//! Follows trajectories by a stream of joint set-points. A new trajectory takes the place of what is left of the one before,
//! from the motion that the set-points have then.

use super::messages::JointTrajectory;
use super::trajectory::{Place, Trajectory, Unfollowed};
use fivebar_firmware::Status;
use fivebar_firmware::motion::{FIXTURES, StreamMode, StreamPolicy};
use fivebar_sim::drive::held_angles;
use fivebar_sim::live::{LiveArm, LiveError, LiveStream};
use fivebar_sim::streaming::{SetPoint, StreamOptions};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use tokio::sync::oneshot;

/// Set-points per second [1/s].
const RATE: f64 = 200.0;
/// Time for which the stream goes on behind the end of a trajectory [s]: a sender of short ones gives the next one meanwhile.
const HOLD: f64 = 0.1;

/// Why a trajectory was not followed to its end.
#[derive(Debug, thiserror::Error)]
pub(super) enum Ended {
    /// It was refused before the arm moved.
    #[error(transparent)]
    Unfollowed(#[from] Unfollowed),
    /// The arm cannot move, or stopped.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// Another one took its place.
    #[error("another trajectory has taken its place")]
    Replaced,
    /// The motion before it was stopped.
    #[error("the arm was stopped: send it again")]
    Stopped,
}

/// A trajectory to follow, and who wants to know how it ended.
struct Order {
    message: JointTrajectory,
    done: oneshot::Sender<Result<(), Ended>>,
}

/// The thread that follows trajectories.
#[derive(Clone)]
pub(super) struct Follower {
    orders: Sender<Order>,
    desired: Arc<Mutex<Option<Place>>>,
}

impl Follower {
    /// For this arm. The thread ends with the last of its followers.
    pub(super) fn new(arm: Arc<LiveArm>) -> Self {
        let (orders, received) = mpsc::channel();
        let desired = Arc::default();
        let worker = Worker {
            arm,
            orders: received,
            desired: Arc::clone(&desired),
        };
        thread::spawn(move || worker.run());
        Self { orders, desired }
    }

    /// Follows a trajectory; the answer comes when the arm rests at its end.
    pub(super) fn follow(&self, message: JointTrajectory) -> oneshot::Receiver<Result<(), Ended>> {
        let (done, answer) = oneshot::channel();
        // A worker that has gone drops `done`, and the answer says so.
        let _ = self.orders.send(Order { message, done });
        answer
    }

    /// Where the trajectory wants the arm now; none: it follows none.
    pub(super) fn desired(&self) -> Option<Place> {
        *self.desired.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct Worker {
    arm: Arc<LiveArm>,
    orders: Receiver<Order>,
    desired: Arc<Mutex<Option<Place>>>,
}

impl Worker {
    fn run(self) {
        while let Ok(Order { message, done }) = self.orders.recv() {
            let (trajectory, stream) = match self.begin(&message) {
                Ok(begun) => begun,
                Err(error) => {
                    // Who asked may be gone.
                    let _ = done.send(Err(error));
                    continue;
                }
            };
            let done = self.stream(trajectory, &stream, done);
            let ended = stream.finish().map_err(Ended::Live);
            self.want(None);
            if ended.is_err() {
                // What was sent before the arm stopped does not move it again.
                for order in self.orders.try_iter() {
                    let _ = order.done.send(Err(Ended::Stopped));
                }
            }
            let _ = done.send(ended);
        }
    }

    fn begin(&self, message: &JointTrajectory) -> Result<(Trajectory, LiveStream), Ended> {
        let rest = Place {
            position: angles(&self.arm.progress().status),
            velocity: [0.0; 2],
        };
        let trajectory = Trajectory::new(message, rest, &self.arm.robot().limits)?;
        let stream = self.arm.stream(StreamOptions {
            mode: StreamMode::Joint,
            rate: RATE,
            delay: None,
            policy: StreamPolicy::Stop,
            fixtures: [None; FIXTURES],
        })?;
        Ok((trajectory, stream))
    }

    /// Gives set-points until the trajectory, or one that takes its place, is over. Returns who waits for the last one.
    fn stream(
        &self,
        mut trajectory: Trajectory,
        stream: &LiveStream,
        mut done: oneshot::Sender<Result<(), Ended>>,
    ) -> oneshot::Sender<Result<(), Ended>> {
        let mut points = 0_u32;
        loop {
            let time = f64::from(points) / RATE;
            let place = trajectory.at(time);
            let next = Order::next_of(&self.orders, place, &self.arm);
            if let Some((taken, waits)) = next {
                let _ = std::mem::replace(&mut done, waits).send(Err(Ended::Replaced));
                (trajectory, points) = (taken, 1);
                continue;
            }
            self.want(Some(place));
            let Place { position, velocity } = place;
            let goes_on = stream.send(SetPoint {
                position,
                velocity: Some(velocity),
                force: [0.0; 2],
            });
            if !goes_on || time >= trajectory.time() + HOLD {
                return done;
            }
            points += 1;
        }
    }

    fn want(&self, place: Option<Place>) {
        *self.desired.lock().unwrap_or_else(PoisonError::into_inner) = place;
    }
}

impl Order {
    /// The newest order that can be followed from this motion; those that cannot are told so.
    fn next_of(
        orders: &Receiver<Self>,
        from: Place,
        arm: &LiveArm,
    ) -> Option<(Trajectory, oneshot::Sender<Result<(), Ended>>)> {
        let mut next: Option<(Trajectory, oneshot::Sender<_>)> = None;
        for Self { message, done } in orders.try_iter() {
            match Trajectory::new(&message, from, &arm.robot().limits) {
                Ok(trajectory) => {
                    if let Some((_, before)) = next.replace((trajectory, done)) {
                        let _ = before.send(Err(Ended::Replaced));
                    }
                }
                Err(error) => {
                    let _ = done.send(Err(error.into()));
                }
            }
        }
        next
    }
}

/// θ1, θ4 of the arm [rad]: where it is held, otherwise where it is.
fn angles(status: &Status) -> [f64; 2] {
    held_angles(status).unwrap_or(status.angle).map(f64::from)
}
