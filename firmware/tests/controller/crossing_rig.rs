//! A bench for crossings. It has no arm that passes a singularity, so its cranks follow their reference, or do what a
//! test makes them do; their motors have the currents that their duties drive.

pub(crate) use crate::crossing_arm::CROSSING as PLAN;
use crate::crossing_arm::cross;
use crate::rig::{Bench, WAKING_TICKS, with};
use fivebar_firmware::controller::{Controller, Request};
use fivebar_firmware::planner::{MoveErrorKind, Planner};
use fivebar_firmware::settings::Settings;
use fivebar_firmware::{CrossingMove, Move, MoveKind, Status};

pub(crate) fn settings() -> Settings {
    with(cross)
}

/// θ1, θ4 at its beginning [rad].
pub(crate) const START: [f32; 2] = [2.161_249, 0.578_428_03];

/// The same with motors for 20 A whose inductance lets hardly any current flow: what a test makes the cranks' sensors
/// show then contradicts the motors' equation by less than a tenth of 20 A.
pub(crate) fn strong() -> Settings {
    let mut settings = settings();
    settings.protection.over_current = 20.0;
    for axis in &mut settings.axes {
        (axis.peak_current, axis.continuous_current) = (20.0, 20.0);
        axis.inductance = 10.0;
        axis.current_per_code = 0.01;
    }
    settings
}

/// A controller, its planner and the cranks.
pub(crate) struct Rig {
    pub(crate) controller: Controller,
    pub(crate) planner: Planner,
    pub(crate) bench: Bench,
    /// The duties that act until the next tick, and those that act after it.
    duties: [[f32; 2]; 2],
}

impl Rig {
    pub(crate) fn stopped(settings: &Settings) -> Self {
        let checked = settings.check().unwrap();
        let mut rig = Self {
            controller: Controller::new(&checked),
            planner: Planner::new(&checked),
            bench: Bench::new(settings),
            duties: [[0.0; 2]; 2],
        };
        rig.bench.theta = START.map(f64::from);
        rig.tick();
        rig
    }

    pub(crate) fn armed(settings: &Settings) -> Self {
        let mut rig = Self::stopped(settings);
        rig.controller.request(Request::SetAngles(START)).unwrap();
        rig.controller.request(Request::Arm).unwrap();
        for _ in 0..=WAKING_TICKS {
            rig.tick();
        }
        rig
    }

    /// One tick, after which the cranks stay where they are.
    pub(crate) fn tick(&mut self) -> Status {
        self.plan();
        let status = self.sample();
        self.drive([0.0; 2]);
        status
    }

    /// One tick, after which the cranks are at their reference.
    pub(crate) fn follow(&mut self) -> Status {
        self.plan();
        self.follow_alone()
    }

    /// The same without planner and host.
    pub(crate) fn follow_alone(&mut self) -> Status {
        self.follow_alone_off([0.0; 2], [0.0; 2])
    }

    /// One tick, after which the cranks are off their reference by these angles [rad], which change at these
    /// rates [rad/s].
    pub(crate) fn follow_off(&mut self, off: [f64; 2], rate: [f64; 2]) -> Status {
        self.plan();
        self.follow_alone_off(off, rate)
    }

    /// The same without planner and host.
    pub(crate) fn follow_alone_off(&mut self, off: [f64; 2], rate: [f64; 2]) -> Status {
        let status = self.sample();
        let mut velocity = rate;
        if let Some(joints) = status.joint_reference {
            for j in 0..2 {
                velocity[j] += f64::from(joints.velocity[j]);
                self.bench.theta[j] =
                    f64::from(joints.angle[j]) + 1e-4 * f64::from(joints.velocity[j]) + off[j];
            }
        }
        self.drive(velocity);
        status
    }

    fn plan(&mut self) {
        self.controller.feed_host_timeout();
        self.planner.run(&mut self.controller);
    }

    fn sample(&mut self) -> Status {
        self.controller.tick(&self.bench.sense());
        self.controller.status()
    }

    /// The currents that the duties drive in a tick at these speeds [rad/s].
    fn drive(&mut self, velocity: [f64; 2]) {
        let [acting, next] = self.duties;
        self.duties = [next, self.controller.status().duty];
        for (j, axis) in self.controller.settings().axes.iter().enumerate() {
            let (r, l) = (f64::from(axis.resistance), f64::from(axis.inductance));
            let kept = (-r * 1e-4 / l).exp();
            let emf = f64::from(axis.gear_ratio * axis.torque_constant) * velocity[j];
            let through = (f64::from(acting[j]) * self.bench.bus - emf) / r;
            let current = &mut self.bench.current[j];
            *current = kept * *current + (1.0 - kept) * through;
        }
    }

    pub(crate) fn push(&mut self, tool: u16, plan: CrossingMove) -> Result<(), MoveErrorKind> {
        let kind = MoveKind::Crossing(plan);
        let pushed = self
            .planner
            .push(&mut self.controller, &Move { tag: 7, tool, kind });
        pushed.map_err(|error| error.kind)
    }

    /// A crossing that has begun.
    pub(crate) fn crossing() -> Self {
        Self::crossing_with(&settings())
    }

    pub(crate) fn crossing_with(settings: &Settings) -> Self {
        let mut rig = Self::armed(settings);
        rig.push(0, PLAN).unwrap();
        rig
    }
}
