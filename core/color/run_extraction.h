#pragma once

#include <cstdint>

#include "core/types.h"

namespace touchline {

// A row of colors is followed by this many bytes of background, so that words can be loaded anywhere in it.
constexpr std::size_t kColorRowPadding = 8;

/// The runs of colors[begin, end) in their order, written to `out`, which has room for end - begin of them; `next` is
/// not set. colors[end, end + kColorRowPadding) is background. Returns how many there are.
std::size_t extract_runs(const ColorId* colors, std::uint16_t begin, std::uint16_t end, std::uint16_t row, Run* out);

/// How many there would be.
std::size_t count_runs(const ColorId* colors, std::uint16_t begin, std::uint16_t end);

}  // namespace touchline
