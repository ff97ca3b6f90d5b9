#pragma once

#include <array>
#include <cstdint>

#include "core/parameter.h"

// Lists the instruction sets for which there are kernels, and tells whether this processor has them. All sets give the
// same results.

// Processor features that the functions of a set are compiled for, in the syntax of [[gnu::target]]. cpu_supports()
// checks this list.
#define TOUCHLINE_PORTABLE_TARGET ""
#define TOUCHLINE_AVX2_TARGET "avx2,bmi,popcnt"
#define TOUCHLINE_NEON_TARGET "neon"

// Every vector function names its target itself. If a whole file were compiled for AVX2, inline functions that it
// shares with other files would contain AVX2 code as well, and the linker could pick them for an older processor.
#define TOUCHLINE_AVX2 [[gnu::target(TOUCHLINE_AVX2_TARGET)]]
#define TOUCHLINE_AVX2_INLINE [[gnu::target(TOUCHLINE_AVX2_TARGET), gnu::always_inline]] inline
// One pass over a row. Not inlined: with merged passes, the compiler has too few registers for the state of all loops.
#define TOUCHLINE_AVX2_PASS [[gnu::target(TOUCHLINE_AVX2_TARGET), gnu::noinline]] static

// Each of these macros expands to its argument on its own processor family, and to nothing on others.
#define TOUCHLINE_ON_ANY(...) __VA_ARGS__
#if defined(__x86_64__)
#define TOUCHLINE_ON_X86(...) __VA_ARGS__
#else
#define TOUCHLINE_ON_X86(...)
#endif
#if defined(__aarch64__)
#define TOUCHLINE_ON_ARM(...) __VA_ARGS__
#else
#define TOUCHLINE_ON_ARM(...)
#endif

/// The only list of kernels. To add an instruction set, add a line with the functions of each stage; if a stage has no
/// code for the set, name the functions of another set. Within a processor family, faster sets come later.
///   family, enumerator, word of scan.kernel, features, span kernel (core/color), fit kernel (core/subpixel)
// clang-format off
#define TOUCHLINE_KERNEL_SETS(SET)                                                                      \
  SET(ANY, kPortable, "portable", TOUCHLINE_PORTABLE_TARGET, portable_span_kernel, portable_fit_kernel) \
  SET(X86, kAvx2, "avx2", TOUCHLINE_AVX2_TARGET, avx2_span_kernel, avx2_fit_kernel)                     \
  SET(ARM, kNeon, "neon", TOUCHLINE_NEON_TARGET, neon_span_kernel, portable_fit_kernel)
// clang-format on

namespace touchline {

/// The instruction set that classifies pixels. kFastest: the fastest one that this processor has.
enum class KernelChoice : std::uint8_t {
  kFastest,
#define TOUCHLINE_SET(family, choice, ...) choice,
  TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)
#undef TOUCHLINE_SET
};

/// The values of the key scan.kernel, in the order of the enumerators.
inline constexpr std::array kKernelChoices{Choice<KernelChoice>{"fastest", KernelChoice::kFastest},
#define TOUCHLINE_SET(family, choice, word, ...) Choice<KernelChoice>{word, KernelChoice::choice},
                                           TOUCHLINE_KERNEL_SETS(TOUCHLINE_SET)
#undef TOUCHLINE_SET
};

/// Returns false if this processor lacks a feature of the set.
[[nodiscard]] bool cpu_supports(KernelChoice set);

/// Replaces kFastest by the fastest set that this processor has, and leaves other sets as they are.
[[nodiscard]] KernelChoice resolve(KernelChoice set);

}  // namespace touchline
