#include <algorithm>
#include <cstring>
#include <utility>

#include "core/color/kernel_of_format.h"
#include "core/color/load_word.h"
#include "core/color/span_kernel.h"

namespace touchline {
namespace portable {
namespace {

static_assert(sizeof(ColorId) == 1, "a block of colors is cleared as one word");

// The background test takes blocks of eight pixels as machine words. A tile consists of whole blocks.
constexpr std::uint32_t kBlockPixels = 8;
static_assert(kTileWidth % kBlockPixels == 0);

// Tables of one light level.
struct LightTables {
  std::array<const ColorTables::Table*, 3> channel;
  const ColorTables::ColorOfBit& color_of_bit;

  LightTables(const SpanTables& tables, const TileParameters& light)
      : channel{&tables.colors->table(0, light.level[0]), &tables.colors->table(1, light.level[1]),
                &tables.colors->table(2, light.level[2])},
        color_of_bit(tables.colors->color_of_bit()) {}

  [[nodiscard]] ColorId color_of(std::uint32_t mask) const {
    return color_of_bit[static_cast<std::size_t>(std::countr_zero(mask))];
  }
};

// Compares eight bytes with their background ranges.
class BackgroundWord {
 public:
  BackgroundWord() = default;
  explicit BackgroundWord(const std::array<std::uint8_t, 8>& low, const std::array<std::uint8_t, 8>& extent)
      : low_(load_word(low.data())), beyond_(~load_word(extent.data())) {}

  /// Returns the high bits of the bytes that are out of range.
  [[nodiscard]] std::uint64_t candidates(std::uint64_t bytes) const {
    // Computes bytes - low for each byte, without borrow between bytes.
    const std::uint64_t from_low = ((bytes | kHighBits) - (low_ & ~kHighBits)) ^ ((bytes ^ ~low_) & kHighBits);
    // The high bit of each byte becomes (value & 127) + addend >= 128. There is no carry, because 127 + 127 < 255.
    const std::uint64_t sum = (from_low & ~kHighBits) + (beyond_ & ~kHighBits);
    // If the extent is below 128, a byte is out of range if the sum or its own high bit is set, else if both are set: a
    // majority vote of three bits.
    return ((sum & from_low) | (beyond_ & (sum | from_low))) & kHighBits;
  }

 private:
  static constexpr std::uint64_t kHighBits = 0x8080808080808080u;
  std::uint64_t low_ = 0, beyond_ = 0;
};

// Repeats bytes of the background range, whose offsets are in `at`, beginning with byte `first` of the repetition.
template <std::size_t kPeriod>
BackgroundWord background_word(const TileParameters& light, const std::array<std::size_t, kPeriod>& at,
                               std::size_t first = 0) {
  std::array<std::uint8_t, 8> low{}, extent{};
  for (std::size_t i = 0; i < 8; ++i) {
    low[i] = light.background_low[at[(first + i) % kPeriod]];
    extent[i] = light.background_extent[at[(first + i) % kPeriod]];
  }
  return BackgroundWord(low, extent);
}

// Formats with R, G and B next to each other.
template <PixelFormat kFormat>
struct PackedRgb {
  static constexpr std::size_t kRed = info_of(kFormat).channel[0].offset, kStep = info_of(kFormat).channel[0].step;

  static void pixels(const LightTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                     ColorId* colors) {
    const auto& [red, green, blue] = tables.channel;
    const std::uint8_t* pixel = row.plane[0] + std::size_t{begin} * kStep;
    for (std::uint32_t u = begin; u < end; ++u, pixel += kStep) {
      colors[u] = tables.color_of((*red)[pixel[kRed]] & (*green)[pixel[1]] & (*blue)[pixel[2 - kRed]]);
    }
  }

  // Eight pixels fill as many words as a pixel has bytes.
  class Background {
   public:
    explicit Background(const TileParameters& light) {
      for (std::size_t i = 0; i < kStep; ++i) {
        if constexpr (kStep == 3) {
          words_[i] = background_word<3>(light, {0, 1, 2}, 8 * i);
        } else {
          words_[i] = background_word<4>(light, {0, 1, 2, 3});
        }
      }
    }
    [[nodiscard]] bool holds(const RowPixels& row, std::uint32_t begin) const {
      const std::uint8_t* bytes = row.plane[0] + std::size_t{begin} * kStep;
      return [&]<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
        return (words_[kIndex].candidates(load_word(bytes + 8 * kIndex)) | ...) == 0;
      }
      (std::make_index_sequence<kStep>());
    }

   private:
    std::array<BackgroundWord, kStep> words_;
  };
};

// Formats whose pixel pairs (2k, 2k + 1) share a chroma sample. The chroma alone shows that most pairs are background.
template <PixelFormat kFormat>
struct SharedChroma {
  // Held by value: gcc 12 does not treat the target of a reference as a constant.
  static constexpr std::array kChannel = info_of(kFormat).channel;
  static constexpr Packing kPacking = info_of(kFormat).packing;
  static constexpr bool kPlanar = info_of(kFormat).planes > 1;
  static constexpr std::size_t kLumaStep = kChannel[0].step;

  static std::uint32_t chroma_mask(const LightTables& tables, const RowPixels& row, std::uint32_t u) {
    const std::size_t pair = std::size_t{u / 2} * kChannel[1].step;
    return (*tables.channel[1])[(row.plane[kChannel[1].plane] + pair)[kChannel[1].offset]] &
           (*tables.channel[2])[(row.plane[kChannel[2].plane] + pair)[kChannel[2].offset]];
  }
  static ColorId with_luma(const LightTables& tables, const RowPixels& row, std::uint32_t u, std::uint32_t chroma) {
    return tables.color_of(chroma & (*tables.channel[0])[row.plane[0][kChannel[0].byte(u)]]);
  }

  static void pixels(const LightTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                     ColorId* colors) {
    std::uint32_t u = begin;
    if (u % 2 == 1 && u < end) {
      colors[u] = with_luma(tables, row, u, chroma_mask(tables, row, u));
      ++u;
    }
    for (; u + 1 < end; u += 2) {
      const std::uint32_t chroma = chroma_mask(tables, row, u);
      colors[u] = colors[u + 1] = kBackground;
      if (chroma == 0) continue;
      colors[u] = with_luma(tables, row, u, chroma);
      colors[u + 1] = with_luma(tables, row, u + 1, chroma);
    }
    if (u < end) colors[u] = with_luma(tables, row, u, chroma_mask(tables, row, u));
  }

  class Background {
   public:
    explicit Background(const TileParameters& light)
        : first_(kPlanar ? background_word<1>(light, {0}) : background_word<4>(light, {0, 1, 2, 3})),
          second_(kPacking == Packing::kPlanar       ? background_word<8>(light, {2, 2, 2, 2, 3, 3, 3, 3})
                  : kPacking == Packing::kSemiPlanar ? background_word<2>(light, {2, 3})
                                                     : first_) {}
    /// `begin` must be even.
    [[nodiscard]] bool holds(const RowPixels& row, std::uint32_t begin) const {
      const std::uint8_t* bytes = row.plane[0] + std::size_t{begin} * kLumaStep;
      if constexpr (kPacking == Packing::kPlanar) {
        std::array<std::uint8_t, 8> chroma;
        std::memcpy(chroma.data(), row.plane[1] + begin / 2, 4);
        std::memcpy(chroma.data() + 4, row.plane[2] + begin / 2, 4);
        return (first_.candidates(load_word(bytes)) | second_.candidates(load_word(chroma.data()))) == 0;
      }
      return (first_.candidates(load_word(bytes)) |
              second_.candidates(load_word(kPlanar ? row.plane[1] + begin : bytes + 8))) == 0;
    }

   private:
    BackgroundWord first_, second_;
  };
};

// Classifies pixels with one light level. Blocks inside the background box are background; others are classified pixel
// by pixel.
template <class Layout>
OccupiedWords classify_light(const SpanTables& tables, const TileParameters& light, const RowPixels& row,
                             std::uint32_t begin, std::uint32_t end, ColorId* colors) {
  const LightTables of_light(tables, light);
  const typename Layout::Background background(light);
  OccupiedWords occupied = 0;
  const auto exactly = [&](std::uint32_t from, std::uint32_t to) {
    Layout::pixels(of_light, row, from, to, colors);
    for (std::uint32_t u = from; u < to; ++u) {
      occupied |= OccupiedWords{colors[u] != kBackground} << u / kOccupiedWordPixels;
    }
  };
  std::uint32_t u = begin;
  if (u % 2 == 1 && u < end) exactly(u, u + 1), ++u;
  for (; u + kBlockPixels <= end; u += kBlockPixels) {
    if (tables.has_background_box && background.holds(row, u)) {
      std::memset(colors + u, kBackground, kBlockPixels);
      continue;
    }
    Layout::pixels(of_light, row, u, u + kBlockPixels, colors);
    const OccupiedWords any = load_word(colors + u) != 0;
    occupied |= any << u / kOccupiedWordPixels | any << (u + kBlockPixels - 1) / kOccupiedWordPixels;
  }
  exactly(u, end);
  return occupied;
}

template <class Layout>
OccupiedWords classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                            ColorId* colors) {
  if (tables.unshaded) return classify_light<Layout>(tables, *tables.tiles, row, begin, end, colors);
  OccupiedWords occupied = 0;
  for (std::uint32_t u = begin; u < end;) {
    // Joins neighboring tiles with the same light level.
    const TileParameters& light = tables.tile_at(u);
    std::uint32_t stop = u;
    do {
      stop = std::min(end, (stop / kTileWidth + 1) * kTileWidth);
    } while (stop < end && tables.tile_at(stop).level == light.level);
    occupied |= classify_light<Layout>(tables, light, row, u, stop, colors);
    u = stop;
  }
  return occupied;
}

template <PixelFormat kFormat, Packing kPacking = info_of(kFormat).packing>
struct LayoutOf : SharedChroma<kFormat> {};
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kPacked24> : PackedRgb<kFormat> {};
template <PixelFormat kFormat>
struct LayoutOf<kFormat, Packing::kPacked32> : PackedRgb<kFormat> {};

struct Family {
  template <PixelFormat kFormat>
  static constexpr SpanKernel kKernel = classify_span<LayoutOf<kFormat>>;
};

}  // namespace
}  // namespace portable

SpanKernel portable_span_kernel(PixelFormat format) { return kernel_of_format<portable::Family, true>(format); }

}  // namespace touchline
