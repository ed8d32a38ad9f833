//! The controller explored: from power-up every event in every state, breadth first, until no new
//! state appears. The code is that of the firmware: controller, planner and session. A state is what
//! can be seen of it from outside (`view`); angles and times are left out.
//!
//! In every tick the [`rules`](crate::rules) hold, and those of `history`. From every state three
//! things are tried: an arm comes to rest by a stop, and for a silent host; and there is a way out.

mod arm;
mod event;
mod history;
mod kind;
mod view;
mod world;

use crate::rules::Violation;
use crate::way_out::{WayOut, way_out};
use event::{Event, alphabet, planned_run};
use fivebar_firmware::TimedMove;
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::{BrushedDrives, StepDrives};
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::{Fault, State};
use kind::ExploredDrives;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::collections::HashSet;
use std::fmt;
use view::View;
use world::World;

/// Longest time in which a stop brings an arm to rest, and a silent host does [ticks].
const REST: u32 = 1_200;
/// Ticks after which an arm without a host has no power.
const ABANDONED: u32 = 121_000;

/// What an exploration has found.
#[derive(Clone, Debug, Default)]
pub struct Exploration {
    /// Abstract states.
    pub states: usize,
    /// Events that were tried in them.
    pub edges: usize,
    /// Ticks.
    pub ticks: u64,
    /// The controller's states that were reached.
    pub reached: HashSet<State>,
    /// The faults that were latched.
    pub faults: HashSet<Fault>,
    /// Those that a tick found by itself.
    pub detected: HashSet<Fault>,
    /// States from which the arm moves again, and those with a named reason why it cannot.
    pub ways_out: [usize; 2],
}

/// A rule that was broken, and how.
#[derive(Clone, Debug)]
pub struct Counterexample {
    violation: Violation,
    /// The events from power-up on, each after its number of ticks.
    events: Vec<String>,
}

impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.violation)?;
        for event in &self.events {
            writeln!(f, "  {event}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Counterexample {}

/// States that are expanded side by side. What they reach is noted in their order, so the result does not depend on
/// the number of threads.
const SIDE_BY_SIDE: usize = 16;

/// A state with the world that reached it first.
struct Node<D: ExploredDrives> {
    world: World<D>,
    /// The state before, and the event that led here.
    came: Option<(usize, Event)>,
    /// The first one with power in which the controller has this state and fault: its host leaves it for long.
    is_abandoned: bool,
}

/// What an event does in a state.
struct Tried<D: ExploredDrives> {
    event: Event,
    /// The worlds of new states on the way and at the end.
    worlds: Vec<World<D>>,
    /// The fault that a tick found by itself.
    detected: Option<Fault>,
    ticks: u32,
    happened: Result<(), Violation>,
}

struct Search<D: ExploredDrives> {
    nodes: Vec<Node<D>>,
    known: HashSet<View>,
    found: Exploration,
    /// States of the controller in which the host has been absent for long.
    abandoned: HashSet<(State, Option<Fault>)>,
    run: Vec<TimedMove>,
}

/// Explores the states of the controller of brushed motors, breadth first: all, or the events of so many of them.
///
/// # Errors
/// The first rule that is broken, with the events that lead there.
pub fn explore(most: usize) -> Result<Exploration, Counterexample> {
    search::<BrushedDrives>(most)
}

/// Explores likewise the controller of steppers without encoders, which without power do not know the arm's place.
///
/// # Errors
/// As [`explore`].
pub fn explore_open_loop(most: usize) -> Result<Exploration, Counterexample> {
    search::<StepDrives>(most)
}

fn search<D: ExploredDrives>(most: usize) -> Result<Exploration, Counterexample> {
    let at_start = |violation| Counterexample {
        violation,
        events: Vec::new(),
    };
    let mut search = Search::<D> {
        nodes: Vec::new(),
        known: HashSet::new(),
        found: Exploration::default(),
        abandoned: HashSet::new(),
        run: Vec::new(),
    };
    for has_settings in [true, false] {
        let world = World::new(has_settings).map_err(at_start)?;
        search.run = planned_run(&world);
        search.visit(world, None);
    }
    let alphabet = alphabet::<D>();
    let mut next = 0;
    while next < search.nodes.len().min(most) {
        let end = search.nodes.len().min(next + SIDE_BY_SIDE);
        let expanded: Vec<_> = (next..end)
            .into_par_iter()
            .map(|index| (search.check(index), search.expand(index, &alphabet)))
            .collect();
        for (index, (outcome, tried)) in (next..).zip(expanded) {
            search.note(index, outcome, tried)?;
        }
        next = end;
    }
    search.found.states = search.nodes.len();
    Ok(search.found)
}

impl<D: ExploredDrives> Search<D> {
    /// Notes a world if its state is new.
    fn visit(&mut self, world: World<D>, came: Option<(usize, Event)>) {
        let view = world.view();
        if self.known.insert(view) {
            self.found.reached.insert(view.state);
            self.found.faults.extend(view.fault);
            let is_abandoned = view.has_power() && self.abandoned.insert((view.state, view.fault));
            self.nodes.push(Node {
                world,
                came,
                is_abandoned,
            });
        }
    }

    /// Notes what was found in a state.
    fn note(
        &mut self,
        index: usize,
        outcome: Result<WayOut, Violation>,
        tried: Vec<Tried<D>>,
    ) -> Result<(), Counterexample> {
        match outcome {
            Ok(WayOut::Motion) => self.found.ways_out[0] += 1,
            Ok(_) => self.found.ways_out[1] += 1,
            Err(violation) => return Err(self.counterexample(index, None, violation)),
        }
        for Tried {
            event,
            worlds,
            detected,
            ticks,
            happened,
        } in tried
        {
            self.found.detected.extend(detected);
            for world in worlds {
                self.visit(world, Some((index, event)));
            }
            self.found.edges += 1;
            self.found.ticks += u64::from(ticks);
            happened.map_err(|violation| self.counterexample(index, Some(event), violation))?;
        }
        Ok(())
    }

    /// Tries every event in a state.
    fn expand(&self, index: usize, alphabet: &[Event]) -> Vec<Tried<D>> {
        let node = &self.nodes[index].world;
        let fault = node.view().fault;
        let try_one = |&event: &Event| {
            let mut world = node.clone();
            let mut last = world.view();
            let (mut worlds, mut detected) = (Vec::new(), None);
            let happened = world.happen(event, &self.run, &mut |world: &World<D>| {
                let view = world.view();
                if last.fault.is_none() {
                    detected = detected.or(view.fault);
                }
                if view != last && !self.known.contains(&view) {
                    worlds.push(world.clone());
                }
                last = view;
            });
            let ticks = world.ticks() - node.ticks();
            if !self.known.contains(&world.view()) {
                worlds.push(world);
            }
            Tried {
                event,
                worlds,
                detected,
                ticks,
                happened,
            }
        };
        let events = alphabet.iter();
        events
            .filter(|event| event.is_tried_under(fault))
            .map(try_one)
            .collect()
    }

    /// What must be possible from every state, without disturbance: the way out.
    fn check(&self, index: usize) -> Result<WayOut, Violation> {
        let Node {
            world,
            is_abandoned,
            ..
        } = &self.nodes[index];
        stops(world.clone())?;
        rests_for_silent_host(world.clone())?;
        if *is_abandoned {
            is_switched_off(world.clone())?;
        }
        let mut undisturbed = world.clone();
        undisturbed.disturb(None);
        // Counts that go on may have jumped.
        undisturbed.tick(true, &mut |_| ())?;
        match way_out(&mut undisturbed)? {
            WayOut::Fault(fault) => Err(Violation::new(
                undisturbed.ticks(),
                "a sound arm raises no fault on its way out",
                format_args!("{fault:?}"),
            )),
            named => Ok(named),
        }
    }

    fn counterexample(
        &self,
        mut index: usize,
        last: Option<Event>,
        violation: Violation,
    ) -> Counterexample {
        let mut events: Vec<String> = last.iter().map(|event| format!("{event:?}")).collect();
        while let Some((before, event)) = self.nodes[index].came {
            let Node { world, .. } = &self.nodes[index];
            events.push(format!(
                "{event:?}, to tick {}: {:?}",
                world.ticks(),
                world.view()
            ));
            index = before;
        }
        events.reverse();
        Counterexample { violation, events }
    }
}

/// A stop brings an arm to rest; a crossing ends first.
fn stops<D: ExploredDrives>(mut world: World<D>) -> Result<(), Violation> {
    world.disturb(None);
    world.command(HostCommand::Request(Request::Stop))?;
    let rule = "a stop brings the arm to rest";
    comes_to_rest(&mut world, true, rule)
}

/// An arm whose host is silent comes to rest.
fn rests_for_silent_host<D: ExploredDrives>(mut world: World<D>) -> Result<(), Violation> {
    comes_to_rest(&mut world, false, "the arm rests for a silent host")
}

fn comes_to_rest<D: ExploredDrives>(
    world: &mut World<D>,
    polls: bool,
    rule: &'static str,
) -> Result<(), Violation> {
    for _ in 0..REST {
        world.tick(polls, &mut |_| ())?;
        let view = world.view();
        if !view.is_moving() {
            return Ok(());
        }
    }
    let found = format_args!("it moves after {REST} ticks: {:?}", world.view());
    Err(Violation::new(world.ticks(), rule, found))
}

/// An arm that is left alone for a minute has no power.
fn is_switched_off<D: ExploredDrives>(mut world: World<D>) -> Result<(), Violation> {
    for _ in 0..ABANDONED {
        world.tick(false, &mut |_| ())?;
    }
    if !world.view().has_power() {
        return Ok(());
    }
    let rule = "an arm without a host has no power after a minute";
    Err(Violation::new(
        world.ticks(),
        rule,
        format_args!("{:?}", world.view()),
    ))
}
