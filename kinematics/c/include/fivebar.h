/*
 * Kinematics of the planar five-bar arm: positions, velocities and holding torques, in closed form.
 *
 *            C  where links 2 and 3 meet
 *          /   \
 *     2  /       \  3
 *      /           \
 *    B               D     elbows
 *     \             /
 *    1  \         /  4
 *         A --- E          driven joints: motor 1 at A, motor 4 at E
 *
 * Units are SI. A is the origin, E lies on +x; angles are absolute, counter-clockwise from +x.
 * Functions end in _f32 for float and in _f64 for double. Those for float give the same bits on every
 * processor that computes by IEEE 754 and does not flush small numbers to zero.
 *
 * Each function writes its result through its last pointer and returns FIVEBAR_STATUS_OK, or it writes
 * nothing and returns why. "Refused:" names the reasons without FIVEBAR_STATUS_; NULL_POINTER and NOT_PREPARED
 * can always be one. A pointer is null, or points to a whole, aligned object that the other pointers of the call
 * do not overlap.
 * No function allocates, panics, or has global state: any thread or interrupt may call at any time.
 */

#ifndef FIVEBAR_H
#define FIVEBAR_H

#include <stdint.h>

// Whether a function has written its result; if not, why. A refused call writes nothing.
enum FivebarStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The result is written.
  FIVEBAR_STATUS_OK = 0,
  // A pointer is null.
  FIVEBAR_STATUS_NULL_POINTER = 1,
  // A side is neither FIVEBAR_LEFT nor FIVEBAR_RIGHT.
  FIVEBAR_STATUS_NO_SUCH_SIDE = 2,
  // A number is infinite or not a number.
  FIVEBAR_STATUS_NOT_FINITE = 3,
  // fivebar_geometry_... or fivebar_tool_... has not written this arm or tool, or has refused it.
  FIVEBAR_STATUS_NOT_PREPARED = 4,
  // Length l1 is not a positive finite number.
  FIVEBAR_STATUS_LENGTH_L1 = 10,
  // Length l2 is not a positive finite number.
  FIVEBAR_STATUS_LENGTH_L2 = 11,
  // Length l3 is not a positive finite number.
  FIVEBAR_STATUS_LENGTH_L3 = 12,
  // Length l4 is not a positive finite number.
  FIVEBAR_STATUS_LENGTH_L4 = 13,
  // The base is not a finite number of 0 or more.
  FIVEBAR_STATUS_LENGTH_BASE = 14,
  // The longest length exceeds the sum of the other four: the loop cannot close.
  FIVEBAR_STATUS_CANNOT_ASSEMBLE = 15,
  // The tool's offset is not finite, or puts the tool on B.
  FIVEBAR_STATUS_TOOL_OFFSET = 16,
  // The point is farther from A than leg 1 reaches.
  FIVEBAR_STATUS_LEG1_TOO_FAR = 20,
  // The point is nearer to A than leg 1 reaches.
  FIVEBAR_STATUS_LEG1_TOO_NEAR = 21,
  // The point is farther from E than leg 4 reaches.
  FIVEBAR_STATUS_LEG4_TOO_FAR = 22,
  // The point is nearer to E than leg 4 reaches.
  FIVEBAR_STATUS_LEG4_TOO_NEAR = 23,
  // The elbows B and D are farther apart than l2 + l3.
  FIVEBAR_STATUS_ELBOWS_TOO_FAR = 24,
  // The elbows B and D are nearer than |l2 - l3|.
  FIVEBAR_STATUS_ELBOWS_TOO_NEAR = 25,
  // Leg 1 is straight or folded, or its end is on A: a singularity of type 1.
  FIVEBAR_STATUS_SINGULAR_LEG1 = 30,
  // Leg 4 is straight or folded, or its end is on E: a singularity of type 1.
  FIVEBAR_STATUS_SINGULAR_LEG4 = 31,
  // B, C and D are in line, or B meets D: a singularity of type 2.
  FIVEBAR_STATUS_SINGULAR_PARALLEL = 32,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FivebarStatus FivebarStatus;
#else
typedef int32_t FivebarStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The five lengths of an arm [m].
typedef struct {
  // A to B: the link that motor 1 turns.
  float l1;
  // B to C.
  float l2;
  // D to C.
  float l3;
  // E to D: the link that motor 4 turns.
  float l4;
  // A to E; 0 for coaxial motors.
  float base;
} FivebarLengthsF32;

// An arm of checked lengths. Only fivebar_geometry_... writes it; copy it freely, and leave its fields alone.
typedef struct {
  uint64_t fixed[9];
  float real[34];
} FivebarGeometryF32;

// A value of each driven joint. The unit is that of the argument or field.
typedef struct {
  // Of the joint at A.
  float joint1;
  // Of the joint at E.
  float joint4;
} FivebarJointsF32;

// A side of a directed line, with the plane's normal towards the viewer: FIVEBAR_LEFT or FIVEBAR_RIGHT.
typedef uint8_t FivebarSide;

// A vector in the frame of the base: x from A to E, y to its left. The unit is that of the argument or field.
typedef struct {
  // Along the base.
  float x;
  // To the left of the base.
  float y;
} FivebarVectorF32;

// A closed configuration of the arm.
typedef struct {
  // Unit vector of link 1, A to B.
  FivebarVectorF32 u1;
  // Unit vector of link 2, B to C.
  FivebarVectorF32 u2;
  // Unit vector of link 3, D to C.
  FivebarVectorF32 u3;
  // Unit vector of link 4, E to D.
  FivebarVectorF32 u4;
  // Elbow of leg 1 [m].
  FivebarVectorF32 b;
  // Where links 2 and 3 meet [m].
  FivebarVectorF32 c;
  // Elbow of leg 4 [m].
  FivebarVectorF32 d;
} FivebarPoseF32;

// Which way each leg's elbow turns: the branch of the inverse solution.
typedef struct {
  // FIVEBAR_LEFT where AB x BC > 0; with an offset tool T, where AB x BT > 0.
  FivebarSide elbow1;
  // FIVEBAR_LEFT where ED x DC > 0.
  FivebarSide elbow4;
} FivebarWorkingMode;

// Angular velocities of the links, and the velocity of C.
typedef struct {
  // Of link 1 [rad/s].
  float omega1;
  // Of link 2 [rad/s].
  float omega2;
  // Of link 3 [rad/s].
  float omega3;
  // Of link 4 [rad/s].
  float omega4;
  // Of C [m/s].
  FivebarVectorF32 c;
} FivebarVelocitiesF32;

// The Jacobian J of C, or of the tool T: velocity = J (rate of joint 1, rate of joint 4).
typedef struct {
  // Its first column: the velocity for each unit of joint 1's rate [m].
  FivebarVectorF32 joint1;
  // Its second column: the velocity for each unit of joint 4's rate [m].
  FivebarVectorF32 joint4;
} FivebarJacobianF32;

// What the motors of a leg need in a control period.
typedef struct {
  // Angles of links 1 and 4 [rad], in (-pi, pi].
  FivebarJointsF32 angle;
  // Their rates [rad/s].
  FivebarJointsF32 rate;
  // Torques that hold against the force [N m].
  FivebarJointsF32 torque;
} FivebarFootDriveF32;

// Where the tool T is from C [m]; both 0 put it on C.
typedef struct {
  // Along link 2, away from B.
  float along;
  // To the left of link 2.
  float left;
} FivebarOffsetF32;

// An arm with its tool. Only fivebar_tool_... writes it; copy it freely, and leave its fields alone.
typedef struct {
  uint64_t fixed[12];
  float real[50];
} FivebarToolF32;

// The five lengths of an arm [m].
typedef struct {
  // A to B: the link that motor 1 turns.
  double l1;
  // B to C.
  double l2;
  // D to C.
  double l3;
  // E to D: the link that motor 4 turns.
  double l4;
  // A to E; 0 for coaxial motors.
  double base;
} FivebarLengthsF64;

// An arm of checked lengths. Only fivebar_geometry_... writes it; copy it freely, and leave its fields alone.
typedef struct {
  uint64_t fixed[9];
  double real[34];
} FivebarGeometryF64;

// A value of each driven joint. The unit is that of the argument or field.
typedef struct {
  // Of the joint at A.
  double joint1;
  // Of the joint at E.
  double joint4;
} FivebarJointsF64;

// A vector in the frame of the base: x from A to E, y to its left. The unit is that of the argument or field.
typedef struct {
  // Along the base.
  double x;
  // To the left of the base.
  double y;
} FivebarVectorF64;

// A closed configuration of the arm.
typedef struct {
  // Unit vector of link 1, A to B.
  FivebarVectorF64 u1;
  // Unit vector of link 2, B to C.
  FivebarVectorF64 u2;
  // Unit vector of link 3, D to C.
  FivebarVectorF64 u3;
  // Unit vector of link 4, E to D.
  FivebarVectorF64 u4;
  // Elbow of leg 1 [m].
  FivebarVectorF64 b;
  // Where links 2 and 3 meet [m].
  FivebarVectorF64 c;
  // Elbow of leg 4 [m].
  FivebarVectorF64 d;
} FivebarPoseF64;

// Angular velocities of the links, and the velocity of C.
typedef struct {
  // Of link 1 [rad/s].
  double omega1;
  // Of link 2 [rad/s].
  double omega2;
  // Of link 3 [rad/s].
  double omega3;
  // Of link 4 [rad/s].
  double omega4;
  // Of C [m/s].
  FivebarVectorF64 c;
} FivebarVelocitiesF64;

// The Jacobian J of C, or of the tool T: velocity = J (rate of joint 1, rate of joint 4).
typedef struct {
  // Its first column: the velocity for each unit of joint 1's rate [m].
  FivebarVectorF64 joint1;
  // Its second column: the velocity for each unit of joint 4's rate [m].
  FivebarVectorF64 joint4;
} FivebarJacobianF64;

// What the motors of a leg need in a control period.
typedef struct {
  // Angles of links 1 and 4 [rad], in (-pi, pi].
  FivebarJointsF64 angle;
  // Their rates [rad/s].
  FivebarJointsF64 rate;
  // Torques that hold against the force [N m].
  FivebarJointsF64 torque;
} FivebarFootDriveF64;

// Where the tool T is from C [m]; both 0 put it on C.
typedef struct {
  // Along link 2, away from B.
  double along;
  // To the left of link 2.
  double left;
} FivebarOffsetF64;

// An arm with its tool. Only fivebar_tool_... writes it; copy it freely, and leave its fields alone.
typedef struct {
  uint64_t fixed[12];
  double real[50];
} FivebarToolF64;

// To the left.
#define FIVEBAR_LEFT 0

// To the right.
#define FIVEBAR_RIGHT 1

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Checks the lengths and prepares the arm for the other functions: call it once for each arm.
// Refused: LENGTH_..., which names the length; CANNOT_ASSEMBLE.
FivebarStatus fivebar_geometry_f32(FivebarLengthsF32 lengths, FivebarGeometryF32 *geometry);

// The pose of these angles of links 1 and 4 [rad]; assembly is FIVEBAR_LEFT for C to the left of the ray from B
// to D. Refused: ELBOWS_..., SINGULAR_PARALLEL where B is on D, NOT_FINITE, NO_SUCH_SIDE.
FivebarStatus fivebar_forward_f32(const FivebarGeometryF32 *geometry,
                                  FivebarJointsF32 angle,
                                  FivebarSide assembly,
                                  FivebarPoseF32 *pose);

// The pose that has C at a point [m].
// Refused: LEG1_... and LEG4_... out of reach, SINGULAR_LEG... where C is on A or E, NOT_FINITE, NO_SUCH_SIDE.
// A straight or folded leg is no error here; its velocities are refused.
FivebarStatus fivebar_inverse_f32(const FivebarGeometryF32 *geometry,
                                  FivebarVectorF32 c,
                                  FivebarWorkingMode mode,
                                  FivebarPoseF32 *pose);

// The angles of links 1 and 4 [rad], in (-pi, pi].
FivebarStatus fivebar_angles_f32(const FivebarPoseF32 *pose, FivebarJointsF32 *angle);

// The assembly of a pose, which fivebar_forward_f32 takes.
FivebarStatus fivebar_assembly_f32(const FivebarPoseF32 *pose, FivebarSide *assembly);

// The working mode of a pose, which fivebar_inverse_f32 takes.
FivebarStatus fivebar_working_mode_f32(const FivebarPoseF32 *pose, FivebarWorkingMode *mode);

// All velocities from the rates of links 1 and 4 [rad/s].
// Refused: SINGULAR_PARALLEL.
FivebarStatus fivebar_forward_velocities_f32(const FivebarGeometryF32 *geometry,
                                             const FivebarPoseF32 *pose,
                                             FivebarJointsF32 rate,
                                             FivebarVelocitiesF32 *velocities);

// All velocities from that of C [m/s].
// Refused: SINGULAR_LEG1, SINGULAR_LEG4.
FivebarStatus fivebar_inverse_velocities_f32(const FivebarGeometryF32 *geometry,
                                             const FivebarPoseF32 *pose,
                                             FivebarVectorF32 c_velocity,
                                             FivebarVelocitiesF32 *velocities);

// The Jacobian of C.
// Refused: SINGULAR_PARALLEL.
FivebarStatus fivebar_jacobian_f32(const FivebarGeometryF32 *geometry,
                                   const FivebarPoseF32 *pose,
                                   FivebarJacobianF32 *jacobian);

// The torques [N m] with which the motors hold against a force [N] on C, or on T with the Jacobian of T: -J^T F.
// Positive turns counter-clockwise.
FivebarStatus fivebar_hold_torque_f32(const FivebarJacobianF32 *jacobian,
                                      FivebarVectorF32 force,
                                      FivebarJointsF32 *torque);

// A whole control period of a leg: angles, rates and holding torques of the motors for the foot C at a point [m]
// with a velocity [m/s] and a force [N] of the ground on it. Faster than the functions above one after another.
// Refused: as fivebar_inverse_f32, and every singularity.
FivebarStatus fivebar_drive_foot_f32(const FivebarGeometryF32 *geometry,
                                     FivebarVectorF32 foot,
                                     FivebarVectorF32 velocity,
                                     FivebarVectorF32 force,
                                     FivebarWorkingMode knees,
                                     FivebarFootDriveF32 *drive);

// Prepares an arm with a tool T beside C: call it once for each tool. The geometry is copied.
// Refused: TOOL_OFFSET.
FivebarStatus fivebar_tool_f32(const FivebarGeometryF32 *geometry,
                               FivebarOffsetF32 offset,
                               FivebarToolF32 *tool);

// Where T is [m].
FivebarStatus fivebar_tool_point_f32(const FivebarToolF32 *tool,
                                     const FivebarPoseF32 *pose,
                                     FivebarVectorF32 *point);

// The pose that has T at a point [m].
// Refused: as fivebar_inverse_f32; leg 1 is A, B, T here.
FivebarStatus fivebar_tool_inverse_f32(const FivebarToolF32 *tool,
                                       FivebarVectorF32 t,
                                       FivebarWorkingMode mode,
                                       FivebarPoseF32 *pose);

// The velocity of T [m/s] from those of the links and of C.
FivebarStatus fivebar_tool_velocity_f32(const FivebarToolF32 *tool,
                                        const FivebarPoseF32 *pose,
                                        const FivebarVelocitiesF32 *velocities,
                                        FivebarVectorF32 *velocity);

// All velocities from that of T [m/s].
// Refused: SINGULAR_LEG1, where A, B, T are in line; SINGULAR_LEG4.
FivebarStatus fivebar_tool_inverse_velocities_f32(const FivebarToolF32 *tool,
                                                  const FivebarPoseF32 *pose,
                                                  FivebarVectorF32 t_velocity,
                                                  FivebarVelocitiesF32 *velocities);

// The Jacobian of T.
// Refused: SINGULAR_PARALLEL.
FivebarStatus fivebar_tool_jacobian_f32(const FivebarToolF32 *tool,
                                        const FivebarPoseF32 *pose,
                                        FivebarJacobianF32 *jacobian);

// Checks the lengths and prepares the arm for the other functions: call it once for each arm.
// Refused: LENGTH_..., which names the length; CANNOT_ASSEMBLE.
FivebarStatus fivebar_geometry_f64(FivebarLengthsF64 lengths, FivebarGeometryF64 *geometry);

// The pose of these angles of links 1 and 4 [rad]; assembly is FIVEBAR_LEFT for C to the left of the ray from B
// to D. Refused: ELBOWS_..., SINGULAR_PARALLEL where B is on D, NOT_FINITE, NO_SUCH_SIDE.
FivebarStatus fivebar_forward_f64(const FivebarGeometryF64 *geometry,
                                  FivebarJointsF64 angle,
                                  FivebarSide assembly,
                                  FivebarPoseF64 *pose);

// The pose that has C at a point [m].
// Refused: LEG1_... and LEG4_... out of reach, SINGULAR_LEG... where C is on A or E, NOT_FINITE, NO_SUCH_SIDE.
// A straight or folded leg is no error here; its velocities are refused.
FivebarStatus fivebar_inverse_f64(const FivebarGeometryF64 *geometry,
                                  FivebarVectorF64 c,
                                  FivebarWorkingMode mode,
                                  FivebarPoseF64 *pose);

// The angles of links 1 and 4 [rad], in (-pi, pi].
FivebarStatus fivebar_angles_f64(const FivebarPoseF64 *pose, FivebarJointsF64 *angle);

// The assembly of a pose, which fivebar_forward_f64 takes.
FivebarStatus fivebar_assembly_f64(const FivebarPoseF64 *pose, FivebarSide *assembly);

// The working mode of a pose, which fivebar_inverse_f64 takes.
FivebarStatus fivebar_working_mode_f64(const FivebarPoseF64 *pose, FivebarWorkingMode *mode);

// All velocities from the rates of links 1 and 4 [rad/s].
// Refused: SINGULAR_PARALLEL.
FivebarStatus fivebar_forward_velocities_f64(const FivebarGeometryF64 *geometry,
                                             const FivebarPoseF64 *pose,
                                             FivebarJointsF64 rate,
                                             FivebarVelocitiesF64 *velocities);

// All velocities from that of C [m/s].
// Refused: SINGULAR_LEG1, SINGULAR_LEG4.
FivebarStatus fivebar_inverse_velocities_f64(const FivebarGeometryF64 *geometry,
                                             const FivebarPoseF64 *pose,
                                             FivebarVectorF64 c_velocity,
                                             FivebarVelocitiesF64 *velocities);

// The Jacobian of C.
// Refused: SINGULAR_PARALLEL.
FivebarStatus fivebar_jacobian_f64(const FivebarGeometryF64 *geometry,
                                   const FivebarPoseF64 *pose,
                                   FivebarJacobianF64 *jacobian);

// The torques [N m] with which the motors hold against a force [N] on C, or on T with the Jacobian of T: -J^T F.
// Positive turns counter-clockwise.
FivebarStatus fivebar_hold_torque_f64(const FivebarJacobianF64 *jacobian,
                                      FivebarVectorF64 force,
                                      FivebarJointsF64 *torque);

// A whole control period of a leg: angles, rates and holding torques of the motors for the foot C at a point [m]
// with a velocity [m/s] and a force [N] of the ground on it. Faster than the functions above one after another.
// Refused: as fivebar_inverse_f64, and every singularity.
FivebarStatus fivebar_drive_foot_f64(const FivebarGeometryF64 *geometry,
                                     FivebarVectorF64 foot,
                                     FivebarVectorF64 velocity,
                                     FivebarVectorF64 force,
                                     FivebarWorkingMode knees,
                                     FivebarFootDriveF64 *drive);

// Prepares an arm with a tool T beside C: call it once for each tool. The geometry is copied.
// Refused: TOOL_OFFSET.
FivebarStatus fivebar_tool_f64(const FivebarGeometryF64 *geometry,
                               FivebarOffsetF64 offset,
                               FivebarToolF64 *tool);

// Where T is [m].
FivebarStatus fivebar_tool_point_f64(const FivebarToolF64 *tool,
                                     const FivebarPoseF64 *pose,
                                     FivebarVectorF64 *point);

// The pose that has T at a point [m].
// Refused: as fivebar_inverse_f64; leg 1 is A, B, T here.
FivebarStatus fivebar_tool_inverse_f64(const FivebarToolF64 *tool,
                                       FivebarVectorF64 t,
                                       FivebarWorkingMode mode,
                                       FivebarPoseF64 *pose);

// The velocity of T [m/s] from those of the links and of C.
FivebarStatus fivebar_tool_velocity_f64(const FivebarToolF64 *tool,
                                        const FivebarPoseF64 *pose,
                                        const FivebarVelocitiesF64 *velocities,
                                        FivebarVectorF64 *velocity);

// All velocities from that of T [m/s].
// Refused: SINGULAR_LEG1, where A, B, T are in line; SINGULAR_LEG4.
FivebarStatus fivebar_tool_inverse_velocities_f64(const FivebarToolF64 *tool,
                                                  const FivebarPoseF64 *pose,
                                                  FivebarVectorF64 t_velocity,
                                                  FivebarVelocitiesF64 *velocities);

// The Jacobian of T.
// Refused: SINGULAR_PARALLEL.
FivebarStatus fivebar_tool_jacobian_f64(const FivebarToolF64 *tool,
                                        const FivebarPoseF64 *pose,
                                        FivebarJacobianF64 *jacobian);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FIVEBAR_H */
