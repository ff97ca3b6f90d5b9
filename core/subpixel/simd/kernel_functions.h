// The functions of a FitKernel (fit_kernel.h), written with eight floats at a time.
//
// This file is included once for each instruction set and therefore has no include guard. The includer first includes
// simd/prerequisites.h, then defines TOUCHLINE_SIMD as the namespace for the code, and for AVX2 also
// TOUCHLINE_SIMD_AVX2. All instruction sets do the same operations in the same order, so their results are identical
// to the bit.

// clang-format off
#include "core/subpixel/simd/float8.h"
#include "core/subpixel/simd/linear_rgb.h"
#include "core/subpixel/simd/outline_coverage.h"
#include "core/subpixel/simd/outline_pixels.h"
#include "core/subpixel/simd/patch_sampler.h"
#include "core/subpixel/simd/ball_sampler.h"
// clang-format on
