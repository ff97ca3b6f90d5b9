#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "core/color/span_kernel.h"

namespace touchline {

/// Extends a kernel for whole pixel pairs to any span: the portable kernel classifies the single pixels at the ends.
template <PixelFormat kFormat, SpanKernel kKernel>
OccupiedWords classify_any_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                                ColorId* colors) {
  if ((begin | end) % 2 == 0 && begin < end) return kKernel(tables, row, begin, end, colors);
  OccupiedWords occupied = 0;
  if (begin % 2 == 1 && begin < end) {
    occupied |= portable_span_kernel(kFormat)(tables, row, begin, begin + 1, colors);
    ++begin;
  }
  if (end % 2 == 1 && begin < end) {
    occupied |= portable_span_kernel(kFormat)(tables, row, end - 1, end, colors);
    --end;
  }
  return begin < end ? occupied | kKernel(tables, row, begin, end, colors) : occupied;
}

/// Decides whether a further rejection test saves time. `left` has one bit for each candidate among `count` blocks. A
/// further test saves no time if there are few candidates, because these are classified faster than tested, or if most
/// blocks are candidates, because most of these contain colors.
[[gnu::always_inline]] inline bool is_second_pass_worthwhile(std::uint64_t left, std::uint32_t count) {
  const auto number = static_cast<std::uint32_t>(std::popcount(left));
  return count < 8 * number && 2 * number <= count;
}

/// Finds the kernel of a family for the format. `Family::kKernel<format>` takes non-empty spans; where pixel pairs
/// share chroma, they consist of whole pairs.
template <class Family, bool kTakesAnySpan = false>
SpanKernel kernel_of_format(PixelFormat format) {
  static constexpr auto kKernels = []<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
    const auto kernel_of = []<std::size_t kFormat>() -> SpanKernel {
      constexpr PixelFormat kThis = kPixelFormatTable[kFormat].format;
      if constexpr (shares_chroma(kThis) && !kTakesAnySpan)
        return classify_any_span<kThis, Family::template kKernel<kThis>>;
      else
        return Family::template kKernel<kThis>;
    };
    return std::array{kernel_of.template operator()<kIndex>()...};
  }
  (std::make_index_sequence<kPixelFormatTable.size()>());
  return kKernels[static_cast<std::size_t>(format)];
}

}  // namespace touchline
