//! The simulated arm on the chip's pins: bridges, encoders, sensors, switches, buttons.

use crate::amplifier::{BRIDGE_DELAYS, ringing};
use crate::hold::Hold;
use crate::peripherals::adc::SampleWindow;
use crate::peripherals::gpio::Pin;
use crate::peripherals::pwm_timer::Pulses;
use crate::peripherals::tim1::Output;
use crate::time::{MICROSECOND, NEVER, SECOND, Time};
use crate::wiring::{Edges, Outputs, Wiring};
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_kinematics::five_bar::{Geometry, Joint, Side};
use fivebar_plant::{FaultKind, Hands, Plant, State};
use nalgebra::Vector2;
use std::cell::{RefCell, RefMut};
use std::rc::Rc;

const STOP: Pin = Pin(1, 12);
const HOME: [Pin; 2] = [Pin(2, 4), Pin(2, 5)];
const INDEX: [Pin; 2] = [Pin(2, 8), Pin(2, 9)];
const BRIDGE_FAULT: [Pin; 2] = [Pin(1, 0), Pin(1, 1)];
const ENCODER: [[Pin; 2]; 2] = [[Pin(0, 0), Pin(0, 1)], [Pin(0, 15), Pin(1, 3)]];
/// The serial line's input idles high.
const SERIAL_IN: Pin = Pin(1, 7);
/// Inputs of the converters: PC0, PC1, PC2.
const CURRENT: [u8; 2] = [10, 11];
const BUS: u8 = 12;
/// Samples are no older than this.
const FRESH: Time = 20 * MICROSECOND;
/// What one tick of the program saw, and what the timer did meanwhile.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// The samples of this tick.
    pub sample: SensorSample,
    /// The duties that the compare registers gave up to this tick, in counts of half a period:
    /// those of the tick before the last one, for they are preloaded.
    pub duty: [i32; 2],
    /// Whether both bridges were enabled up to this tick.
    pub enabled: bool,
}

/// The arm and its electronics.
pub struct Arm {
    plant: Plant,
    outputs: Outputs,
    /// What the bridges do now.
    acting: ActuatorCommand,
    at: Time,
    sample: SensorSample,
    sampled_at: Time,
    /// Time that a bridge needs to wake, during which its fault output is low.
    wake: Time,
    awake_at: [Time; 2],
    /// Time from an edge at a bridge's input to that at its output.
    pub bridge_delay: Time,
    stop_pressed: bool,
    broken: Vec<Pin>,
    /// The encoders' counts as both lines of each gave them.
    counts: [i32; 2],
    /// The hand that holds the arm, if one does.
    hand: Option<Hold>,
    /// How long the next disturbance of an encoder's inputs lasts, and counts that
    /// disturbances have added.
    glitch: [Time; 2],
    added: [i32; 2],
    /// Contacts of the home switches that chatter: they read as pressed once.
    chatter: [bool; 2],
    /// Samples that an edge of their bridge's output changed by a code or more.
    pub samples_on_edges: u64,
    /// The last windows in which current 1, current 4 and the bus were sampled.
    pub windows: [Option<SampleWindow>; 3],
    /// Every tick so far.
    pub ticks: Vec<Tick>,
    /// Changes of what the bridges do, with their times.
    pub history: Vec<(Time, ActuatorCommand)>,
    /// Changes of what the tool gets, with their times.
    pub tool: Vec<(Time, Pulses)>,
}

impl Arm {
    /// An arm at rest. `wake` is the time that a bridge needs to wake.
    pub fn new(mut plant: Plant, wake: Time) -> Self {
        let acting = ActuatorCommand {
            brake: true,
            ..ActuatorCommand::default()
        };
        let sample = plant.sense();
        Self {
            plant,
            outputs: Outputs::RELEASED,
            acting,
            at: 0,
            sample,
            sampled_at: 0,
            wake,
            awake_at: [NEVER; 2],
            bridge_delay: BRIDGE_DELAYS[0],
            stop_pressed: false,
            broken: Vec::new(),
            counts: sample.counts,
            hand: None,
            glitch: [0; 2],
            added: [0; 2],
            chatter: [false; 2],
            samples_on_edges: 0,
            windows: [None; 3],
            ticks: Vec::new(),
            history: Vec::new(),
            tool: Vec::new(),
        }
    }

    /// Puts the links where the arm cannot go by itself.
    pub fn set_links(&mut self, links: &State) {
        self.plant.set_links(links);
        self.sample = self.plant.sense();
    }

    /// The plant itself.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// What the chip drives.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// What the bridges do now.
    pub fn acting(&self) -> &ActuatorCommand {
        &self.acting
    }

    /// Forgets the ticks and changes so far, of which a long run has too many.
    pub fn forget(&mut self) {
        self.ticks.clear();
        self.history.clear();
        self.tool.clear();
    }

    /// The last samples.
    pub fn sample_now(&self) -> &SensorSample {
        &self.sample
    }

    /// Injects a fault of the arm.
    pub fn inject(&mut self, fault: FaultKind) {
        self.plant.inject(fault);
        self.sample = self.plant.sense();
    }

    /// Presses or releases the emergency stop.
    pub fn press_stop(&mut self, pressed: bool) {
        self.stop_pressed = pressed;
    }

    /// Presses these switches by hand, and no others.
    pub fn press(&mut self, hands: Hands) {
        self.plant.press(hands);
    }

    /// Turns the joints of an arm with these lengths by hand to these angles [rad], and holds them
    /// there.
    pub fn turn_by_hand(&mut self, to: [f64; 2], geometry: Geometry<f64>, assembly: Side) {
        let from = Joint::ALL.map(|joint| self.plant.angle(joint));
        self.hand = Some(Hold {
            from,
            by: [to[0] - from[0], to[1] - from[1]],
            since: self.at,
            geometry,
            assembly,
        });
    }

    /// Pulls the tool with this force [N].
    pub fn pull_tool(&mut self, force: Vector2<f64>) {
        self.plant.set_tool_force(force);
    }

    /// Lets go of the arm.
    pub fn let_go(&mut self) {
        self.hand = None;
    }

    /// Breaks the wire to an input: nothing outside drives the pin but a resistor at the pin.
    pub fn break_wire(&mut self, pin: Pin) {
        self.broken.push(pin);
    }

    fn is_broken(&self, pin: Pin) -> bool {
        self.broken.contains(&pin)
    }

    /// Disturbs an encoder: if a disturbance of this length passes the filter, it counts.
    pub fn disturb_encoder(&mut self, joint: Joint, length: Time) {
        self.glitch[joint] = length;
    }

    /// Counts that disturbances have added to the encoders.
    pub fn added(&self) -> [i32; 2] {
        self.added
    }

    /// Lets a home switch read as pressed at the next sample only.
    pub fn chatter(&mut self, joint: Joint) {
        self.chatter[joint] = true;
    }

    /// Moves the arm on to a time, from which the bridges do `next`.
    fn advance(&mut self, now: Time, next: ActuatorCommand) {
        let passed = now.saturating_sub(self.at) as f64 / SECOND as f64;
        self.at = self.at.max(now);
        match self.hand.as_ref().and_then(|hold| hold.pose(self.at)) {
            Some(pose) => self.plant.hold_by_hand(&pose, passed),
            // The plant applies the command before this one for the time that has passed.
            None => self.plant.step(&next, passed),
        }
        if next != self.acting {
            self.history.push((now, next));
        }
        self.acting = next;
    }

    fn acts(&self, now: Time) -> ActuatorCommand {
        let share = |output: Output| match output {
            // 100 kΩ pull the inputs low.
            Output::Released => 0.0,
            Output::Idle(level) => f32::from(u8::from(level)),
            Output::Pwm { high, period } => high as f32 / period as f32,
        };
        let inputs = self.outputs.pwm.map(share);
        let bridges = [[inputs[0], inputs[1]], [inputs[2], inputs[3]]];
        ActuatorCommand {
            drives: BrushedCommand {
                duty: bridges.map(|[in1, in2]| in1 - in2),
            },
            enable: [0, 1].map(|j| {
                let [in1, in2] = bridges[j];
                self.awake_at[j] <= now && (in1 > 0.0 || in2 > 0.0)
            }),
            brake: self.outputs.brake != Some(true),
            tool: 0,
        }
    }

    fn refresh(&mut self, now: Time) {
        let acts = self.acts(now);
        self.advance(now, acts);
        self.sample = self.plant.sense();
        self.sampled_at = now;
    }

    fn tick(&self) -> Tick {
        let high = self.outputs.pwm.map(|output| match output {
            Output::Pwm { high, .. } => (high / 2) as i32,
            Output::Released | Output::Idle(_) => 0,
        });
        Tick {
            sample: self.sample,
            duty: [high[0] - high[1], high[2] - high[3]],
            enabled: self.outputs.sleep == [Some(true); 2],
        }
    }

    fn is_waking(&self, now: Time, joint: Joint) -> bool {
        self.awake_at[joint] != NEVER && self.awake_at[joint] > now
    }
}

/// The arm as the chip and a test share it.
#[derive(Clone)]
pub struct SharedArm(Rc<RefCell<Arm>>);

impl SharedArm {
    /// Shares an arm.
    pub fn new(arm: Arm) -> Self {
        Self(Rc::new(RefCell::new(arm)))
    }

    /// The arm, while the chip does not run.
    pub fn get(&self) -> RefMut<'_, Arm> {
        self.0.borrow_mut()
    }
}

impl Wiring for SharedArm {
    fn drive(&mut self, now: Time, outputs: &Outputs) {
        let arm = &mut *self.get();
        for joint in Joint::ALL {
            // 100 kΩ keep a bridge asleep whose pin nothing drives.
            let wakes = outputs.sleep[joint] == Some(true);
            if !wakes {
                arm.awake_at[joint] = NEVER;
            } else if arm.awake_at[joint] == NEVER {
                arm.awake_at[joint] = now + arm.wake;
            }
        }
        if arm.outputs.tool != outputs.tool {
            arm.tool.push((now, outputs.tool));
        }
        arm.outputs = *outputs;
        let acts = arm.acts(now);
        arm.advance(now, acts);
    }

    fn level(&mut self, now: Time, pin: Pin) -> Option<bool> {
        let arm = &mut *self.get();
        if now >= arm.sampled_at + 10 * FRESH {
            arm.refresh(now);
        }
        if arm.is_broken(pin) {
            return None;
        }
        if pin == STOP {
            return Some(arm.stop_pressed || arm.sample.emergency_stop);
        }
        for joint in Joint::ALL {
            if pin == HOME[joint] {
                return Some(arm.sample.home[joint] || std::mem::take(&mut arm.chatter[joint]));
            }
            if pin == INDEX[joint] {
                return Some(arm.sample.index[joint]);
            }
            if pin == BRIDGE_FAULT[joint] {
                // An open drain; the pull-up at the bridge is stronger than the chip's resistor.
                return Some(!arm.sample.driver_fault[joint] && !arm.is_waking(now, joint));
            }
        }
        (pin == SERIAL_IN).then_some(true)
    }

    fn encoder(&mut self, now: Time, joint: Joint, filter: Time) -> i32 {
        let arm = &mut *self.get();
        if now >= arm.sampled_at + FRESH {
            arm.refresh(now);
        }
        let disturbed = std::mem::take(&mut arm.glitch[joint]) > filter;
        arm.added[joint] += i32::from(disturbed);
        // One line alone counts a step to and fro.
        if !ENCODER[joint].iter().any(|&pin| arm.is_broken(pin)) {
            arm.counts[joint] = arm.sample.counts[joint];
        }
        arm.counts[joint].wrapping_add(arm.added[joint])
    }

    fn sample(&mut self, window: &SampleWindow, edges: &[Edges; 2]) -> u16 {
        let arm = &mut *self.get();
        if window.from >= arm.sampled_at + FRESH {
            arm.refresh(window.from);
        }
        let place = [CURRENT[0], CURRENT[1], BUS]
            .iter()
            .position(|&channel| channel == window.channel);
        if let Some(place) = place {
            arm.windows[place] = Some(*window);
        }
        if window.channel == BUS {
            let tick = arm.tick();
            arm.ticks.push(tick);
        }
        if arm.is_broken(Pin(2, window.channel.wrapping_sub(10))) {
            // The pull-down at the pin, or the lower resistor of the divider.
            return 0;
        }
        for joint in Joint::ALL {
            if window.channel == CURRENT[joint] {
                let error = match arm.acting.enable[joint] {
                    true => ringing(&edges[joint], arm.bridge_delay),
                    false => 0,
                };
                arm.samples_on_edges += u64::from(error > 0);
                return arm.sample.drives.current[joint] + error;
            }
        }
        if window.channel == BUS {
            arm.sample.drives.bus_voltage
        } else {
            0
        }
    }

    fn due(&self) -> Time {
        // The bridges wake by themselves.
        let arm = self.0.borrow();
        let waking = Joint::ALL
            .into_iter()
            .filter(|&joint| arm.is_waking(arm.at, joint))
            .map(|joint| arm.awake_at[joint]);
        waking.min().unwrap_or(NEVER)
    }

    fn advance(&mut self, now: Time) {
        let arm = &mut *self.get();
        let acts = arm.acts(now);
        arm.advance(now, acts);
    }
}
