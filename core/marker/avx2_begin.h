// What follows, up to avx2_end.h, is compiled for AVX2: functions, and templates that are written there. No header of
// the standard library and none that others include without AVX2 may follow: a linker would take either's functions
// for both.
#define TOUCHLINE_LANES_OF_AVX2
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
