#include "core/color/span_kernel.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <algorithm>
#include <cstring>

namespace touchline {
namespace {

// Every function carries the target itself: a file compiled for AVX2 as a whole would leave AVX2 code in functions that
// it shares with other files, and on an older processor the linker may have picked those.
#define TOUCHLINE_AVX2 [[gnu::target("avx2")]]
#define TOUCHLINE_AVX2_INLINE [[gnu::target("avx2"), gnu::always_inline]] inline

// Below, copying a short span into a block costs more than its pixels one by one.
constexpr std::uint32_t kLeastForBlock = 12;

TOUCHLINE_AVX2_INLINE __m256i load(const std::uint8_t* bytes) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes));
}
// 16 bytes for the lower and 16 for the upper lane.
TOUCHLINE_AVX2_INLINE __m256i load_lanes(const std::uint8_t* low, const std::uint8_t* high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(low))),
                                 _mm_loadu_si128(reinterpret_cast<const __m128i*>(high)), 1);
}
TOUCHLINE_AVX2_INLINE __m256i in_both_lanes(const std::uint8_t* bytes) {
  return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes)));
}
TOUCHLINE_AVX2_INLINE void store(ColorId* colors, __m256i value) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(colors), value);
}
TOUCHLINE_AVX2_INLINE bool is_zero(__m256i value) { return _mm256_testz_si256(value, value) != 0; }

TOUCHLINE_AVX2_INLINE __m256i look_up(const std::array<std::uint8_t, 16>& table, __m256i digit) {
  return _mm256_shuffle_epi8(in_both_lanes(table.data()), digit);
}

// The hexadecimal digits of 32 values.
struct Digits {
  __m256i high, low;
};
TOUCHLINE_AVX2_INLINE Digits digits_of(__m256i values) {
  const __m256i low_digit = _mm256_set1_epi8(15);
  return {_mm256_and_si256(_mm256_srli_epi16(values, 4), low_digit), _mm256_and_si256(values, low_digit)};
}

// The group's classes to which the values of a channel belong, a byte a value.
TOUCHLINE_AVX2_INLINE __m256i classes_of(const DigitTables& tables, const Digits& value) {
  const __m256i from = _mm256_or_si256(look_up(tables.above_first, value.high), look_up(tables.from_first, value.low));
  const __m256i to = _mm256_or_si256(look_up(tables.below_last, value.high), look_up(tables.to_last, value.low));
  return _mm256_and_si256(look_up(tables.within, value.high), _mm256_and_si256(from, to));
}

// The color of the lowest class; where an earlier group has given a color, that.
TOUCHLINE_AVX2_INLINE __m256i add_colors(__m256i colors, const ColorDigits& tables, __m256i classes) {
  const Digits bits = digits_of(classes);
  const __m256i zero = _mm256_setzero_si256();
  const __m256i low = look_up(tables.low, bits.low);
  const __m256i color = _mm256_blendv_epi8(low, look_up(tables.high, bits.high), _mm256_cmpeq_epi8(low, zero));
  return _mm256_blendv_epi8(colors, color, _mm256_cmpeq_epi8(colors, zero));
}

// Three bytes a pixel.
template <PixelFormat kFormat>
struct Packed24 {
  static constexpr std::uint32_t kBlock = 32;
  static constexpr std::size_t kSampleBytes = std::size_t{3} * kBlock, kChromaBytes = 0;
  static constexpr bool kPairs = false;

  // Which byte of 16-byte piece `piece` of 16 pixels is channel `channel` of pixel i; 128, for none, gives zero.
  static constexpr auto kPick = [] {
    std::array<std::array<std::array<std::uint8_t, 16>, 3>, 3> pick{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::size_t offset = kFormat == PixelFormat::kRgb24 ? channel : 2 - channel;
      for (std::size_t piece = 0; piece < 3; ++piece) {
        for (std::size_t i = 0; i < 16; ++i) {
          const std::size_t byte = 3 * i + offset;
          pick[channel][piece][i] = static_cast<std::uint8_t>(byte / 16 == piece ? byte % 16 : 128);
        }
      }
    }
    return pick;
  }();

  TOUCHLINE_AVX2_INLINE static Digits channel(std::size_t channel, __m256i first, __m256i second, __m256i third) {
    const auto& pick = kPick[channel];
    return digits_of(_mm256_or_si256(_mm256_shuffle_epi8(first, in_both_lanes(pick[0].data())),
                                     _mm256_or_si256(_mm256_shuffle_epi8(second, in_both_lanes(pick[1].data())),
                                                     _mm256_shuffle_epi8(third, in_both_lanes(pick[2].data())))));
  }

  TOUCHLINE_AVX2_INLINE static bool below_floor(const BackgroundFloor& floor, __m256i first, __m256i second,
                                                __m256i third) {
    if (!floor.can_reject()) return false;
    const std::uint8_t* below = floor.highest_below().data();
    const __m256i reached = _mm256_or_si256(_mm256_subs_epu8(first, in_both_lanes(below)),
                                            _mm256_or_si256(_mm256_subs_epu8(second, in_both_lanes(below + 16)),
                                                            _mm256_subs_epu8(third, in_both_lanes(below + 32))));
    return is_zero(reached);
  }

  TOUCHLINE_AVX2_INLINE static void classify(const SpanTables& tables, const std::uint8_t* bytes, const std::uint8_t*,
                                             ColorId* colors) {
    const __m256i first = load_lanes(bytes, bytes + 48), second = load_lanes(bytes + 16, bytes + 64),
                  third = load_lanes(bytes + 32, bytes + 80);
    __m256i found = _mm256_setzero_si256();
    if (!below_floor(*tables.floor, first, second, third)) {
      const Digits a = channel(0, first, second, third), b = channel(1, first, second, third),
                   c = channel(2, first, second, third);
      for (std::size_t group = 0; group < tables.groups; ++group) {
        const DigitTables &of_a = (*tables.digits[0])[group], &of_b = (*tables.digits[1])[group],
                          &of_c = (*tables.digits[2])[group];
        // Most blocks are background by their high digits.
        if (is_zero(_mm256_and_si256(look_up(of_a.within, a.high),
                                     _mm256_and_si256(look_up(of_b.within, b.high), look_up(of_c.within, c.high))))) {
          continue;
        }
        const __m256i classes =
            _mm256_and_si256(classes_of(of_a, a), _mm256_and_si256(classes_of(of_b, b), classes_of(of_c, c)));
        found = add_colors(found, (*tables.color_digits)[group], classes);
      }
    }
    store(colors, found);
  }
};

// Formats whose pixel pairs share a chroma sample.
template <PixelFormat kFormat>
struct SharedChroma {
  static constexpr bool kPlanar = kFormat == PixelFormat::kNv12, kPairs = true;
  static constexpr std::uint32_t kBlock = 64;
  static constexpr std::size_t kSampleBytes = kPlanar ? 64 : 128, kChromaBytes = kPlanar ? 64 : 0;

  // The even or the odd bytes of 64.
  TOUCHLINE_AVX2_INLINE static __m256i even_bytes(__m256i first, __m256i second) {
    const __m256i low_byte = _mm256_set1_epi16(255);
    const __m256i packed = _mm256_packus_epi16(_mm256_and_si256(first, low_byte), _mm256_and_si256(second, low_byte));
    return _mm256_permute4x64_epi64(packed, 0b11011000);  // packing works lane by lane
  }
  TOUCHLINE_AVX2_INLINE static __m256i odd_bytes(__m256i first, __m256i second) {
    const __m256i packed = _mm256_packus_epi16(_mm256_srli_epi16(first, 8), _mm256_srli_epi16(second, 8));
    return _mm256_permute4x64_epi64(packed, 0b11011000);
  }
  TOUCHLINE_AVX2_INLINE static __m256i luma_bytes(__m256i first, __m256i second) {
    return kFormat == PixelFormat::kYuyv ? even_bytes(first, second) : odd_bytes(first, second);
  }
  TOUCHLINE_AVX2_INLINE static __m256i chroma_bytes(__m256i first, __m256i second) {
    return kFormat == PixelFormat::kYuyv ? odd_bytes(first, second) : even_bytes(first, second);
  }

  // 64 luma samples, and the two chroma samples of 32 pairs.
  struct Block {
    __m256i luma[2];
    Digits u, v;
  };
  TOUCHLINE_AVX2_INLINE static Block split(const std::uint8_t* samples, const std::uint8_t* chroma) {
    Block block;
    __m256i uv[2];
    if constexpr (kPlanar) {
      block.luma[0] = load(samples);
      block.luma[1] = load(samples + 32);
      uv[0] = load(chroma);
      uv[1] = load(chroma + 32);
    } else {
      const __m256i a = load(samples), b = load(samples + 32), c = load(samples + 64), d = load(samples + 96);
      block.luma[0] = luma_bytes(a, b);
      block.luma[1] = luma_bytes(c, d);
      uv[0] = chroma_bytes(a, b);
      uv[1] = chroma_bytes(c, d);
    }
    block.u = digits_of(even_bytes(uv[0], uv[1]));
    block.v = digits_of(odd_bytes(uv[0], uv[1]));
    return block;
  }

  TOUCHLINE_AVX2_INLINE static void classify(const SpanTables& tables, const std::uint8_t* samples,
                                             const std::uint8_t* chroma, ColorId* colors) {
    const Block block = split(samples, chroma);
    __m256i found[2] = {_mm256_setzero_si256(), _mm256_setzero_si256()};
    for (std::size_t group = 0; group < tables.groups; ++group) {
      const DigitTables &of_u = (*tables.digits[1])[group], &of_v = (*tables.digits[2])[group];
      // Most pairs are background by their chroma alone.
      const __m256i pairs = _mm256_and_si256(classes_of(of_u, block.u), classes_of(of_v, block.v));
      if (is_zero(pairs)) continue;
      // Each pair's classes for both its pixels; unpacking works lane by lane.
      const __m256i low = _mm256_unpacklo_epi8(pairs, pairs), high = _mm256_unpackhi_epi8(pairs, pairs);
      const __m256i of_pixels[2] = {_mm256_permute2x128_si256(low, high, 0x20),
                                    _mm256_permute2x128_si256(low, high, 0x31)};
      for (std::size_t half = 0; half < 2; ++half) {
        if (is_zero(of_pixels[half])) continue;
        const __m256i of_luma = classes_of((*tables.digits[0])[group], digits_of(block.luma[half]));
        const __m256i classes = _mm256_and_si256(of_pixels[half], of_luma);
        found[half] = add_colors(found[half], (*tables.color_digits)[group], classes);
      }
    }
    store(colors, found[0]);
    store(colors + 32, found[1]);
  }
};

// Where the pixels from `u` on begin, in a row whose pairs share chroma from even columns on.
template <class Layout>
const std::uint8_t* samples_at(const RowPixels& row, std::uint32_t u) {
  return row.samples + std::size_t{u} * (Layout::kSampleBytes / Layout::kBlock);
}
template <class Layout>
const std::uint8_t* chroma_at(const RowPixels& row, std::uint32_t u) {
  return Layout::kChromaBytes == 0 ? nullptr : row.chroma + u;
}

// Fewer pixels than a block: by way of a block of our own, because nothing beyond the span may be read or written.
template <class Layout>
TOUCHLINE_AVX2 void classify_short(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                   std::uint32_t count, ColorId* colors) {
  std::array<std::uint8_t, Layout::kSampleBytes> samples{};
  std::array<std::uint8_t, Layout::kChromaBytes> chroma{};
  std::array<ColorId, Layout::kBlock> block{};
  std::memcpy(samples.data(), samples_at<Layout>(row, begin), count * (Layout::kSampleBytes / Layout::kBlock));
  if constexpr (Layout::kChromaBytes > 0) std::memcpy(chroma.data(), chroma_at<Layout>(row, begin), count);
  Layout::classify(tables, samples.data(), chroma.data(), block.data());
  std::memcpy(colors + begin, block.data(), count);
}

template <class Layout, PixelFormat kFormat>
TOUCHLINE_AVX2 void classify_span(const SpanTables& tables, const RowPixels& row, std::uint32_t begin,
                                  std::uint32_t end, ColorId* colors) {
  const SpanKernel one_by_one = scalar_kernel(kFormat);
  std::uint32_t u = begin, stop = end;
  if constexpr (Layout::kPairs) {
    // Only whole pairs go into blocks.
    if (u % 2 == 1 && u < end) one_by_one(tables, row, u, u + 1, colors), ++u;
    stop = std::max(u, end / 2 * 2);
  }
  if (stop - u >= Layout::kBlock) {
    for (; u < stop; u += Layout::kBlock) {
      // The last block overlaps the one before it.
      u = std::min(u, stop - Layout::kBlock);
      Layout::classify(tables, samples_at<Layout>(row, u), chroma_at<Layout>(row, u), colors + u);
    }
  } else if (stop - u >= kLeastForBlock) {
    classify_short<Layout>(tables, row, u, stop - u, colors);
    u = stop;
  }
  if (u < end) one_by_one(tables, row, u, end, colors);
}

template <template <PixelFormat> class Layout, PixelFormat kFormat>
constexpr SpanKernel kKernel = classify_span<Layout<kFormat>, kFormat>;

}  // namespace

SpanKernel avx2_kernel(PixelFormat format) {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") == 0) return nullptr;
  switch (format) {
    case PixelFormat::kRgb24:
      return kKernel<Packed24, PixelFormat::kRgb24>;
    case PixelFormat::kBgr24:
      return kKernel<Packed24, PixelFormat::kBgr24>;
    case PixelFormat::kYuyv:
      return kKernel<SharedChroma, PixelFormat::kYuyv>;
    case PixelFormat::kUyvy:
      return kKernel<SharedChroma, PixelFormat::kUyvy>;
    case PixelFormat::kNv12:
      return kKernel<SharedChroma, PixelFormat::kNv12>;
  }
  return nullptr;
}

}  // namespace touchline

#else

namespace touchline {

SpanKernel avx2_kernel(PixelFormat) { return nullptr; }

}  // namespace touchline

#endif
