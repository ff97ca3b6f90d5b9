#pragma once

#include <array>
#include <cstdint>

#include "core/parameter.h"

namespace touchline {

/// By which instructions pixels are classified; all give the same colors. kFastest: what this processor does best.
enum class KernelChoice : std::uint8_t { kFastest, kPortable, kAvx2, kAvx512, kNeon };
inline constexpr std::array<Choice<KernelChoice>, 5> kKernelChoices{{{"fastest", KernelChoice::kFastest},
                                                                     {"portable", KernelChoice::kPortable},
                                                                     {"avx2", KernelChoice::kAvx2},
                                                                     {"avx512", KernelChoice::kAvx512},
                                                                     {"neon", KernelChoice::kNeon}}};

}  // namespace touchline
