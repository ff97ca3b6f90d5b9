#include "core/color/span_kernel.h"

#if defined(__aarch64__)

#include <arm_neon.h>

#include "core/color/kernel_of_format.h"
#include "core/color/neon/nibble_lookup.h"
#include "core/color/neon/pixel_layout.h"

namespace touchline {
namespace neon {
namespace {

// Classifies columns of a row. The span is at least a tile wide, and consists of whole pairs if pairs share chroma.
template <class Layout, bool kUnshaded>
class Span {
  using Background = typename Layout::Background;

 public:
  Span(const SpanTables& tables, const RowPixels& row, ColorId* colors)
      : tables_(tables),
        row_(row),
        colors_(colors),
        background_(background_words(*tables.tiles)),
        nibbles_(*tables.nibbles, *tables.tiles),
        within_(nibbles_) {}

  OccupiedWords classify(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t u = begin;
    if (u % kTile != 0) {
      classify_first(u);
      u = (u / kTile + 1) * kTile;
    }
    classify_tiles(u, end / kTile * kTile);
    if (end % kTile != 0) classify_last(end);
    return occupied_;
  }

 private:
  [[gnu::always_inline]] void classify_tiles(std::uint32_t u, std::uint32_t end) {
    while (u < end) {
      std::uint32_t stop = end;
      if (end - u >= kBlock) {
        if (tables_.has_background_box && is_background_block(u)) {
          TOUCHLINE_UNROLL for (std::uint32_t tile = 0; tile < kTilesOfBlock; ++tile) clear(u + tile * kTile);
          u += kBlock;
          continue;
        }
        stop = u + kBlock;
      }
      for (; u < stop; u += kTile) {
        if ((tables_.has_background_box && is_background_tile(u)) || !may_be_colored(u)) {
          clear(u);
          continue;
        }
        const Values found = colors_at(u, u);
        vst1q_u8(colors_ + u, found);
        note(found, u);
      }
    }
  }

  // Classifies the pixels from column u to the end of its tile. The span has kTile columns from u on; the columns after
  // the tile are overwritten later.
  void classify_first(std::uint32_t u) {
    const Values found = colors_at(u, u);
    vst1q_u8(colors_ + u, found);
    note(vandq_u8(found, vcltq_u8(columns(), vdupq_n_u8(static_cast<std::uint8_t>(kTile - u % kTile)))), u);
  }

  // Classifies the begin of a tile, before column `end`. kTile columns are in the span; other tiles are already done.
  void classify_last(std::uint32_t end) {
    const std::uint32_t from = end - kTile;
    const Values here = vcgeq_u8(columns(), vdupq_n_u8(static_cast<std::uint8_t>(kTile - end % kTile)));
    const Values found = vandq_u8(here, colors_at(from, end - 1));
    vst1q_u8(colors_ + from, vbslq_u8(here, found, vld1q_u8(colors_ + from)));
    note(found, end - 1);
  }

  static Values columns() {
    static constexpr std::uint8_t kColumns[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return vld1q_u8(kColumns);
  }

  [[gnu::always_inline]] [[nodiscard]] bool is_background_block(std::uint32_t u) const {
    const RowPixels block = Layout::at(row_, u);
    if constexpr (kUnshaded) return background_.template holds<kTilesOfBlock>(block);
    BackgroundWords all;
    return background_words<Layout::kBackgroundFromZero>(tables_.tiles + u / kTile, all) &&
           Background(all).template holds<kTilesOfBlock>(block);
  }
  [[gnu::always_inline]] [[nodiscard]] bool is_background_tile(std::uint32_t u) const {
    const RowPixels tile = Layout::at(row_, u);
    if constexpr (kUnshaded) return background_.template holds<1>(tile);
    return Background(background_words(tables_.tiles[u / kTile])).template holds<1>(tile);
  }
  [[gnu::always_inline]] [[nodiscard]] bool may_be_colored(std::uint32_t u) const {
    const RowPixels tile = Layout::at(row_, u);
    if constexpr (kUnshaded) return Layout::may_be_colored(within_, tile);
    return Layout::may_be_colored(Within(TileNibbles(*tables_.nibbles, tables_.tiles[u / kTile])), tile);
  }
  // Returns the colors of kTile columns that begin at `u`, with the light level of `light_column`.
  [[nodiscard]] Values colors_at(std::uint32_t u, std::uint32_t light_column) const {
    const RowPixels tile = Layout::at(row_, u);
    if constexpr (kUnshaded) return Layout::colors(nibbles_, tile);
    return Layout::colors(TileNibbles(*tables_.nibbles, tables_.tiles[light_column / kTile]), tile);
  }

  void clear(std::uint32_t u) { vst1q_u8(colors_ + u, vdupq_n_u8(kBackground)); }
  void note(Values found, std::uint32_t u) {
    if (!is_zero(found)) occupied_ |= OccupiedWords{1} << u / kOccupiedWordPixels;
  }

  // Held by value, so that stores to colors cannot change them.
  const SpanTables tables_;
  const RowPixels row_;
  ColorId* const colors_;
  // Background range of the first tile; without a light map, of all tiles.
  const Background background_;
  const TileNibbles nibbles_;
  const Within within_;
  OccupiedWords occupied_ = 0;
};

template <class Layout>
OccupiedWords classify_light(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                             ColorId* colors) {
  return tables.unshaded ? Span<Layout, true>(tables, row, colors).classify(begin, end)
                         : Span<Layout, false>(tables, row, colors).classify(begin, end);
}
template <PixelFormat kFormat>
OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                            ColorId* colors) {
  if (end - begin < kTile) return portable_span_kernel(kFormat)(tables, row, begin, end, colors);
  if constexpr (info_of(kFormat).packing == Packing::kPacked32) {
    return classify_light<Packed32<kFormat>>(tables, row, begin, end, colors);
  } else if constexpr (info_of(kFormat).packing == Packing::kPacked24) {
    return tables.background_from_zero ? classify_light<Packed24<kFormat, true>>(tables, row, begin, end, colors)
                                       : classify_light<Packed24<kFormat, false>>(tables, row, begin, end, colors);
  } else {
    return classify_light<SharedChroma<kFormat>>(tables, row, begin, end, colors);
  }
}

struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<kFormat>;
};

}  // namespace
}  // namespace neon

SpanKernel neon_span_kernel(PixelFormat format) { return kernel_of_format<neon::Family>(format); }

}  // namespace touchline

#endif
