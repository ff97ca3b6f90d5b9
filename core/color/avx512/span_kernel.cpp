#include "core/color/span_kernel.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <bit>

#include "core/color/avx512/nibble_lookup.h"
#include "core/color/avx512/pixel_layout.h"
#include "core/color/avx512/shaded_row.h"
#include "core/color/kernel_of_format.h"

namespace touchline {
namespace avx512 {
namespace {

TOUCHLINE_TARGET_INLINE Channel channel_of(const SpanTables& tables, __m512i values, std::size_t channel) {
  return {high_nibble(values), low_nibble(values), &tables.nibbles->channel(channel, tables.tiles->level[channel])};
}
template <class Layout, bool kIsWhole>
TOUCHLINE_TARGET_INLINE Channels channels_at(const SpanTables& tables, const RowPixels& row, const Block& block) {
  const Planes planes = Layout::planes(Layout::template bytes_of<kIsWhole>(row, block));
  return {channel_of(tables, planes.first, 0), channel_of(tables, planes.second, 1),
          channel_of(tables, planes.third, 2)};
}

TOUCHLINE_TARGET_INLINE __m512i colors_of(const SpanTables& tables, const Channels& channels) {
  __m512i colors = _mm512_setzero_si512();
  for (std::size_t group = 0; group < tables.nibbles->groups(); ++group) {
    __m512i classes = coarse_classes(channels, group);
    classes = classes_of(channels.first, group, classes);
    classes = classes_of(channels.second, group, classes);
    classes = classes_of(channels.third, group, classes);
    colors = add_colors(colors, tables.nibbles->colors(), group, classes);
  }
  return colors;
}

// The blocks that overlap a span. A block is a word of the row, so each has a bit in OccupiedWords.
struct Span {
  std::uint32_t begin, end;
  [[nodiscard]] Block block(std::uint32_t word) const {
    const std::uint32_t u = word * kBlock;
    return {u, std::max(begin, u) - u, std::min(end, u + kBlock) - u};
  }
};

// The three tests of a block. Each returns 1 if the next one is needed; the last one, if the block contains colors.
template <class Layout, bool kIsWhole>
TOUCHLINE_TARGET_INLINE OccupiedWords is_candidate(const RowPixels& row, const Block& block,
                                                   const typename Layout::Background& of_row, ColorId* colors) {
  const typename Layout::Bytes bytes = Layout::template bytes_of<kIsWhole>(row, block);
  const __m512i candidates = Layout::candidates(bytes, of_row);
  store<kIsWhole>(colors, block, _mm512_setzero_si512());
  return OccupiedWords{_mm512_test_epi8_mask(candidates, candidates) != 0};
}
template <class Layout, bool kIsWhole>
TOUCHLINE_TARGET_INLINE OccupiedWords matches_coarsely(const SpanTables& tables, const RowPixels& row,
                                                       const Block& block) {
  const Channels channels = channels_at<Layout, kIsWhole>(tables, row, block);
  __m512i near = _mm512_setzero_si512();
  for (std::size_t group = 0; group < tables.nibbles->groups(); ++group) {
    near = _mm512_or_si512(near, coarse_classes(channels, group));
  }
  return OccupiedWords{_mm512_test_epi8_mask(near, near) != 0};
}
template <class Layout, bool kIsWhole>
TOUCHLINE_TARGET_INLINE OccupiedWords is_colored(const SpanTables& tables, const RowPixels& row, const Block& block,
                                                 ColorId* colors) {
  const __m512i found = colors_of(tables, channels_at<Layout, kIsWhole>(tables, row, block));
  store<kIsWhole>(colors, block, found);
  return OccupiedWords{_mm512_mask_test_epi8_mask(block.inside(), found, found) != 0};
}

// One pass for each test, as in the AVX2 kernel: no branch within a pass depends on the pixels.
template <class Layout>
TOUCHLINE_TARGET_INLINE OccupiedWords classify_blocks(const SpanTables& tables, const RowPixels& row, const Span& span,
                                                      ColorId* colors) {
  const auto of_row = Layout::background(_mm512_maskz_loadu_epi8(bits(0, sizeof(TileParameters)), tables.tiles));
  const std::uint32_t first = span.begin / kBlock, stop = (span.end + kBlock - 1) / kBlock;
  OccupiedWords left = 0;
  for (std::uint32_t word = first; word < stop; ++word) {
    const Block block = span.block(word);
    left |= (block.is_whole() ? is_candidate<Layout, true>(row, block, of_row, colors)
                              : is_candidate<Layout, false>(row, block, of_row, colors))
            << word;
  }
  if (!tables.has_background_box) left = bits(first, stop);

  if (is_second_pass_worthwhile(left, stop - first)) {
    OccupiedWords near = 0;
    for (; left != 0; left &= left - 1) {
      const auto word = static_cast<std::uint32_t>(std::countr_zero(left));
      const Block block = span.block(word);
      near |= (block.is_whole() ? matches_coarsely<Layout, true>(tables, row, block)
                                : matches_coarsely<Layout, false>(tables, row, block))
              << word;
    }
    left = near;
  }
  OccupiedWords occupied = 0;
  for (; left != 0; left &= left - 1) {
    const auto word = static_cast<std::uint32_t>(std::countr_zero(left));
    const Block block = span.block(word);
    occupied |= (block.is_whole() ? is_colored<Layout, true>(tables, row, block, colors)
                                  : is_colored<Layout, false>(tables, row, block, colors))
                << word;
  }
  return occupied;
}

// A separate function, so that rows without a light map do not save its registers.
template <PixelFormat kFormat>
[[gnu::noinline]] TOUCHLINE_TARGET_FUNCTION OccupiedWords classify_shaded(const SpanTables& tables,
                                                                          const RowPixels& row, std::uint32_t begin,
                                                                          std::uint32_t end, ColorId* colors) {
  if (end < begin + avx512_shaded::kTile) return portable_span_kernel(kFormat)(tables, row, begin, end, colors);
  return avx512_shaded::classify_shaded_span<avx512_shaded::ShadedLayoutOf<kFormat>>(tables, row, begin, end, colors);
}

template <PixelFormat kFormat, class Layout>
TOUCHLINE_TARGET_FUNCTION OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row,
                                                      std::uint32_t begin, std::uint32_t end, ColorId* colors) {
  if (begin >= end) return 0;
  if (!tables.unshaded) return classify_shaded<kFormat>(tables, row, begin, end, colors);
  // Copies, which stores to `colors` cannot change.
  const SpanTables of_row = tables;
  const RowPixels pixels = row;
  return classify_blocks<Layout>(of_row, pixels, {begin, end}, colors);
}

struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<kFormat, LayoutOf<kFormat>>;
};

}  // namespace
}  // namespace avx512

SpanKernel avx512_span_kernel(PixelFormat format) { return kernel_of_format<avx512::Family>(format); }

}  // namespace touchline

#endif
