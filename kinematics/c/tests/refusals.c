/* Null pointers, sides that do not exist, and arms and tools that were not prepared are refused. Prints the line of
 * what is not refused, if there is one. */
#include "precision.h"
#include <stddef.h>
#include <stdio.h>

#define EXPECT(status, call)                             \
    do {                                                 \
        if ((call) != (status)) {                        \
            printf("line %d\n", __LINE__);               \
            return 1;                                    \
        }                                                \
    } while (0)
#define NULLS(call) EXPECT(FIVEBAR_STATUS_NULL_POINTER, call)
#define NOT_PREPARED(call) EXPECT(FIVEBAR_STATUS_NOT_PREPARED, call)

int main(void) {
    const T(Lengths) lengths = {(real)0.09, (real)0.16, (real)0.16, (real)0.09, (real)0.04};
    const T(Vector) foot = {(real)0.02, (real)-0.18}, zero = {0, 0};
    const T(Joints) angle = {2, 1}, rest = {0, 0};
    const T(Offset) offset = {(real)0.01, 0};
    const FivebarWorkingMode mode = {FIVEBAR_LEFT, FIVEBAR_RIGHT};
    T(Geometry) arm;
    T(Pose) pose;
    T(Velocities) velocities;
    T(Jacobian) jacobian;
    T(Joints) torque;
    T(FootDrive) drive;
    T(Tool) tool;
    T(Vector) point;
    FivebarSide side;
    FivebarWorkingMode found;

    EXPECT(FIVEBAR_STATUS_OK, F(geometry)(lengths, &arm));
    EXPECT(FIVEBAR_STATUS_OK, F(inverse)(&arm, foot, mode, &pose));
    EXPECT(FIVEBAR_STATUS_OK, F(inverse_velocities)(&arm, &pose, foot, &velocities));
    EXPECT(FIVEBAR_STATUS_OK, F(jacobian)(&arm, &pose, &jacobian));
    EXPECT(FIVEBAR_STATUS_OK, F(tool)(&arm, offset, &tool));

    NULLS(F(geometry)(lengths, NULL));
    NULLS(F(forward)(NULL, angle, FIVEBAR_LEFT, &pose));
    NULLS(F(forward)(&arm, angle, FIVEBAR_LEFT, NULL));
    NULLS(F(inverse)(NULL, foot, mode, &pose));
    NULLS(F(inverse)(&arm, foot, mode, NULL));
    NULLS(F(angles)(NULL, &torque));
    NULLS(F(angles)(&pose, NULL));
    NULLS(F(assembly)(NULL, &side));
    NULLS(F(assembly)(&pose, NULL));
    NULLS(F(working_mode)(NULL, &found));
    NULLS(F(working_mode)(&pose, NULL));
    NULLS(F(forward_velocities)(NULL, &pose, rest, &velocities));
    NULLS(F(forward_velocities)(&arm, NULL, rest, &velocities));
    NULLS(F(forward_velocities)(&arm, &pose, rest, NULL));
    NULLS(F(inverse_velocities)(NULL, &pose, zero, &velocities));
    NULLS(F(inverse_velocities)(&arm, NULL, zero, &velocities));
    NULLS(F(inverse_velocities)(&arm, &pose, zero, NULL));
    NULLS(F(jacobian)(NULL, &pose, &jacobian));
    NULLS(F(jacobian)(&arm, NULL, &jacobian));
    NULLS(F(jacobian)(&arm, &pose, NULL));
    NULLS(F(hold_torque)(NULL, zero, &torque));
    NULLS(F(hold_torque)(&jacobian, zero, NULL));
    NULLS(F(drive_foot)(NULL, foot, zero, zero, mode, &drive));
    NULLS(F(drive_foot)(&arm, foot, zero, zero, mode, NULL));
    NULLS(F(tool)(NULL, offset, &tool));
    NULLS(F(tool)(&arm, offset, NULL));
    NULLS(F(tool_point)(NULL, &pose, &point));
    NULLS(F(tool_point)(&tool, NULL, &point));
    NULLS(F(tool_point)(&tool, &pose, NULL));
    NULLS(F(tool_inverse)(NULL, foot, mode, &pose));
    NULLS(F(tool_inverse)(&tool, foot, mode, NULL));
    NULLS(F(tool_velocity)(NULL, &pose, &velocities, &point));
    NULLS(F(tool_velocity)(&tool, NULL, &velocities, &point));
    NULLS(F(tool_velocity)(&tool, &pose, NULL, &point));
    NULLS(F(tool_velocity)(&tool, &pose, &velocities, NULL));
    NULLS(F(tool_inverse_velocities)(NULL, &pose, zero, &velocities));
    NULLS(F(tool_inverse_velocities)(&tool, NULL, zero, &velocities));
    NULLS(F(tool_inverse_velocities)(&tool, &pose, zero, NULL));
    NULLS(F(tool_jacobian)(NULL, &pose, &jacobian));
    NULLS(F(tool_jacobian)(&tool, NULL, &jacobian));
    NULLS(F(tool_jacobian)(&tool, &pose, NULL));

    for (unsigned other = 2; other <= 255; other++) {
        const FivebarWorkingMode first = {(FivebarSide)other, FIVEBAR_LEFT};
        const FivebarWorkingMode second = {FIVEBAR_LEFT, (FivebarSide)other};
        EXPECT(FIVEBAR_STATUS_NO_SUCH_SIDE, F(forward)(&arm, angle, (FivebarSide)other, &pose));
        EXPECT(FIVEBAR_STATUS_NO_SUCH_SIDE, F(inverse)(&arm, foot, first, &pose));
        EXPECT(FIVEBAR_STATUS_NO_SUCH_SIDE, F(inverse)(&arm, foot, second, &pose));
        EXPECT(FIVEBAR_STATUS_NO_SUCH_SIDE, F(tool_inverse)(&tool, foot, second, &pose));
        EXPECT(FIVEBAR_STATUS_NO_SUCH_SIDE, F(drive_foot)(&arm, foot, zero, zero, first, &drive));
    }

    /* Static memory starts as zeros, and a refused call leaves it so. */
    static T(Geometry) no_arm;
    static T(Tool) no_tool;
    const T(Lengths) no_lengths = {0, 0, 0, 0, 0};
    EXPECT(FIVEBAR_STATUS_LENGTH_L1, F(geometry)(no_lengths, &no_arm));
    NOT_PREPARED(F(forward)(&no_arm, angle, FIVEBAR_LEFT, &pose));
    NOT_PREPARED(F(inverse)(&no_arm, foot, mode, &pose));
    NOT_PREPARED(F(forward_velocities)(&no_arm, &pose, rest, &velocities));
    NOT_PREPARED(F(inverse_velocities)(&no_arm, &pose, zero, &velocities));
    NOT_PREPARED(F(jacobian)(&no_arm, &pose, &jacobian));
    NOT_PREPARED(F(drive_foot)(&no_arm, foot, zero, zero, mode, &drive));
    NOT_PREPARED(F(tool)(&no_arm, offset, &no_tool));
    NOT_PREPARED(F(tool_point)(&no_tool, &pose, &point));
    NOT_PREPARED(F(tool_inverse)(&no_tool, foot, mode, &pose));
    NOT_PREPARED(F(tool_velocity)(&no_tool, &pose, &velocities, &point));
    NOT_PREPARED(F(tool_inverse_velocities)(&no_tool, &pose, zero, &velocities));
    NOT_PREPARED(F(tool_jacobian)(&no_tool, &pose, &jacobian));
    return 0;
}
