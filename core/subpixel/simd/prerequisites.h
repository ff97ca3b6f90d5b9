#pragma once

// Everything that simd/kernel_functions.h uses from other headers. Include this file before selecting an instruction
// set: an inline function of the standard library that is compiled for AVX2 could replace the portable one at link
// time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "core/fixed_vector.h"
#include "core/subpixel/blurred_outline.h"
#include "core/subpixel/fit_kernel.h"
#include "core/types.h"
