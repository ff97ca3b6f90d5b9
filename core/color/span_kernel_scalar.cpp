#include <bit>
#include <cstring>

#include "core/color/load_word.h"
#include "core/color/span_kernel.h"

namespace touchline {
namespace {

static_assert(sizeof(ColorId) == 1, "a block of colors is cleared as one word");

inline ColorId color_of(const SpanTables& tables, std::uint32_t mask) {
  return (*tables.color_of_bit)[static_cast<std::size_t>(std::countr_zero(mask))];
}

template <PixelFormat kFormat>
struct Packed24 {
  static constexpr std::size_t kRed = kFormat == PixelFormat::kRgb24 ? 0 : 2;

  static void pixels(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                     ColorId* colors) {
    const auto& [red, green, blue] = tables.channel;
    const std::uint8_t* pixel = row.samples + std::size_t{begin} * 3;
    for (std::uint32_t u = begin; u < end; ++u, pixel += 3) {
      colors[u] = color_of(tables, (*red)[pixel[kRed]] & (*green)[pixel[1]] & (*blue)[pixel[2 - kRed]]);
    }
  }
  static std::array<std::uint64_t, 3> block(const RowPixels& row, std::uint32_t begin) {
    const std::uint8_t* bytes = row.samples + std::size_t{begin} * 3;
    return {load_word(bytes), load_word(bytes + 8), load_word(bytes + 16)};
  }
};

// Formats whose pixel pairs (2k, 2k + 1) share a chroma sample: most pairs are background by their chroma alone.
template <PixelFormat kFormat>
struct SharedChroma {
  static constexpr bool kPlanar = kFormat == PixelFormat::kNv12;
  static constexpr std::size_t kLumaStep = kPlanar ? 1 : 2;
  static constexpr std::size_t kLumaAt = kFormat == PixelFormat::kUyvy ? 1 : 0;
  static constexpr std::size_t kPairStep = kPlanar ? 2 : 4;
  static constexpr std::size_t kFirstChromaAt = kFormat == PixelFormat::kYuyv ? 1 : 0;
  static constexpr std::size_t kSecondChromaAt = kFirstChromaAt + (kPlanar ? 1 : 2);

  static std::uint32_t chroma_mask(const SpanTables& tables, const RowPixels& row, std::uint32_t u) {
    const std::uint8_t* pair = (kPlanar ? row.chroma : row.samples) + std::size_t{u / 2} * kPairStep;
    return (*tables.channel[1])[pair[kFirstChromaAt]] & (*tables.channel[2])[pair[kSecondChromaAt]];
  }
  static ColorId with_luma(const SpanTables& tables, const RowPixels& row, std::uint32_t u, std::uint32_t chroma) {
    return color_of(tables, chroma & (*tables.channel[0])[row.samples[std::size_t{u} * kLumaStep + kLumaAt]]);
  }

  static void pixels(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
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
  // `begin` is even.
  static std::array<std::uint64_t, 2> block(const RowPixels& row, std::uint32_t begin) {
    const std::uint8_t* bytes = row.samples + std::size_t{begin} * kLumaStep;
    return {load_word(bytes), load_word(kPlanar ? row.chroma + begin : bytes + 8)};
  }
};

// Blocks below the floor are background at a glance; the others are looked at pixel by pixel.
template <class Layout>
void classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin, std::uint32_t end,
                   ColorId* colors) {
  std::uint32_t u = begin;
  if (u % 2 == 1 && u < end) {
    Layout::pixels(tables, row, u, u + 1, colors);
    ++u;
  }
  for (; u + kBlockPixels <= end; u += kBlockPixels) {
    if (tables.floor->rejects(Layout::block(row, u))) {
      std::memset(colors + u, kBackground, kBlockPixels);
    } else {
      Layout::pixels(tables, row, u, u + kBlockPixels, colors);
    }
  }
  Layout::pixels(tables, row, u, end, colors);
}

}  // namespace

SpanKernel scalar_kernel(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb24:
      return classify_span<Packed24<PixelFormat::kRgb24>>;
    case PixelFormat::kBgr24:
      return classify_span<Packed24<PixelFormat::kBgr24>>;
    case PixelFormat::kYuyv:
      return classify_span<SharedChroma<PixelFormat::kYuyv>>;
    case PixelFormat::kUyvy:
      return classify_span<SharedChroma<PixelFormat::kUyvy>>;
    case PixelFormat::kNv12:
      return classify_span<SharedChroma<PixelFormat::kNv12>>;
  }
  return nullptr;
}

}  // namespace touchline
