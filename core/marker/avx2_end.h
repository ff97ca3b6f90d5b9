#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef TOUCHLINE_LANES_OF_AVX2
