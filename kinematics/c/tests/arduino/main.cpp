/* Runs the example for its 2 s. */
#include "Arduino.h"
#include "../../arduino/examples/Leg/Leg.ino"

int main() {
    setup();
    for (int period = 0; period < 200; period++) {
        loop();
    }
}
