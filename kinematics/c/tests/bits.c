/* Reads cases, a line each: 17 numbers as the hexadecimal digits of their bits, and three sides. Prints for each call of
 * the library the status, and the bits of the result if there is one. tests/c.rs writes the cases and compares. */
#include "precision.h"
#include <stdio.h>
#include <string.h>

enum { UNTOUCHED = 0x5A };

static void print_result(const char *name, FivebarStatus status, const void *result, size_t size) {
    const unsigned char *bytes = result;
    printf("%s %d", name, (int)status);
    if (status != FIVEBAR_STATUS_OK) {
        for (size_t i = 0; i < size; i++) {
            if (bytes[i] != UNTOUCHED) {
                printf(" written");
                break;
            }
        }
    } else if (size % sizeof(bits) == 0) {
        for (size_t i = 0; i < size; i += sizeof(bits)) {
            bits word;
            memcpy(&word, bytes + i, sizeof word);
            printf(" %" WRITE_BITS, word);
        }
    } else {
        /* Sides. */
        for (size_t i = 0; i < size; i++) {
            printf(" %u", bytes[i]);
        }
    }
    printf("\n");
}

/* Declares `result` and calls the function with its address last. */
#define CALL(type, result, name, ...)                    \
    type result;                                         \
    memset(&result, UNTOUCHED, sizeof result);           \
    FivebarStatus name = F(name)(__VA_ARGS__, &result)
/* As CALL; prints the result too. */
#define PRINT(type, result, name, ...)                   \
    CALL(type, result, name, __VA_ARGS__);               \
    print_result(#name, name, &result, sizeof result)
/* As CALL; prints the status, and whether a refused call has written. */
#define PRINT_STATUS(type, result, name, ...)            \
    CALL(type, result, name, __VA_ARGS__);               \
    print_result(#name, name, &result, name == FIVEBAR_STATUS_OK ? 0 : sizeof result)

static void with_jacobian(const T(Jacobian) *jacobian, T(Vector) force) {
    PRINT(T(Joints), torque, hold_torque, jacobian, force);
}

static void branches(const T(Pose) *pose) {
    PRINT(T(Joints), angle, angles, pose);
    PRINT(FivebarSide, side, assembly, pose);
    PRINT(FivebarWorkingMode, mode, working_mode, pose);
}

struct inputs {
    T(Lengths) lengths;
    T(Joints) angle;
    T(Vector) point, velocity, force;
    T(Joints) rate;
    T(Offset) offset;
};

static void run(struct inputs in, FivebarSide side, FivebarWorkingMode mode) {
    PRINT_STATUS(T(Geometry), arm, geometry, in.lengths);
    if (geometry != FIVEBAR_STATUS_OK) {
        return;
    }
    PRINT(T(Pose), reached, forward, &arm, in.angle, side);
    if (forward == FIVEBAR_STATUS_OK) {
        branches(&reached);
        PRINT(T(Velocities), velocities, forward_velocities, &arm, &reached, in.rate);
        PRINT(T(Jacobian), of_c, jacobian, &arm, &reached);
        if (jacobian == FIVEBAR_STATUS_OK) {
            with_jacobian(&of_c, in.force);
        }
    }
    PRINT(T(Pose), held, inverse, &arm, in.point, mode);
    if (inverse == FIVEBAR_STATUS_OK) {
        branches(&held);
        PRINT(T(Velocities), velocities, inverse_velocities, &arm, &held, in.velocity);
        PRINT(T(Jacobian), of_c, jacobian, &arm, &held);
    }
    PRINT(T(FootDrive), drive, drive_foot, &arm, in.point, in.velocity, in.force, mode);

    PRINT_STATUS(T(Tool), pen, tool, &arm, in.offset);
    if (tool != FIVEBAR_STATUS_OK) {
        return;
    }
    PRINT(T(Pose), drawing, tool_inverse, &pen, in.point, mode);
    if (tool_inverse == FIVEBAR_STATUS_OK) {
        PRINT(T(Vector), point, tool_point, &pen, &drawing);
        PRINT(T(Velocities), velocities, tool_inverse_velocities, &pen, &drawing, in.velocity);
        if (tool_inverse_velocities == FIVEBAR_STATUS_OK) {
            PRINT(T(Vector), velocity, tool_velocity, &pen, &drawing, &velocities);
        }
        PRINT(T(Jacobian), of_t, tool_jacobian, &pen, &drawing);
        if (tool_jacobian == FIVEBAR_STATUS_OK) {
            with_jacobian(&of_t, in.force);
        }
    }
}

int main(void) {
    for (;;) {
        real numbers[17];
        unsigned sides[3];
        struct inputs in;
        for (int i = 0; i < 17; i++) {
            bits word;
            if (scanf("%" READ_BITS, &word) != 1) {
                return i == 0 ? 0 : 1;
            }
            memcpy(&numbers[i], &word, sizeof word);
        }
        if (scanf("%u %u %u", &sides[0], &sides[1], &sides[2]) != 3) {
            return 1;
        }
        in.lengths.l1 = numbers[0];
        in.lengths.l2 = numbers[1];
        in.lengths.l3 = numbers[2];
        in.lengths.l4 = numbers[3];
        in.lengths.base = numbers[4];
        in.angle.joint1 = numbers[5];
        in.angle.joint4 = numbers[6];
        in.point.x = numbers[7];
        in.point.y = numbers[8];
        in.velocity.x = numbers[9];
        in.velocity.y = numbers[10];
        in.force.x = numbers[11];
        in.force.y = numbers[12];
        in.rate.joint1 = numbers[13];
        in.rate.joint4 = numbers[14];
        in.offset.along = numbers[15];
        in.offset.left = numbers[16];
        FivebarWorkingMode mode = {(FivebarSide)sides[1], (FivebarSide)sides[2]};
        run(in, (FivebarSide)sides[0], mode);
    }
}
