/* Names of one precision: float, or double with -DDOUBLE. F(angles) is fivebar_angles_f32, T(Pose) FivebarPoseF32. */
#include "fivebar.h"
#include <inttypes.h>

#ifdef DOUBLE
typedef double real;
typedef uint64_t bits;
#define F(name) fivebar_##name##_f64
#define T(name) Fivebar##name##F64
#define READ_BITS SCNx64
#define WRITE_BITS PRIx64
#else
typedef float real;
typedef uint32_t bits;
#define F(name) fivebar_##name##_f32
#define T(name) Fivebar##name##F32
#define READ_BITS SCNx32
#define WRITE_BITS PRIx32
#endif
