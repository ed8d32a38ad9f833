//! Both images, as the rows of the table see them.

use crate::bench::Bench;
use fivebar_firmware::protocol::{HostCommand, Reply, Reset};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Request};
use fivebar_pico::{HZ, Image};

/// An image, and the robot that it drives.
pub(crate) struct Description {
    pub(crate) image: &'static str,
    robot: &'static str,
    /// Its drives have power by pulses alone.
    pub(crate) by_pulses: bool,
}

pub(crate) const STEPPER: Description = Description {
    image: "rp2350_stepper",
    robot: "benchtop_stepper",
    by_pulses: false,
};
pub(crate) const SERVO: Description = Description {
    image: "rp2350_servo",
    robot: "classroom_servo",
    by_pulses: true,
};

/// Longer than a frame of pulses, and than a tick.
pub(crate) const FRAME: u64 = HZ / 40;
/// The watchdog's 50 ms, and the start behind it.
pub(crate) const BITTEN: u64 = HZ * 64 / 1000;

impl Description {
    /// The image has started, and has its settings.
    pub(crate) fn started(&self) -> Bench {
        Bench::of(self.image, self.robot)
    }

    /// Its angles are known, and its drives have power.
    pub(crate) fn armed(&self) -> Bench {
        let mut bench = self.started();
        if self.by_pulses {
            bench.power();
        } else {
            let angles = bench.settings.axes.each_ref().map(|axis| axis.home_angle);
            bench.request(Request::SetAngles(angles)).expect("accepted");
            bench.line.chip().run(HZ * 3 / 10).expect("it runs");
        }
        assert_eq!(bench.status().state, State::Armed);
        bench
    }

    /// It moves, and goes on to for a second.
    pub(crate) fn moving(&self) -> Bench {
        let mut bench = self.armed();
        go(&mut bench, [-0.2, 0.2], 0.2);
        pass(&mut bench, HZ / 10);
        bench
    }

    /// Whether the drives have power within a frame.
    pub(crate) fn has_power(&self, bench: &mut Bench) -> bool {
        let mut chip = bench.line.chip();
        if !self.by_pulses {
            return chip.wires().powered == [true; 2];
        }
        let before = chip.wires().pulses.len();
        chip.run(FRAME).expect("it runs");
        chip.wires().pulses.len() > before
    }

    /// After so many cycles no drive has power, nor gets any.
    #[track_caller]
    pub(crate) fn is_off_after(&self, bench: &mut Bench, cycles: u64) {
        let mut chip = bench.line.chip();
        chip.run(cycles).expect("it runs");
        let pulses = chip.wires().pulses.len();
        chip.run(FRAME).expect("it runs");
        assert_eq!(chip.wires().pulses.len(), pulses, "pulses go on");
        assert!(self.by_pulses || chip.wires().powered == [false; 2]);
    }

    /// The chip has started again, and says why.
    #[track_caller]
    pub(crate) fn has_restarted(bench: &mut Bench, reset: Reset, fault: Fault) {
        assert_eq!(bench.line.chip().resets, 1);
        assert_eq!(bench.connect_again().reset, reset);
        assert_eq!(bench.status().fault, Some(fault));
    }

    /// The address of a function.
    pub(crate) fn symbol(&self, name: &str) -> u32 {
        let image = Image::read(&crate::bench::path(self.image)).expect("an image");
        image.symbol(name).expect("one function of this name")
    }
}

/// So many cycles pass for a host that is not silent.
pub(crate) fn pass(bench: &mut Bench, cycles: u64) {
    for _ in 0..cycles.div_ceil(HZ / 50) {
        bench.line.chip().run(HZ / 50).expect("it runs");
        bench.status();
    }
}

/// Moves the joints by these angles [rad] at this speed [rad/s].
pub(crate) fn go(bench: &mut Bench, by: [f32; 2], speed: f32) {
    let from = bench.settings.axes.each_ref().map(|axis| axis.home_angle);
    let to = [from[0] + by[0], from[1] + by[1]];
    let kind = MoveKind::Joint { to, speed };
    let next = Move {
        tag: 1,
        tool: 0,
        kind,
    };
    let reply = bench.client.call(HostCommand::Move(next));
    assert!(matches!(reply, Ok(Reply::Taken { .. })), "{reply:?}");
}
