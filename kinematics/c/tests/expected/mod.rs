//! Cases for `bits.c`, and what it prints if the library computes what `fivebar-kinematics` does.

use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::{
    Geometry, GeometryError, Jacobian, Pose, PoseError, Side, Singularity, Tool, Unreachable,
    Velocities, WorkingMode,
};
use fivebar_kinematics::nalgebra::Vector2;
use oorandom::Rand64;

/// A number that C has too.
pub(crate) trait Real: Scalar {
    /// What the C compiler is given for it.
    const FLAG: &str;

    fn hexadecimal(self) -> String;
}

impl Real for f32 {
    const FLAG: &str = "-DSINGLE";

    fn hexadecimal(self) -> String {
        format!("{:x}", self.to_bits())
    }
}

impl Real for f64 {
    const FLAG: &str = "-DDOUBLE";

    fn hexadecimal(self) -> String {
        format!("{:x}", self.to_bits())
    }
}

/// What a program gives to the functions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case<R> {
    /// l1 to l4 and the base [m].
    lengths: [R; 5],
    /// Angles [rad].
    angle: [R; 2],
    /// Of C, of the foot and of the tool [m].
    point: [R; 2],
    /// [m/s].
    velocity: [R; 2],
    /// [N].
    force: [R; 2],
    /// [rad/s].
    rate: [R; 2],
    /// Of the tool, along link 2 and to its left [m].
    offset: [R; 2],
    assembly: Side,
    mode: WorkingMode,
}

impl<R: Real> Case<R> {
    /// As a line of the program's input.
    pub(crate) fn line(&self) -> String {
        let pairs = [
            self.angle,
            self.point,
            self.velocity,
            self.force,
            self.rate,
            self.offset,
        ];
        let numbers = [&self.lengths[..], &pairs.concat()].concat();
        let numbers: Vec<String> = numbers.into_iter().map(R::hexadecimal).collect();
        let sides = sides(&[self.assembly, self.mode.elbow1, self.mode.elbow4]);
        format!("{}{sides}", numbers.join(" "))
    }
}

/// Arms, poses, motions and forces: random ones, coaxial ones, impossible ones and those at singularities.
pub(crate) fn cases<R: Real>() -> Vec<Case<R>> {
    let mut random = Rand64::new(20);
    let mut cases = Vec::new();
    for index in 0..800 {
        cases.push(case(&mut random, index));
    }
    cases
}

fn case<R: Real>(random: &mut Rand64, index: usize) -> Case<R> {
    let mut between = |low: f64, high: f64| low + (high - low) * random.rand_float();
    let mut lengths = [(); 5].map(|()| between(0.05, 0.2));
    // Coaxial motors, and legs that are alike.
    if index.is_multiple_of(3) {
        lengths[4] = 0.0;
    }
    if index.is_multiple_of(2) {
        (lengths[3], lengths[2]) = (lengths[0], lengths[1]);
    }
    let mut angle = [between(-3.2, 3.2), between(-3.2, 3.2)];
    let mut point = [between(-0.3, 0.35), between(-0.35, 0.35)];
    let mut offset = [between(-0.03, 0.05), between(-0.03, 0.03)];
    let [l1, l2, l3, l4, base] = lengths;
    let direction = between(-3.2, 3.2);
    let towards =
        |pivot: f64, reach: f64| [pivot + reach * direction.cos(), reach * direction.sin()];
    // From a hundredth of the reach inside to as little outside, most of them close to it.
    let near = 1.0 + between(-1.0, 1.0) * 10.0_f64.powf(between(-17.0, -2.0));
    let not_finite = [f64::NAN, f64::INFINITY][index / 20 % 2];
    match index % 20 {
        0 => lengths[index / 20 % 5] = [0.0, -0.1, f64::NAN, f64::INFINITY][index / 100 % 4],
        1 => lengths[index / 20 % 5] = between(0.6, 2.0),
        2 => point[index / 40 % 2] = not_finite,
        3 => angle[index / 40 % 2] = not_finite,
        4 => offset[index / 40 % 2] = not_finite,
        5 => offset = [-l2, 0.0],
        6 => point = towards(0.0, (l1 + l2) * near),
        7 => point = towards(0.0, (l1 - l2).abs() * near),
        8 => point = towards(base, (l3 + l4) * near),
        9 => point = towards(base, (l3 - l4).abs() * near),
        // B meets D, of equal coaxial cranks.
        10 => {
            lengths[4] = 0.0;
            lengths[3] = l1;
            angle[1] = angle[0] + (near - 1.0);
        }
        11 => point = [0.0, 0.0],
        12 => point = [base, 0.0],
        13 => offset = [0.0, 0.0],
        // A forward solution gives most points that both legs reach.
        _ => {
            let geometry = Geometry::new(lengths).ok();
            if let Some(Ok(pose)) = geometry.map(|it| it.forward(angle[0], angle[1], Side::Left)) {
                point = pose.c.into();
            }
        }
    }
    let [velocity, rate] = [(); 2].map(|()| [(); 2].map(|()| between(-2.0, 2.0)));
    let force = [between(-30.0, 30.0), between(-30.0, 30.0)];
    let mut side = || {
        if between(0.0, 1.0) < 0.5 {
            Side::Left
        } else {
            Side::Right
        }
    };
    Case {
        lengths: lengths.map(R::from_f64),
        angle: angle.map(R::from_f64),
        point: point.map(R::from_f64),
        velocity: velocity.map(R::from_f64),
        force: force.map(R::from_f64),
        rate: rate.map(R::from_f64),
        offset: offset.map(R::from_f64),
        assembly: side(),
        mode: WorkingMode::new(side(), side()),
    }
}

/// The lines that the program prints for a case.
pub(crate) fn expected<R: Real>(case: &Case<R>) -> Vec<String> {
    let mut lines = Lines(Vec::new());
    let [point, velocity, force] = [case.point, case.velocity, case.force].map(Vector2::from);
    let [angle1, angle4] = case.angle;
    let [rate1, rate4] = case.rate;

    let arm = Geometry::new(case.lengths);
    let Some(arm) = lines.put("geometry", arm.map_err(refused_arm), |_| Vec::<R>::new()) else {
        return lines.0;
    };
    let reached = arm.forward(angle1, angle4, case.assembly);
    if let Some(pose) = lines.put("forward", reached.map_err(refused), pose_numbers) {
        lines.branches(&pose);
        let velocities = arm.forward_velocities(&pose, rate1, rate4);
        lines.put(
            "forward_velocities",
            velocities.map_err(refused),
            velocity_numbers,
        );
        lines.jacobian("jacobian", arm.jacobian(&pose), Some(force));
    }
    let held = arm.inverse(point, case.mode);
    if let Some(pose) = lines.put("inverse", held.map_err(refused), pose_numbers) {
        lines.branches(&pose);
        let velocities = arm.inverse_velocities(&pose, velocity);
        lines.put(
            "inverse_velocities",
            velocities.map_err(refused),
            velocity_numbers,
        );
        lines.jacobian("jacobian", arm.jacobian(&pose), None);
    }
    let drive = arm.drive_foot(point, velocity, force, case.mode);
    lines.put("drive_foot", drive.map_err(refused), |drive| {
        [drive.angle, drive.rate, drive.torque].concat()
    });

    let pen = Tool::new(arm, Vector2::from(case.offset));
    let Some(pen) = lines.put("tool", pen.map_err(refused_arm), |_| Vec::<R>::new()) else {
        return lines.0;
    };
    let drawing = pen.inverse(point, case.mode);
    if let Some(pose) = lines.put("tool_inverse", drawing.map_err(refused), pose_numbers) {
        lines.put("tool_point", Ok(pen.point(&pose)), vector_numbers);
        let velocities = pen.inverse_velocities(&pose, velocity).map_err(refused);
        if let Some(velocities) = lines.put("tool_inverse_velocities", velocities, velocity_numbers)
        {
            lines.put(
                "tool_velocity",
                Ok(pen.velocity(&pose, &velocities)),
                vector_numbers,
            );
        }
        lines.jacobian("tool_jacobian", pen.jacobian(&pose), Some(force));
    }
    lines.0
}

struct Lines(Vec<String>);

impl Lines {
    /// Adds the line of a call: its status and its result's bits. Returns the result.
    fn put<R: Real, T>(
        &mut self,
        name: &str,
        result: Result<T, i32>,
        numbers: impl Fn(&T) -> Vec<R>,
    ) -> Option<T> {
        match result {
            Ok(result) => {
                let words: String = numbers(&result)
                    .into_iter()
                    .map(|number| format!(" {}", number.hexadecimal()))
                    .collect();
                self.0.push(format!("{name} 0{words}"));
                Some(result)
            }
            Err(status) => {
                self.0.push(format!("{name} {status}"));
                None
            }
        }
    }

    fn branches<R: Real>(&mut self, pose: &Pose<R>) {
        let [theta1, _, _, theta4] = pose.angles();
        self.put("angles", Ok(()), |()| vec![theta1, theta4]);
        let WorkingMode { elbow1, elbow4 } = pose.working_mode();
        self.0
            .push(format!("assembly 0{}", sides(&[pose.assembly()])));
        self.0
            .push(format!("working_mode 0{}", sides(&[elbow1, elbow4])));
    }

    /// A Jacobian, and the torques that hold against a force [N].
    fn jacobian<R: Real>(
        &mut self,
        name: &str,
        jacobian: Result<Jacobian<R>, PoseError>,
        force: Option<Vector2<R>>,
    ) {
        let columns = |it: &Jacobian<R>| [vector_numbers(&it.c1), vector_numbers(&it.c4)].concat();
        let jacobian = self.put(name, jacobian.map_err(refused), columns);
        if let (Some(jacobian), Some(force)) = (jacobian, force) {
            let torque = jacobian.torques(force).map(|torque| -torque);
            self.put("hold_torque", Ok(torque), |torque| torque.to_vec());
        }
    }
}

fn vector_numbers<R: Real>(vector: &Vector2<R>) -> Vec<R> {
    vec![vector.x, vector.y]
}

fn pose_numbers<R: Real>(pose: &Pose<R>) -> Vec<R> {
    let vectors = [pose.u1, pose.u2, pose.u3, pose.u4, pose.b, pose.c, pose.d];
    vectors.iter().flat_map(vector_numbers).collect()
}

fn velocity_numbers<R: Real>(velocities: &Velocities<R>) -> Vec<R> {
    [&velocities.omega[..], &vector_numbers(&velocities.c)].concat()
}

/// The header's numbers of sides, each after a space.
fn sides(sides: &[Side]) -> String {
    let numbers = sides.iter().map(|side| match side {
        Side::Left => " 0",
        Side::Right => " 1",
    });
    numbers.collect()
}

/// The header's number of a refused arm or tool.
fn refused_arm(error: GeometryError) -> i32 {
    match error {
        GeometryError::NotPositive(index) => 10 + i32::try_from(index).unwrap(),
        GeometryError::CannotAssemble => 15,
        GeometryError::ToolOffset => 16,
        other => panic!("the header has no status for {other:?}"),
    }
}

/// The header's number of a refused pose.
fn refused(error: PoseError) -> i32 {
    match error {
        PoseError::NotFinite => 3,
        PoseError::Unreachable(Unreachable::Leg1TooFar) => 20,
        PoseError::Unreachable(Unreachable::Leg1TooNear) => 21,
        PoseError::Unreachable(Unreachable::Leg4TooFar) => 22,
        PoseError::Unreachable(Unreachable::Leg4TooNear) => 23,
        PoseError::Unreachable(Unreachable::ElbowsTooFar) => 24,
        PoseError::Unreachable(Unreachable::ElbowsTooNear) => 25,
        PoseError::Singular(Singularity::Leg1) => 30,
        PoseError::Singular(Singularity::Leg4) => 31,
        PoseError::Singular(Singularity::Parallel) => 32,
    }
}
