#pragma once

#include <array>
#include <string>

#include "core/color/row_classifier.h"

namespace touchline::testing {

// Kernels for this processor family, except the portable one. The processor may lack some of them.
#if defined(__x86_64__)
constexpr std::array kKernels = {KernelChoice::kAvx2};
#elif defined(__aarch64__)
constexpr std::array kKernels = {KernelChoice::kNeon};
#else
constexpr std::array kKernels = {KernelChoice::kPortable};
#endif

inline std::string word_of(KernelChoice choice) {
  return std::string(kKernelChoices[static_cast<std::size_t>(choice)].word);
}

}  // namespace touchline::testing
