//! Angle limits and a home for an arm whose user states none. The limits are a box of angles in which the arm is nowhere behind
//! its base, where its motors and its table are, as far as it keeps to its working mode and off singularities.

use super::Robot;
use super::draft::tidy;
use fivebar_kinematics::five_bar::{Pose, Side, Tool, WorkingMode};
use std::f64::consts::{FRAC_PI_6, PI};

/// By how much a side of the box grows at once [rad].
const STEP: f64 = 0.05;
/// A crank points so far behind the base at most [rad].
const BEHIND: f64 = FRAC_PI_6;
/// The least room on each side of home [rad]: an arm is homed from some way before its switches.
const LEAST: f64 = 0.2;
/// Home is so far from the outer end of the angles, as a share of them. There the cranks point outwards, and the arm has room
/// to turn inwards before its legs are straight: motors are tried away from their switches.
const HOME: f64 = 0.27;

/// Least and greatest θ1 and θ4, and both at home [rad].
pub(super) struct Proposal {
    pub(super) limits: [[f64; 2]; 2],
    pub(super) home: [f64; 2],
}

/// Where a pose of the grid has C.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// In front of the base.
    Front,
    /// Behind it.
    Behind,
    /// There is no pose, or motions keep off it.
    Nowhere,
}

/// The grid of poses that motions take, about the arm's home without limits.
struct Poses {
    tool: Tool<f64>,
    mode: WorkingMode,
    assembly: Side,
    margin: f64,
    /// θ1, θ4 in the middle [rad].
    middle: [f64; 2],
    /// The least and the greatest cell of each joint.
    most: [[i32; 2]; 2],
    /// Of all cells within them, those of joint 4 one after another.
    places: Vec<Place>,
}

/// The cells of a box that motions from the middle have tried, and how many of them an arm can take.
#[derive(Clone)]
struct Reached {
    is_seen: Vec<bool>,
    count: usize,
}

/// Joint, end and direction of a side of the box that can still grow.
type Growth = (usize, usize, i32);

fn within(cell: i32, [least, greatest]: [i32; 2]) -> bool {
    least <= cell && cell <= greatest
}

impl Poses {
    fn new(robot: &Robot) -> Option<Self> {
        let pose = robot.home_pose().ok()?;
        let middle = robot.home;
        let mut poses = Self {
            tool: robot.tool_on_link().ok()?,
            mode: pose.working_mode(),
            assembly: pose.assembly(),
            margin: robot.limits.singularity_margin,
            middle,
            // `as` cuts: within the ends.
            most: middle
                .map(|angle| [-BEHIND, PI + BEHIND].map(|end| ((end - angle) / STEP) as i32)),
            places: Vec::new(),
        };
        let [[least1, greatest1], [least4, greatest4]] = poses.most;
        poses.places = (least1..=greatest1)
            .flat_map(|one| (least4..=greatest4).map(move |four| [one, four]))
            .map(|cell| match poses.at(poses.angles(cell)) {
                Some(pose) if pose.c.y > 0.0 => Place::Front,
                Some(_) => Place::Behind,
                None => Place::Nowhere,
            })
            .collect();
        Some(poses)
    }

    fn at(&self, [theta1, theta4]: [f64; 2]) -> Option<Pose<f64>> {
        let pose = self.tool.geometry().forward(theta1, theta4, self.assembly);
        pose.ok().filter(|pose| {
            let (_, distance) = self.tool.nearest_singularity(pose);
            pose.working_mode() == self.mode && distance >= self.margin
        })
    }

    fn angles(&self, cell: [i32; 2]) -> [f64; 2] {
        [0, 1].map(|joint| self.middle[joint] + STEP * f64::from(cell[joint]))
    }

    fn index(&self, [one, four]: [i32; 2]) -> usize {
        let [[least1, _], [least4, greatest4]] = self.most;
        ((one - least1) * (greatest4 - least4 + 1) + (four - least4)) as usize
    }

    /// What motions reach within a box if they have reached these cells and go on to those that wait; none if one of them is
    /// behind the base.
    fn reached(
        &self,
        ends: [[i32; 2]; 2],
        from: &Reached,
        mut waiting: Vec<[i32; 2]>,
    ) -> Option<Reached> {
        let mut reached = from.clone();
        while let Some(cell) = waiting.pop() {
            let is_in = within(cell[0], ends[0]) && within(cell[1], ends[1]);
            if !is_in || std::mem::replace(&mut reached.is_seen[self.index(cell)], true) {
                continue;
            }
            match self.places[self.index(cell)] {
                Place::Nowhere => continue,
                Place::Behind => return None,
                Place::Front => reached.count += 1,
            }
            let [one, four] = cell;
            waiting.extend([
                [one - 1, four],
                [one + 1, four],
                [one, four - 1],
                [one, four + 1],
            ]);
        }
        Some(reached)
    }

    /// The cells just outside a box, beyond one end of a joint, which have a reached one beside them.
    fn beside(
        &self,
        ends: [[i32; 2]; 2],
        reached: &Reached,
        (joint, end, step): Growth,
    ) -> Vec<[i32; 2]> {
        let other = 1 - joint;
        let cells = (ends[other][0]..=ends[other][1]).map(|along| {
            let mut cell = [along; 2];
            cell[joint] = ends[joint][end];
            cell
        });
        let cells = cells.filter(|cell| {
            let index = self.index(*cell);
            reached.is_seen[index] && self.places[index] == Place::Front
        });
        let outwards = cells.map(|mut cell| {
            cell[joint] += step;
            cell
        });
        outwards.collect()
    }

    /// The ends of the greatest box about the middle whose sides have grown in turn, so that no joint takes the room of the
    /// other one. A side stops where motions would lead behind the base, or nowhere new.
    fn ends(&self) -> Option<[[i32; 2]; 2]> {
        let mut ends = [[0, 0]; 2];
        if !self.most.iter().all(|most| within(0, *most)) {
            return None;
        }
        let none = Reached {
            is_seen: vec![false; self.places.len()],
            count: 0,
        };
        let mut reached = self.reached(ends, &none, vec![[0, 0]])?;
        let mut sides: Vec<Growth> = vec![(0, 0, -1), (0, 1, 1), (1, 0, -1), (1, 1, 1)];
        while !sides.is_empty() {
            sides.retain(|&side| {
                let (joint, end, step) = side;
                let mut wider = ends;
                wider[joint][end] += step;
                let more = within(wider[joint][end], self.most[joint])
                    .then(|| self.reached(wider, &reached, self.beside(ends, &reached, side)))
                    .flatten()
                    .filter(|more| more.count > reached.count);
                let Some(more) = more else { return false };
                (ends, reached) = (wider, more);
                true
            });
        }
        Some(ends)
    }
}

/// The proposal for an arm; none without a home pose, or with hardly any room about it.
pub(super) fn proposed(robot: &Robot) -> Option<Proposal> {
    let poses = Poses::new(robot)?;
    let ends = poses.ends()?;
    let [least, greatest] = [0, 1].map(|end| poses.angles([ends[0][end], ends[1][end]]));
    let limits = [0, 1].map(|joint| [tidy(least[joint]), tidy(greatest[joint])]);
    let share = |[least, greatest]: [f64; 2], part: f64| tidy(least + part * (greatest - least));
    let outwards = [share(limits[0], 1.0 - HOME), share(limits[1], HOME)];
    let home = match poses.at(outwards) {
        Some(_) => outwards,
        None => robot.home,
    };
    let has_room = (limits.iter().zip(home))
        .all(|([least, greatest], home)| home - least >= LEAST && greatest - home >= LEAST);
    has_room.then_some(Proposal { limits, home })
}
