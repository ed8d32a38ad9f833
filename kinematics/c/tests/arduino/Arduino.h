/* As much of Arduino as the example needs, so that a desktop compiles and runs it. */
#include <cmath>
#include <cstdint>
#include <cstdio>

const double PI = 3.14159265358979;

struct Port {
    void begin(unsigned long) {}
    void print(const char *text) { std::printf("%s", text); }
    void print(char character) { std::printf("%c", character); }
    void print(double number, int digits) { std::printf("%.*f", digits, number); }
    void println(double number, int digits) { std::printf("%.*f\n", digits, number); }
    void println(int number) { std::printf("%d\n", number); }
};
static Port Serial;

inline void delay(unsigned long) {}
