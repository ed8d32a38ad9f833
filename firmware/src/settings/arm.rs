//! The arm that the settings describe.

use super::{Settings, SettingsError};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Pose, Side, Tool, WorkingMode};
use nalgebra::Vector2;

/// Poses checked across the range of each joint.
const GRID: u8 = 9;

fn side(left: bool) -> Side {
    if left { Side::Left } else { Side::Right }
}

impl Settings {
    /// Geometry and inertia, the rotors seen through their gears.
    ///
    /// # Errors
    /// Lengths or inertias that are not an arm's.
    pub(super) fn arm(&self) -> Result<Arm<f32>, SettingsError> {
        let geometry = Geometry::new(self.lengths).map_err(SettingsError::Geometry)?;
        let links = self.links.map(|link| Link {
            mass: link.mass,
            com: vec2(link.com),
            inertia: link.inertia,
        });
        let rotors = self
            .axes
            .map(|axis| axis.gear_ratio * axis.gear_ratio * axis.rotor_inertia);
        Arm::new(geometry, links, self.payload, vec2(self.gravity), rotors)
            .map_err(SettingsError::Inertia)
    }

    /// The arm with its tool.
    ///
    /// # Errors
    /// A tool offset that leaves link 2 no length.
    pub(super) fn tool(&self, arm: &Arm<f32>) -> Result<Tool<f32>, SettingsError> {
        Tool::new(*arm.geometry(), vec2(self.tool_offset)).map_err(SettingsError::Geometry)
    }

    /// The branch of the tool's inverse solution, in which the arm is homed.
    pub fn working_mode(&self) -> WorkingMode {
        let [elbow1, elbow4] = self.elbows_left.map(side);
        WorkingMode::new(elbow1, elbow4)
    }

    /// The branch of the forward solution.
    pub fn assembly(&self) -> Side {
        side(self.assembly_left)
    }

    /// The torque of each joint at its motor's peak current [N·m].
    pub fn peak_torque(&self) -> [f32; 2] {
        self.axes
            .map(|axis| Scalar::abs(axis.gear_ratio) * axis.torque_constant * axis.peak_current)
    }

    /// The joints' torques at the motors' continuous currents [N·m].
    pub fn continuous_torque(&self) -> [f32; 2] {
        self.axes.map(|axis| {
            Scalar::abs(axis.gear_ratio) * axis.torque_constant * axis.continuous_current
        })
    }

    /// Whether a pose is on the branch and keeps the margin from singularities.
    fn keeps_margin(&self, tool: &Tool<f32>, pose: &Pose<f32>) -> bool {
        tool.working_mode(pose) == self.working_mode()
            && tool.nearest_singularity(pose).1 >= self.motion.singularity_margin
    }

    /// The inertia [kg·m²] of each joint with the other joint at rest, averaged over the poses
    /// that the arm can take: the constant of independent-joint control.
    ///
    /// # Errors
    /// `NoPose` if the arm can take no pose.
    pub(super) fn nominal_inertia(
        &self,
        arm: &Arm<f32>,
        tool: &Tool<f32>,
    ) -> Result<[f32; 2], SettingsError> {
        let [range1, range4] = self.axes.map(|axis| axis.angle_limits);
        let at = |[low, high]: [f32; 2], step: u8| {
            low + (high - low) * (f32::from(step) / f32::from(GRID - 1))
        };
        let mut sum = [0.0; 2];
        let mut poses = 0.0;
        for i in 0..GRID {
            for j in 0..GRID {
                let pose = arm
                    .geometry()
                    .forward(at(range1, i), at(range4, j), self.assembly());
                let Ok(pose) = pose else { continue };
                if !self.keeps_margin(tool, &pose) {
                    continue;
                }
                if let Ok(matrix) = arm.mass_matrix(&pose) {
                    let [sum1, sum4] = sum;
                    sum = [sum1 + matrix.m11, sum4 + matrix.m22];
                    poses += 1.0;
                }
            }
        }
        let [sum1, sum4] = sum;
        let average = [sum1 / poses, sum4 / poses];
        if poses > 0.0
            && average
                .iter()
                .all(|&inertia| inertia > 0.0 && inertia.is_finite())
        {
            Ok(average)
        } else {
            Err(SettingsError::NoPose)
        }
    }
}

fn vec2([x, y]: [f32; 2]) -> Vector2<f32> {
    Vector2::new(x, y)
}
