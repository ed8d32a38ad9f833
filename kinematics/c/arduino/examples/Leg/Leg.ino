// The foot of a leg goes up and down; once in each period the program prints what the two motors need.
// Both motors sit at the hip, x points forwards from motor 1 to motor 4, and the foot is below, at negative y.

#include <fivebar.h>

const float PERIOD_S = 0.01f;
const float HEIGHT_M = 0.18f;
const float STROKE_M = 0.03f;
const float STEPS_PER_S = 0.5f;

static FivebarGeometryF32 leg;
static uint32_t periods = 0;

void setup() {
    Serial.begin(115200);
    // Thighs and shanks, and the distance of the motors [m]. The base is 0 for motors on one axis.
    FivebarLengthsF32 lengths;
    lengths.l1 = 0.09f;
    lengths.l2 = 0.16f;
    lengths.l3 = 0.16f;
    lengths.l4 = 0.09f;
    lengths.base = 0.04f;
    // A refused leg is not prepared, and fivebar_drive_foot_f32 refuses it too.
    fivebar_geometry_f32(lengths, &leg);
}

void loop() {
    const float rate = 2.0f * PI * STEPS_PER_S;  // rad/s
    const float phase = rate * PERIOD_S * periods;
    FivebarVectorF32 foot = {0.02f, -HEIGHT_M + STROKE_M * sinf(phase)};  // m
    FivebarVectorF32 velocity = {0.0f, STROKE_M * rate * cosf(phase)};  // m/s
    FivebarVectorF32 ground = {0.0f, 20.0f};  // N, on the foot
    FivebarWorkingMode kneesOut = {FIVEBAR_LEFT, FIVEBAR_RIGHT};

    FivebarFootDriveF32 motors;
    FivebarStatus status = fivebar_drive_foot_f32(&leg, foot, velocity, ground, kneesOut, &motors);
    if (status == FIVEBAR_STATUS_OK) {
        // Give these to the drivers of the motors: angles [rad], rates [rad/s], torques [N m].
        Serial.print(motors.angle.joint1, 4);
        Serial.print(' ');
        Serial.print(motors.angle.joint4, 4);
        Serial.print(' ');
        Serial.print(motors.torque.joint1, 4);
        Serial.print(' ');
        Serial.println(motors.torque.joint4, 4);
    } else {
        Serial.print("refused with status ");
        Serial.println(int(status));
    }
    periods = (periods + 1) % 200;  // 2 s, a whole step
    delay(uint32_t(1000 * PERIOD_S));
}
